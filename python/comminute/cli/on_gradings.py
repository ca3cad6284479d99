"""Commands on gradings: indices, tables, comparisons, pictures, texts for particle codes, fits."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Annotated, Any

import typer

from comminute.cli.base import (
    SIEVES,
    Edges,
    Force,
    Json,
    Mesh,
    Number,
    Percentiles,
    Sample,
    SheetName,
    Top,
    TotalMass,
    app,
    plain_errors,
    plots,
    refuse_existing,
    require_writable,
)
from comminute.fitting.search import FitWarning


@app.command()
@plain_errors
def stats(
    files: Annotated[list[Path], typer.Argument(metavar="SIEVES.csv|RESULT.nc...")],
    number: Number = SIEVES["number"],
    top: Top = SIEVES["top"],
    sheet: SheetName = None,
    sample: Sample = None,
    mesh: Mesh = None,
    total_mass_g: TotalMass = None,
    edges: Edges = None,
    extrapolate: Annotated[bool, typer.Option("--extrapolate", help="Follow the tail below the finest size.")] = False,
    percentiles: Percentiles = None,
    void_ratio: Annotated[
        float | None, typer.Option("--void-ratio", help="Measured void ratio, of a result that of its start.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute the indices of sieve tables, or of every load of results."""
    from comminute.cli import stats as cli_stats  # noqa: PLC0415  (keeps the other commands quick)
    from comminute.cli import tables as cli_tables  # noqa: PLC0415

    table = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    table |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    percents = cli_tables.percents_of(percentiles) if percentiles else cli_stats.PERCENTS
    options: dict[str, Any] = {"extrapolate": extrapolate, "percents": percents, "initial_void_ratio": void_ratio}
    found = [cli_stats.stats_of(file, **options | table) for file in files]
    if as_json:
        records = [cli_stats.as_json(one) for one in found]
        print(json.dumps(records[0] if len(files) == 1 else {"files": records}))
    else:
        print("\n\n".join(cli_stats.as_text(one) for one in found))


@app.command()
@plain_errors
def table(
    files: Annotated[list[Path], typer.Argument(metavar="SIEVES.csv|RESULT.nc...")],
    sieves: Annotated[
        str | None, typer.Option("--sieves", help='Series ("ISO R20/3") or openings (2,1,0.5); default: as measured.')
    ] = None,
    percentiles: Percentiles = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Table: .csv or .xlsx.")] = None,
    number: Number = SIEVES["number"],
    top: Top = SIEVES["top"],
    sheet: SheetName = None,
    sample: Sample = None,
    mesh: Mesh = None,
    total_mass_g: TotalMass = None,
    edges: Edges = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Put gradings on sieves side by side, and the indices of results by load."""
    from comminute.cli import tables as cli_tables  # noqa: PLC0415  (keeps the other commands quick)

    if output is not None:
        require_writable(output, cli_tables.ENDINGS)
        refuse_existing(output, force)
    reading = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    reading |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    percents = cli_tables.percents_of(percentiles) if percentiles else None
    found = cli_tables.tables_of(files, sieves=sieves, percents=percents, table=reading)
    if as_json:
        print(json.dumps(cli_tables.record(found)))
    else:
        print("\n\n".join(f"{name}\n{one}" for name, one in found.items()))
    for written in cli_tables.save(found, output) if output is not None else []:
        if not as_json:
            print(f"wrote {written}")


@app.command()
@plain_errors
def dem(
    file: Annotated[Path, typer.Argument(metavar="SIEVES.csv|RESULT.nc")],
    code: Annotated[str, typer.Option("--code", help="yade, liggghts or mercury-dpm.")],
    smallest: Annotated[float | None, typer.Option("--smallest", help="Smallest grain, in the file's unit.")] = None,
    classes: Annotated[int, typer.Option("--classes", help="Classes of sizes, even in ln d.")] = 12,
    density: Annotated[float, typer.Option("--density", help="Of the grains [kg/m3].")] = 2650.0,
    load: Annotated[int, typer.Option("--load", help="Index of the load of a result.")] = -1,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Text file; else it is printed.")] = None,
    top: Top = SIEVES["top"],
    sample: Sample = None,
    force: Force = False,
) -> None:
    """Write a grading as a particle code reads it, by mass and in metres."""
    from comminute.cli import tables as cli_tables  # noqa: PLC0415  (keeps the other commands quick)

    if output is not None:
        refuse_existing(output, force)
    curve = cli_tables.one_curve(file, load, {"top": top, "sample": sample})
    text = cli_tables.dem(curve, code, smallest=smallest, classes=classes, density=density)
    if output is None:
        print(text, end="")
    else:
        output.write_text(text, encoding="utf-8")
        print(f"wrote {output}")


@app.command()
@plain_errors
def compare(
    before: Annotated[Path, typer.Argument(metavar="BEFORE.csv")],
    after: Annotated[Path, typer.Argument(metavar="AFTER.csv")],
    percentiles: Percentiles = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Table: .csv or .xlsx.")] = None,
    number: Number = SIEVES["number"],
    top: Top = SIEVES["top"],
    sheet: SheetName = None,
    sample: Sample = None,
    mesh: Mesh = None,
    total_mass_g: TotalMass = None,
    edges: Edges = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Compare two sieve tables: breakage, reduction ratio, sizes and their ratios."""
    from comminute.cli import tables as cli_tables  # noqa: PLC0415  (keeps the other commands quick)

    if output is not None:
        require_writable(output, cli_tables.ENDINGS)
        refuse_existing(output, force)
    reading = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    reading |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    percents = cli_tables.percents_of(percentiles) if percentiles else (10.0, 30.0, 50.0, 60.0, 80.0, 90.0)
    found = {"comparison": cli_tables.compared_files(before, after, percents=percents, table=reading)}
    print(json.dumps(cli_tables.record(found)) if as_json else found["comparison"])
    for written in cli_tables.save(found, output) if output is not None else []:
        if not as_json:
            print(f"wrote {written}")


@app.command()
@plain_errors
def plot(
    files: Annotated[list[Path], typer.Argument(metavar="SIEVES.csv|RESULT.nc...")],
    measured: Annotated[
        list[str] | None,
        typer.Option("--measured", help="Sieve table to lay over it, after.csv@12MPa; again for more."),
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Picture: .png, .pdf or .svg.")] = None,
    what: Annotated[str, typer.Option("--what", help="gradings, fabric or index.")] = "gradings",
    axes: Annotated[str, typer.Option("--axes", help="semilog, loglog or rosin-rammler.")] = "semilog",
    coarse_left: Annotated[bool, typer.Option("--coarse-left", help="Sizes fall rightwards.")] = False,
    phi: Annotated[bool, typer.Option("--phi", help="Sizes on the phi scale.")] = False,
    load: Annotated[int, typer.Option("--load", help="Index of the load whose fabric is drawn.")] = -1,
    number: Number = SIEVES["number"],
    top: Top = SIEVES["top"],
    sheet: SheetName = None,
    sample: Sample = None,
    mesh: Mesh = None,
    total_mass_g: TotalMass = None,
    edges: Edges = None,
    force: Force = False,
) -> None:
    """Draw sieve tables and results to a picture file; no window opens."""
    cli_plots = plots("plot")
    target = output or files[0].with_suffix(".png")
    require_writable(target, cli_plots.ENDINGS)
    refuse_existing(target, force)
    curves = {"axes": axes, "coarse_left": coarse_left, "phi": phi}
    table = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    table |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    cli_plots.draw(files, target, what=what, load=load, table=table, measured=measured or [], **curves)
    print(f"wrote {target}")


@app.command(name="fit")
@plain_errors
def fit_command(
    files: Annotated[list[str], typer.Argument(metavar="SIEVES.csv@STRESS...")],
    start: Annotated[
        Path | None, typer.Option("--start", help="Sieve table of the start; or name it SIEVES.csv@0.")
    ] = None,
    free: Annotated[
        str, typer.Option("--free", help="Parameters to find, with commas between.")
    ] = "fabric_width,weibull_modulus,first_crush_stress",
    fixed: Annotated[
        list[str] | None, typer.Option("--fix", help="NAME=VALUE of a parameter that is not free.")
    ] = None,
    reference_size: Annotated[
        float | None, typer.Option("--reference-size", help="Default: the largest grain.")
    ] = None,
    closure: Annotated[str, typer.Option("--closure", help="paper, resolved or lattice.")] = "paper",
    error: Annotated[float, typer.Option("--error", help="Standard deviation of a mass fraction finer.")] = 0.01,
    intervals: Annotated[str, typer.Option("--intervals", help="covariance or profile.")] = "covariance",
    starts: Annotated[int, typer.Option("--starts", help="Starts of the search.")] = 4,
    output: Annotated[
        list[Path] | None,
        typer.Option("--output", "-o", help="Case (.toml), numbers (.json) or picture; again for more."),
    ] = None,
    number: Number = SIEVES["number"],
    top: Top = SIEVES["top"],
    sheet: SheetName = None,
    sample: Sample = None,
    mesh: Mesh = None,
    total_mass_g: TotalMass = None,
    edges: Edges = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Find the parameters of a sand from gradings measured before and after loading."""
    from comminute.cli import fits as cli_fits  # noqa: PLC0415  (keeps the other commands quick)

    pictures = {".png", ".pdf", ".svg"}
    targets = output or []
    drawn = [target for target in targets if target.suffix in pictures]
    cli_plots = plots("--output") if drawn else None
    for target in targets:
        require_writable(target, (".toml", ".json", *sorted(pictures)))
        refuse_existing(target, force)
    table = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    table |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", FitWarning)
        found, unit = cli_fits.fitted(
            files,
            start=start,
            free=[name.strip() for name in free.split(",") if name.strip()],
            fixed=fixed or [],
            reference_size=reference_size,
            table=table,
            closure=closure,
            error=error,
            intervals=intervals,
            starts=starts,
        )
    remarks = [str(one.message) for one in said if issubclass(one.category, FitWarning)]
    if as_json:
        print(json.dumps(cli_fits.record(found, unit) | {"warnings": remarks}))
    else:
        print(found.table())
        for remark in remarks:
            print(f"warning: {remark}")
    for target in targets:
        if target in drawn and cli_plots is not None:
            cli_plots.save(found.plot(), target)
        else:
            found.save(target, stress_unit=unit)
        if not as_json:
            print(f"wrote {target}")

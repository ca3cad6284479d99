"""The command line: cases in, tables and files out. Needs typer and pydantic."""

from __future__ import annotations

import functools
import json
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Annotated, NoReturn, ParamSpec

import typer

from comminute._core import ParameterError, ShapeError, UnavailableError, __version__, defaults
from comminute.cases.reading import ReadyCase, read_case
from comminute.cases.running import (
    OutputExistsError,
    claimed,
    finished_loads,
    part_of,
    run_case,
    run_file_again,
    summary,
)
from comminute.cli import texts as cli_texts
from comminute.fitting.search import FitWarning
from comminute.result import Interrupted, Result
from comminute.runs.remarks import ResolutionWarning
from comminute.util.errors import parameter_error
from comminute.util.names import shorten

WRONG_INPUT, EXISTS, FAILED, MISSING_EXTRA, STOPPED = 2, 3, 4, 5, 130
P = ParamSpec("P")

app = typer.Typer(
    name="comminute",
    help=cli_texts.HELP,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
SIEVES = defaults["from_sieves"]
Number = Annotated[bool, typer.Option("--number", help="The shares of the sieve table count grains.")]
Top = Annotated[str, typer.Option("--top", help='"extend" closes a sieve curve short of 100 %.')]
SheetName = Annotated[str | None, typer.Option("--sheet", help="Sheet of a workbook, by name or number from 1.")]
Sample = Annotated[str | None, typer.Option("--sample", help="Sample of a table of several.")]
Mesh = Annotated[str | None, typer.Option("--mesh", help="Series of sieve numbers: astm (E11) or tyler.")]
TotalMass = Annotated[float | None, typer.Option("--total-mass-g", help="Dry mass before washing [g].")]
Edges = Annotated[str | None, typer.Option("--edges", help="Edge of its class that a size is: lower or upper.")]
Percentiles = Annotated[
    str | None, typer.Option("--percentiles", help="Sizes D_x wanted, as per cent with commas: 10,50,90.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]


def _stop(message: str, code: int) -> NoReturn:
    print(f"error: {message}", file=sys.stderr)
    raise typer.Exit(code)


def plain_errors(command: Callable[P, None]) -> Callable[P, None]:
    """Turn what a command may raise into one line and an exit code."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except (ParameterError, ShapeError) as error:
            _stop(str(error), WRONG_INPUT)
        except OutputExistsError as error:
            _stop(str(error), EXISTS)
        except (ImportError, UnavailableError) as error:
            _stop(str(error), MISSING_EXTRA)
        except MemoryError:
            _stop("the memory does not suffice; take fewer bins or keep fewer fabrics", FAILED)
        except BrokenPipeError:
            sys.stderr.close()  # the reader has gone, as `| head` does; nobody is left to tell
            raise typer.Exit from None
        except OSError as error:
            _stop(f"{error.filename or 'a file'}: {error.strerror or error}", FAILED)
        except KeyboardInterrupt:
            _stop("interrupted", STOPPED)

    return run


@app.callback(invoke_without_command=True)
def _version(show: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if show:
        print(__version__)
        raise typer.Exit


@app.command()
@plain_errors
def new(folder: Annotated[Path, typer.Argument(metavar="DIR")], force: Force = False) -> None:
    """Make a folder with a commented case and the sieve table of a real sand."""
    files = {folder / name: text for name, text in cli_texts.new_case().items()}
    for file in files:
        _refuse_existing(file, force)
    folder.mkdir(parents=True, exist_ok=True)
    for file, text in files.items():
        file.write_text(text)
        print(f"wrote {file}")
    print(f"next: comminute run {folder / 'case.toml'}")


@app.command()
@plain_errors
def check(case: Annotated[Path, typer.Argument(metavar="CASE.toml")], as_json: Json = False) -> None:
    """Read a case and its files, and say what would run and roughly what it would do; nothing is written."""
    cases = read_case(case)
    if as_json:
        print(json.dumps([json.loads(ready.text()) | {"target": str(ready.target)} for ready in cases]))
        return
    for ready in cases:
        print(cli_texts.case_summary(ready))


@app.command()
@plain_errors
def run(
    files: Annotated[list[Path], typer.Argument(metavar="CASE.toml|RESULT.nc...")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Result file of a single run.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the loads that a stopped run finished.")] = False,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Run a case, or run a result file again; print a table and write a result file for each run."""
    if output is not None:
        _require_writable(output, (".nc",))
    results = [file for file in files if file.suffix == ".nc"]
    if results and len(files) > 1:
        rule = "give one result, or cases alone"
        raise parameter_error("run", len(files), rule, finding=f"is given {results[0].name} among other files")
    if results:
        _run_again(results[0], output, as_json=as_json, force=force)
        return
    cases = [ready for file in files for ready in read_case(file)]
    _require_own_targets(cases)
    if output is not None:
        if len(cases) > 1:
            whose = files[0].name if len(files) == 1 else f"{len(files)} cases"
            finding = f"names one file, and {whose} makes {len(cases)} runs"
            raise parameter_error("--output", output, finding=finding, remedy="leave_out")
        cases = [cases[0].at(output)]
    work = [(ready, _begun(ready, resume=resume, force=force)) for ready in cases]
    done = []
    for number, (ready, (earlier, complete)) in enumerate(work, 1):
        if not as_json and len(work) > 1:
            print(f"run {number} of {len(work)}: " + ", ".join(f"{k} = {v}" for k, v in ready.varied.items()))
        result = complete or _run_one(ready, earlier, quiet=as_json)
        if complete and not as_json:
            print(f"{ready.target} is complete already")
        done.append(summary(result, ready.target, ready.varied))
    if as_json:
        print(json.dumps({"version": __version__, "runs": done}))


def _require_own_targets(cases: Sequence[ReadyCase]) -> None:
    """Refuse two runs that would write one file."""
    seen: set[Path] = set()
    for ready in cases:
        if ready.target in seen:
            rule = "give each case an [output] file of its own"
            raise parameter_error("run", ready.target.name, rule, finding=f"would write {ready.target.name} twice")
        seen.add(ready.target)


def _begun(ready: ReadyCase, *, resume: bool, force: bool) -> tuple[Result | None, Result | None]:
    """Finished loads to go on from, and the result of a run that is complete already."""
    target, part = ready.target, part_of(ready.target)
    if resume and target.exists() and not force:
        over_part = f"--resume --force overwrites it and goes on from {part.name}"
        complete = finished_loads(ready, target, over_part if part.exists() else "--force overwrites it")
        part.unlink(missing_ok=True)  # a stop between the last two steps of a run leaves it
        return None, complete
    if resume:
        return finished_loads(ready, part, "--force without --resume throws it away and starts anew"), None
    if force:
        return None, None
    if target.exists():
        raise OutputExistsError(f"{target} exists; --force overwrites it, --output names another file")
    if part.exists():
        raise OutputExistsError(
            f"{part} has the finished loads of a stopped run; --resume goes on, --force starts anew"
        )
    return None, None


def _run_one(ready: ReadyCase, earlier: Result | None, *, quiet: bool) -> Result:
    """Run one case, its table growing as loads finish."""
    table = cli_texts.LoadTableText(ready, quiet=quiet)
    if earlier is not None and not quiet:
        print(f"going on after {earlier.stress_ratio.size} finished loads")
        table.rows_of(earlier)
    with claimed(ready.target), warnings.catch_warnings():
        warnings.simplefilter("ignore", ResolutionWarning)  # printed below the table
        try:
            result = run_case(ready, earlier=earlier, on_load=table.add)
        except Interrupted as stopped:
            table.close()
            kept = 0 if stopped.result is None else stopped.result.stress_ratio.size
            where = f"; they are in {part_of(ready.target)}, and --resume goes on" if kept else ""
            _stop(f"interrupted after {kept} finished loads{where}", STOPPED)
    table.close()
    if not quiet:
        print(cli_texts.material_line(ready))
        cli_texts.print_remarks(result)
        print(f"wrote {ready.target}")
    return result


def _run_again(file: Path, output: Path | None, *, as_json: bool, force: bool) -> None:
    target = output or file.with_name(f"{file.stem}-again.nc")
    _refuse_existing(target, force)
    with claimed(target), warnings.catch_warnings():
        warnings.simplefilter("ignore", ResolutionWarning)
        result, same = run_file_again(file, target)
    if as_json:
        print(json.dumps({"version": __version__, "identical": same, "runs": [summary(result, target, {})]}))
    else:
        print(cli_texts.result_table(result))
        print(
            f"wrote {target}: "
            + ("every array equals that of " if same else "arrays differ from those of ")
            + file.name
        )
    if not same:
        raise typer.Exit(FAILED)


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
    as_json: Json = False,
) -> None:
    """Compute the indices of sieve tables, or of every load of results."""
    from comminute.cli import stats as cli_stats  # noqa: PLC0415  (keeps the other commands quick)
    from comminute.cli import tables as cli_tables  # noqa: PLC0415

    table = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    table |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    percents = cli_tables.percents_of(percentiles) if percentiles else cli_stats.PERCENTS
    found = [cli_stats.stats_of(file, extrapolate=extrapolate, percents=percents, **table) for file in files]
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
        _require_writable(output, cli_tables.ENDINGS)
        _refuse_existing(output, force)
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
        _refuse_existing(output, force)
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
        _require_writable(output, cli_tables.ENDINGS)
        _refuse_existing(output, force)
    reading = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    reading |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    percents = cli_tables.percents_of(percentiles) if percentiles else (10.0, 30.0, 50.0, 60.0, 80.0, 90.0)
    found = {"comparison": cli_tables.compared_files(before, after, percents=percents, table=reading)}
    print(json.dumps(cli_tables.record(found)) if as_json else found["comparison"])
    for written in cli_tables.save(found, output) if output is not None else []:
        if not as_json:
            print(f"wrote {written}")


def _plots(what: str) -> ModuleType:
    """Import the module that draws; the error names the extra where matplotlib is missing."""
    try:
        from comminute.cli import plots  # noqa: PLC0415  (matplotlib is optional)
    except ImportError as error:
        message = f"{what} needs matplotlib; install it with: pip install 'comminute[plot]'"
        raise ImportError(message) from error
    return plots


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
    cli_plots = _plots("plot")
    target = output or files[0].with_suffix(".png")
    _require_writable(target, cli_plots.ENDINGS)
    _refuse_existing(target, force)
    curves = {"axes": axes, "coarse_left": coarse_left, "phi": phi}
    table = {"number": number, "top": top, "sheet": sheet, "sample": sample}
    table |= {"mesh": mesh, "total_mass_g": total_mass_g, "edges": edges}
    cli_plots.draw(files, target, what=what, load=load, table=table, measured=measured or [], **curves)
    print(f"wrote {target}")


@app.command()
@plain_errors
def compare_closures(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Picture: .png, .pdf or .svg.")] = None,
    cells: Annotated[int, typer.Option("--cells", help="Cells of each of the lattice's four rings.")] = 100_000,
    threads: Annotated[int, typer.Option("--threads", help="Threads of the lattice.")] = 1,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Hold the paper's closure and the resolved one against the lattice, at the loads of a case."""
    from comminute.cli import closures as cli_closures  # noqa: PLC0415  (keeps the other commands quick)

    if output is not None:
        cli_plots = _plots("--output")
        _require_writable(output, cli_plots.ENDINGS)
        _refuse_existing(output, force)
    found = cli_closures.compared(read_case(case), cells=cells, threads=threads)
    print(json.dumps(cli_closures.record(found)) if as_json else f"{found.table()}\n{found.advice}")
    if output is not None:
        cli_plots.save(found.plot(), output)
        if not as_json:
            print(f"wrote {output}")


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
    cli_plots = _plots("--output") if drawn else None
    for target in targets:
        _require_writable(target, (".toml", ".json", *sorted(pictures)))
        _refuse_existing(target, force)
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
            found.save(target)
        if not as_json:
            print(f"wrote {target}")


@app.command()
@plain_errors
def cite() -> None:
    """Print what to cite."""
    print(cli_texts.citation())


@app.command()
@plain_errors
def doctor(as_json: Json = False) -> None:
    """Print versions and what this installation can do."""
    found = cli_texts.installation()
    print(json.dumps(found) if as_json else "\n".join(f"{name:12} {value}" for name, value in found.items()))


def _require_writable(output: Path, endings: Sequence[str]) -> None:
    if output.suffix not in endings:
        raise parameter_error("--output", f"'{output}'", f"it must end in {', '.join(endings)}")
    if not output.parent.is_dir():
        raise parameter_error("--output", f"'{output}'", "its folder does not exist")


def _refuse_existing(file: Path, force: bool) -> None:
    if file.exists() and not force:
        raise OutputExistsError(f"{shorten(str(file), 200)} exists; --force overwrites it")

"""Commands on cases: new, check, run, and how far their closures are from the lattice."""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from comminute._core import __version__
from comminute.cases.reading import ReadyCase, read_case
from comminute.cases.running import (
    claimed,
    finished_loads,
    part_of,
    run_case,
    run_file_again,
    summary,
)
from comminute.cli import texts as cli_texts
from comminute.cli.base import (
    FAILED,
    STOPPED,
    Force,
    Json,
    app,
    plain_errors,
    plots,
    refuse_existing,
    require_writable,
    stop,
)
from comminute.result import Interrupted, Result
from comminute.runs.remarks import ResolutionWarning
from comminute.util.errors import OutputExistsError, parameter_error


@app.command()
@plain_errors
def new(folder: Annotated[Path, typer.Argument(metavar="DIR")], force: Force = False) -> None:
    """Make a folder with a commented case and the sieve table of a real sand."""
    files = {folder / name: text for name, text in cli_texts.new_case().items()}
    for file in files:
        refuse_existing(file, force)
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
        require_writable(output, (".nc",))
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
            stop(f"interrupted after {kept} finished loads{where}", STOPPED)
    table.close()
    if not quiet:
        print(cli_texts.material_line(ready))
        cli_texts.print_remarks(result)
        print(f"wrote {ready.target}")
    return result


def _run_again(file: Path, output: Path | None, *, as_json: bool, force: bool) -> None:
    target = output or file.with_name(f"{file.stem}-again.nc")
    refuse_existing(target, force)
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
        cli_plots = plots("--output")
        require_writable(output, cli_plots.ENDINGS)
        refuse_existing(output, force)
    found = cli_closures.compared(read_case(case), cells=cells, threads=threads)
    print(json.dumps(cli_closures.record(found)) if as_json else f"{found.table()}\n{found.advice}")
    if output is not None:
        cli_plots.save(found.plot(), output)
        if not as_json:
            print(f"wrote {output}")

"""Runs of cases that survive whatever stops them: finished loads are kept in a file beside the one to come."""

from __future__ import annotations

import contextlib
import dataclasses
import glob
import json
import sys
import time
import warnings
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

from comminute._core import ParameterError, ResolvedGrid
from comminute.cases.reading import ReadyCase, case_of_text
from comminute.files.storage import require_netcdf, save_netcdf
from comminute.opening import open_result
from comminute.result import Interrupted, ResolvedResult, Result, finished, run_again
from comminute.runs.continuum import Setup, continuum_run, recipe_of, setup_of
from comminute.runs.load_path import wanted_fabrics
from comminute.runs.path_run import PathRun
from comminute.runs.remarks import ResolutionWarning
from comminute.runs.resolved_run import ResolvedSetup, resolved_run
from comminute.util.errors import OutputExistsError, wrong_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

LOADS_TO_SAVES = 4.0  # time spent on loads to time spent on saving what is finished


def part_of(target: Path) -> Path:
    """File with the finished loads of a run that has not reached its end."""
    return target.with_name(f"{target.stem}.part{target.suffix}")


@contextlib.contextmanager
def claimed(target: Path) -> Iterator[None]:
    """Keep a second run away from the same file for as long as this one lasts; the lock dies with the process."""
    lock = target.with_name(f".{target.stem}.lock")
    with lock.open("w") as file:
        try:
            _lock(file)
        except OSError:
            raise OutputExistsError(
                f"another run is writing {target.name}; wait for it, or name another file"
            ) from None
        for written in (target, part_of(target)):
            for scrap in target.parent.glob(f".{glob.escape(written.name)}.*.tmp"):  # left by a run that was killed
                scrap.unlink(missing_ok=True)
        try:
            yield
        finally:
            with contextlib.suppress(PermissionError):  # Windows keeps a file that is open
                lock.unlink(missing_ok=True)


def _lock(file: IO[str]) -> None:
    """Lock a file for this process, or raise OSError where another has done so."""
    if sys.platform == "win32":
        import msvcrt  # noqa: PLC0415  (Windows alone has it)

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl  # noqa: PLC0415  (POSIX alone has it)

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def finished_loads(case: ReadyCase, file: Path, remedy: str) -> Result | None:
    """Read what an earlier run of the same case left in a file, whole or in part; None if there is no file.

    `remedy` says what to do about a file of another case.

    Raises
    ------
    ParameterError
        If what is there belongs to another case.
    """
    if not file.exists():
        return None
    result = open_result(file)
    if result.recipe is None or result.recipe.case != case.text():
        raise wrong_file(file.name, "belongs to another case", remedy)
    return result


def run_case(
    case: ReadyCase, *, earlier: Result | None = None, on_load: Callable[[Result], object] | None = None
) -> Result:
    """Run a case to its end and write its file; stopped by Ctrl-C, keep the finished loads in the part file.

    Parameters
    ----------
    case : ReadyCase
    earlier : Result, optional
        Finished loads to go on from.
    on_load : callable, optional
        Called with the result so far after each load.

    Returns
    -------
    Result

    Raises
    ------
    Interrupted
        On Ctrl-C; its `result` has the finished loads.

    Warns
    -----
    ResolutionWarning
        As `Simulation.run`.
    """
    require_netcdf(f"saving {case.target.name}")  # before an hour of loads, and out of the first save's time
    result = earlier
    saved, cost, written = time.monotonic(), 0.0, False
    try:
        run = _path_run(case, earlier)
        for _ in run:
            result = run.result()
            assert result is not None
            if on_load is not None:
                on_load(result)
            begun = time.monotonic()
            if begun - saved >= LOADS_TO_SAVES * cost:
                save_netcdf(result, part_of(case.target))
                saved = time.monotonic()
                cost = saved - begun
        assert result is not None
        wanted = _wanted(case, result.grid.bins)
        fabrics = tuple(fabric if k in wanted else None for k, fabric in enumerate(result.fabrics))
        done = dataclasses.replace(result, fabrics=fabrics)
        save_netcdf(done, case.target)
        written = True
        part_of(case.target).unlink(missing_ok=True)
    except KeyboardInterrupt:
        if result is not None and not written:
            save_netcdf(result, part_of(case.target))
        raise Interrupted(result) from None
    for warning in done.warnings:
        warnings.warn(warning, ResolutionWarning, stacklevel=2)
    return done


def result_of(case: ReadyCase) -> Result:
    """Run a case to its end, write nothing and keep no fabric."""
    return finished(_path_run(case, None, keep=False))


def _path_run(case: ReadyCase, earlier: Result | None, *, keep: bool = True) -> PathRun[Any, Result]:
    """Run of a case; a file in between changes no bit.

    With `keep` it keeps the fabrics that the case asks for, and while it runs the last one, to go on from.
    """
    path, recipe = case.path(), case.recipe()
    if isinstance(case.grid, ResolvedGrid):
        start = case.simulation().initial_fabric(float(path.stress_ratio.max()))
        nodes = ResolvedSetup(case.material, case.grading, case.grid, start)
        return resolved_run(ResolvedResult, nodes, path, recipe, earlier=cast("ResolvedResult | None", earlier))
    if earlier is None:
        start = case.simulation().initial_fabric(float(path.stress_ratio.max()))
        setup = Setup.mixed(case.material, case.grading, start, case.resolved.engine.scheme)
    else:
        setup = setup_of(earlier)
    wanted = _wanted(case, setup.start.grid.bins) if keep else frozenset[int]()
    return continuum_run(Result, setup, path, recipe, wanted=wanted, keep_latest=keep, earlier=earlier)


def _wanted(case: ReadyCase, bins: int) -> frozenset[int]:
    """Find the loads whose fabric a case asks for."""
    if isinstance(case.grid, ResolvedGrid):
        return frozenset()
    return wanted_fabrics(case.resolved.output.fabrics, case.path().stress_ratio.size, bins)


def run_file_again(file: Path, target: Path) -> tuple[Result, bool]:
    """Run a result file again, from the case that it carries, or else from its start and recipe.

    Returns
    -------
    Result
    bool
        True if it equals the one in the file in every bit.

    Raises
    ------
    ParameterError
        For a file that is no result.
    """
    result = open_result(file)
    recipe = recipe_of(result)
    if recipe.case:
        again = run_case(case_of_text(recipe.case, target))
    else:
        again = run_again(result)
        save_netcdf(again, target)
    return again, again == result


def load_rows(result: Result) -> list[dict[str, Any]]:
    """One record per load for tables and JSON; a percentile in the fines bin is None."""
    rows = []
    for k in range(result.stress_ratio.size):
        curve = result.curve(k)
        row: dict[str, Any] = {} if result.stress is None else {"stress": float(result.stress[k])}
        row["stress_ratio"] = float(result.stress_ratio[k])
        for percent in (10, 50, 60):
            try:
                row[f"d{percent}"] = curve.percentile(percent)
            except ParameterError:
                row[f"d{percent}"] = None
        row |= {name: float(getattr(result, name)[k]) for name in ("fines", "crushes", "mass_error")}
        rows.append(row)
    return rows


def summary(result: Result, file: Path, varied: dict[str, Any]) -> dict[str, Any]:
    """Everything that `run --json` says of one run."""
    return {
        "file": str(file),
        "varied": json.loads(json.dumps(varied, default=str)),
        "unit": result.unit,
        "stress_unit": result.recipe.stress_unit if result.recipe else "",
        "closure": result.closure,
        "engine": result.engine,
        "bins": result.grid.bins,
        "loads": load_rows(result),
        "notes": list(result.notes),
        "warnings": list(result.warnings),
    }

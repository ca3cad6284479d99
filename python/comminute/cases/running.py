"""Runs of cases that survive whatever stops them: finished loads are kept in a file beside the one to come."""

from __future__ import annotations

import contextlib
import dataclasses
import glob
import json
import time
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from comminute import simulation
from comminute._core import ParameterError, remix
from comminute.cases.reading import ReadyCase, case_of_text
from comminute.files.storage import open_result, require_netcdf, save_netcdf
from comminute.runs import continuing
from comminute.runs.load_path import load_path
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning, resolution_warnings
from comminute.util.errors import wrong_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from comminute.result import Result

LOADS_TO_SAVES = 4.0  # time spent on loads to time spent on saving what is finished


class OutputExistsError(Exception):
    """A file that would be overwritten; the message says how to allow it."""


def part_of(target: Path) -> Path:
    """File with the finished loads of a run that has not reached its end."""
    return target.with_name(f"{target.stem}.part{target.suffix}")


@contextlib.contextmanager
def claimed(target: Path) -> Iterator[None]:
    """Keep a second run away from the same file for as long as this one lasts; the lock dies with the process."""
    import fcntl  # noqa: PLC0415  (POSIX alone has it)

    lock = target.with_name(f".{target.stem}.lock")
    with lock.open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
            lock.unlink(missing_ok=True)


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
        for result in _loads(case, earlier):
            if on_load is not None:
                on_load(result)
            begun = time.monotonic()
            if begun - saved >= LOADS_TO_SAVES * cost:
                save_netcdf(result, part_of(case.target))
                saved = time.monotonic()
                cost = saved - begun
        assert result is not None
        done = _wanted_fabrics(result, case)
        save_netcdf(done, case.target)
        written = True
        part_of(case.target).unlink(missing_ok=True)
    except KeyboardInterrupt:
        if result is not None and not written:
            save_netcdf(result, part_of(case.target))
        raise simulation.Interrupted(result) from None
    for warning in done.warnings:
        warnings.warn(warning, ResolutionWarning, stacklevel=2)
    return done


def _loads(case: ReadyCase, earlier: Result | None) -> Iterator[Result]:
    """Run load by load, each from the fabric after the last one, so that a file in between changes no bit."""
    load, engine = case.resolved.load, case.resolved.engine
    ratio, stress = load.stress_ratio, load.stress
    path = load_path(case.material, ratio, stress, load.loading_rate, load.remix_after)  # type: ignore[arg-type]
    sim = case.simulation()
    recipe = Recipe(
        (),
        (),
        engine.name,
        engine.kind,
        engine.steps_per_load,
        by_stress=path.by_stress,
        stress_unit=case.resolved.units.stress,
        case=case.text(),
    )
    whole = earlier
    if whole is None:
        fabric = sim.initial_fabric(float(path.stress_ratio.max()))
        start = fabric
    else:
        fabric = continuing.next_start(whole)
        start = whole.start
    first = 0 if whole is None else whole.stress_ratio.size
    for k in range(first, path.stress_ratio.size):
        part = continuing.one_load(case.material, sim.scheme, fabric, path, k, recipe)
        fabric = part.fabric(0)
        remixed = k in path.remix_after
        if remixed:
            fabric = remix(fabric)
        if whole is None:
            whole = _first(part, case, start, recipe, remixed=remixed)
        else:
            whole = continuing.joined(whole, part, keep=True, remixed=remixed)
        whole = _wanted_fabrics(whole, case, running=True)
        yield whole


def _first(part: Result, case: ReadyCase, start: Any, recipe: Recipe, *, remixed: bool) -> Result:
    """Give the result of the first load with the labels of the case."""
    own = continuing.recipe_of(part)
    recipe = dataclasses.replace(recipe, loading_rate=own.loading_rate, remix_after=(0,) if remixed else ())
    unit = case.grading.unit
    found = resolution_warnings(part.grid, part.material, part.stress_ratio, part.pmf, unit)
    notes = (*case.grading.notes, *part.notes)
    return dataclasses.replace(part, start=start, unit=unit, notes=notes, warnings=tuple(found), recipe=recipe)


def _wanted_fabrics(result: Result, case: ReadyCase, *, running: bool = False) -> Result:
    """Keep the fabrics that the case asks for, and while it runs the last one, to go on from."""
    loads = result.stress_ratio.size
    wanted = case.resolved.output.fabrics
    kept = set(range(loads)) if wanted == "all" else {loads - 1} if isinstance(wanted, str) else set(wanted)
    kept |= {loads - 1} if running else set()
    fabrics = tuple(fabric if k in kept else None for k, fabric in enumerate(result.fabrics))
    return dataclasses.replace(result, fabrics=fabrics)


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
    recipe = continuing.recipe_of(result)
    if recipe.case:
        again = run_case(case_of_text(recipe.case, target))
    else:
        again = continuing.run_again(result)
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
        "engine": result.engine,
        "bins": result.grid.bins,
        "loads": load_rows(result),
        "notes": list(result.notes),
        "warnings": list(result.warnings),
    }

"""Members of a sweep, some at a time, in whatever thread or process: their numbers, or why there are none."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from comminute._core import (
    CrushZones,
    LogGrid,
    Material,
    ParameterError,
    ShapeError,
    _MaterialSweep,
    fitting_grid,
    mixed_fabric,
    needed_spacing,
)
from comminute.cases.load_tables import path_of
from comminute.cases.reading import ReadyCase, material_of, with_values
from comminute.cases.running import result_of
from comminute.gradings.breakage import (
    breakage_potential,
    mean_log,
    silt_size,
    ultimate_mean_log,
)
from comminute.gradings.curves import SizeCurve
from comminute.gradings.sieves import unit_of
from comminute.result import Result
from comminute.runs.fines_bin import TOLERABLE_ERROR, reaches_fines
from comminute.runs.remarks import FINES_LIMIT, ResolutionWarning, spacing_warnings
from comminute.runs.walk import choices
from comminute.sweeping.layout import BY_LOAD, DONE, FAILED, LONGEST, WARNED, Rows, Value
from comminute.sweeping.plan import Plan

Floats = npt.NDArray[np.float64]
OF_MATERIAL = "material."


def rows_of(plan: Plan, members: Sequence[tuple[Value, ...]]) -> Rows:
    """Run members; one that cannot be run says why, and stops no other.

    Members that differ in their grains alone go through the core together, as far as that gives what a run of each by
    itself gives. Where the fines bin may matter, and for engines other than the quasi-static solver, a run it is.
    """
    columns = len(BY_LOAD) + len(plan.percents) + len(plan.sizes)
    rows = Rows(
        np.full((len(members), plan.loads, columns), np.nan),
        np.full(len(members), FAILED, dtype=np.uint8),
        [""] * len(members),
    )
    together = dict[tuple[Value, ...], list[int]]()
    grains = [key.startswith(OF_MATERIAL) for key in plan.keys]
    for index, values in enumerate(members):
        others = tuple(value for value, of_grains in zip(values, grains, strict=True) if not of_grains)
        together.setdefault(others, []).append(index)
    for indices in together.values():
        left = _run_together(plan, members, indices, rows)
        for index in left:
            _run_alone(plan, members[index], index, rows)
    return rows


def _run_alone(plan: Plan, values: tuple[Value, ...], index: int, rows: Rows) -> None:
    """Run one member as a case of its own."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResolutionWarning)  # kept in the message
            result = result_of(plan.case(values))
        found = _numbers_of(result, plan)
        if found.shape[0] != plan.loads:
            finding = f"has {found.shape[0]} loads, where the first member has {plan.loads}"
            rows.messages[index] = f"the member {finding}; members of one sweep have the same number"[:LONGEST]
            return
        rows.numbers[index] = found
        rows.status[index] = WARNED if result.warnings else DONE
        rows.messages[index] = "; ".join(result.warnings)[:LONGEST]
    except Exception as error:  # whatever stops one member must not stop the others
        text = str(error) if isinstance(error, ParameterError | ShapeError) else f"{type(error).__name__}: {error}"
        rows.messages[index] = text[:LONGEST]


def _numbers_of(result: Result, plan: Plan) -> Floats:
    """(T, C) numbers of a result."""
    measured = unit_of(result.unit) != ""
    start = result.start_curve
    potential = breakage_potential(start) if measured else 0.0
    rows = []
    for k, ratio in enumerate(result.stress_ratio):
        curve, fines = result.curve(k), float(result.fines[k])
        sizes = [curve.percentile(p) if p / 100.0 > curve.finer[0] else np.nan for p in plan.percents]
        left = breakage_potential(curve) if measured else np.nan
        fixed = [ratio, result.crushes[k], result.mass_error[k], fines, _mean_log(curve), left]
        rows.append([*fixed, *sizes, *curve.finer_than(plan.sizes)])
    numbers = np.array(rows, dtype=np.float64)
    _relate(numbers, start, potential)
    return numbers


def _mean_log(curve: SizeCurve) -> float:
    """Mean of ln(size), NaN for a curve whose end says nothing of it."""
    try:
        return mean_log(curve)
    except ParameterError:
        return np.nan


def _relate(numbers: Floats, start: SizeCurve, potential: float) -> None:
    """Turn means of ln(size), and Hardin's potentials, into Einav's and Hardin's breakage since the start, in place."""
    before, ultimate = _mean_log(start), ultimate_mean_log(float(start.size[-1]))
    span = before - ultimate
    place = BY_LOAD.index("breakage")
    numbers[..., place] = (before - numbers[..., place]) / span if span > 0.0 else np.nan
    place = BY_LOAD.index("relative_breakage")
    numbers[..., place] = (potential - numbers[..., place]) / potential if potential > 0.0 else np.nan


def _run_together(plan: Plan, members: Sequence[tuple[Value, ...]], indices: list[int], rows: Rows) -> list[int]:
    """Run members that differ in their grains alone, as far as that can be done; give the indices of those left."""
    try:
        first = plan.case(members[indices[0]])
    except (ParameterError, ShapeError):
        return indices
    if not _solved(first) or first.path().stress_ratio.size != plan.loads:
        return indices
    load = first.resolved.load
    stresses = None if load.stress is None else np.asarray(load.stress, dtype=np.float64)
    table, bins = first.resolved.material.model_dump(), first.bins_asked.model_dump()
    varied = [(k, key.removeprefix(OF_MATERIAL)) for k, key in enumerate(plan.keys) if key.startswith(OF_MATERIAL)]
    grids = dict[LogGrid, list[tuple[int, Material, Floats]]]()
    left = []
    for index in indices:
        try:
            values = members[index]
            material = material_of(with_values(table, {name: values[k] for k, name in varied}))
            loads = path_of(material, load).stress_ratio if stresses is None else material.stress_ratio(stresses)
            grid = fitting_grid(first.grading, material, float(loads.max()), **bins)
        except (ParameterError, ShapeError, TypeError, KeyError):
            left.append(index)
            continue
        if material.strength_scatter or spacing_warnings(grid, needed_spacing(material, first.grading)):
            left.append(index)
        else:
            grids.setdefault(grid, []).append((index, material, loads))
    for grid, problems in grids.items():
        left += _solve(plan, first, grid, problems, rows)
    return left


def _solved(case: ReadyCase) -> bool:
    """Tell whether one solver takes the mixed start to each load of a case."""
    path, recipe = case.path(), case.recipe()
    engines = set(choices(recipe))
    one_rate = np.ptp(path.loading_rate) == 0.0
    return (
        case.even_grid is not None
        and one_rate
        and {name for _, name in engines} == {"quasi-static"}
        and not any(place + 1 < path.stress_ratio.size for place in path.remix_after)
    )


def _solve(
    plan: Plan, case: ReadyCase, grid: LogGrid, problems: list[tuple[int, Material, Floats]], rows: Rows
) -> list[int]:
    """Solve for many materials on one grid; give the indices of those whose fines call for a run."""
    grading, engine = case.grading, case.resolved.engine
    start = mixed_fabric(grading, grid, mean=engine.mean)
    measured = SizeCurve.of(grading) if grading.measured else None
    unit = unit_of(grading.unit)
    kinds = {kind for kind, _ in choices(case.recipe())}
    rate = 1.0 if "fast" in kinds else float(case.path().loading_rate[0])
    silt = silt_size(unit) if unit else 0.0
    sieves = None if measured is None else measured.numbers
    sweep = _MaterialSweep(start, sieves, plan.percents, plan.sizes, silt, engine.scheme, rate)
    loads = np.array([loads for _, _, loads in problems])
    found, faults = sweep.run([material for _, material, _ in problems], loads)
    numbers = np.concatenate([loads[..., None], found], axis=-1)
    before = measured or SizeCurve.on_grid(grid, start.cdf(), grading.unit, start.points, start.largest)
    _relate(numbers, before, breakage_potential(before) if unit else 0.0)
    first_fines, most_fines = float(start.grainsize()[0]), numbers[..., BY_LOAD.index("fines")].max(axis=1)
    left = []
    for place, (index, material, ratios) in enumerate(problems):
        if place in faults or _fines_matter(grid, material, float(ratios.max()), first_fines, float(most_fines[place])):
            left.append(index)
            continue
        rows.numbers[index] = numbers[place]
        rows.status[index] = DONE
    return left


def _fines_matter(grid: LogGrid, material: Material, load: float, first_fines: float, most_fines: float) -> bool:
    """Tell whether a run may have to warn of the fines bin: of much in it, or of grains judged by their place in it."""
    if first_fines > TOLERABLE_ERROR or most_fines > FINES_LIMIT:
        return True
    if first_fines + most_fines <= TOLERABLE_ERROR:
        return False
    return reaches_fines(CrushZones(grid, material, load), material)

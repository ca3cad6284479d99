"""Runs: a start, a load path, and the engine that takes one through the other."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from comminute._core import (
    CrushZones,
    Fabric,
    FullConvolution,
    Grading,
    LogGrid,
    Material,
    ParameterError,
    PointMass,
    QuasiStatic,
    SlowUpdate,
    SolveReport,
    StepReport,
    fitting_grid,
    mixed_fabric,
    remix,
)
from comminute.recipe import Recipe
from comminute.results import Result

Kind = Literal["slow", "exact", "fast", "blend"]
Mean = Literal["arithmetic", "geometric"]
Scheme = Literal["conservative", "paper"]
EngineName = Literal["auto", "quasi-static", "slow-update", "full-convolution"]
Floats = npt.NDArray[np.float64]

FINES_LIMIT = 0.01
ENGINES = ("auto", "quasi-static", "slow-update", "full-convolution")


class ResolutionWarning(UserWarning):
    """Curves near the grid's lower end are not to be trusted; the message says below which size."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `result` has the loads that were finished (None if there are none)."""

    def __init__(self, result: Result | None) -> None:
        done = 0 if result is None else len(result.stress_ratio)
        super().__init__(f"interrupted after {done} finished loads; they are in .result")
        self.result = result


@dataclass(frozen=True)
class LoadPath:
    """The loads of one run, checked: one entry of each field per load."""

    stress_ratio: Floats
    stress: Floats | None
    loading_rate: Floats
    remix_after: frozenset[int]
    by_stress: bool


def _loads(name: str, values: float | Iterable[float]) -> Floats:
    loads = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if loads.ndim != 1 or loads.size == 0:
        raise ParameterError(f"{name} has shape {loads.shape}; it must be a list of at least one load")
    for index, load in enumerate(loads):
        if not load >= 0.0:
            raise ParameterError(f"{name}[{index}] is {load:g}; it must be a number of at least 0 (0 is no load)")
    return loads


def _load_path(
    material: Material,
    stress_ratio: float | Iterable[float] | None,
    stress: float | Iterable[float] | None,
    loading_rate: float | Iterable[float],
    remix_after: Iterable[int],
) -> LoadPath:
    if (stress_ratio is None) == (stress is None):
        raise ParameterError("give either stress_ratio or stress, and not both")
    stresses: Floats | None
    if stress is not None:
        stresses = _loads("stress", stress)
        ratios = np.asarray(material.stress_ratio(stresses), dtype=np.float64)
    else:
        assert stress_ratio is not None
        ratios = _loads("stress_ratio", stress_ratio)
        unit = material.first_crush_stress
        stresses = None if unit is None else ratios * unit
    rates = np.asarray(loading_rate, dtype=np.float64)
    if rates.ndim > 1 or (rates.ndim == 1 and rates.shape != ratios.shape):
        raise ParameterError(
            f"loading_rate has shape {rates.shape}; it must be one number or one for each of the {ratios.size} loads"
        )
    rates = np.broadcast_to(rates, ratios.shape).astype(np.float64)
    for index, rate in enumerate(rates):
        if not 0.0 <= rate <= 1.0:
            raise ParameterError(f"loading_rate[{index}] is {rate:g}; it must be between 0 and 1")
    indices = frozenset(int(k) for k in remix_after)
    for index in sorted(indices):
        if not 0 <= index < ratios.size:
            raise ParameterError(f"remix_after has {index}; it must hold indices of loads, 0 to {ratios.size - 1}")
    return LoadPath(ratios, stresses, rates, indices, by_stress=stress is not None)


def _kind_of(kind: Kind | None, rate: float) -> Kind:
    """Kernel of one load: slow unless a rate or a kind says otherwise."""
    if kind is None:
        return "blend" if rate > 0.0 else "slow"
    if rate > 0.0 and kind != "blend":
        raise ParameterError(
            f"loading_rate is {rate:g} but kind is '{kind}'; a rate belongs to the blend: leave kind out"
        )
    return kind


def _engine_of(name: EngineName, kind: Kind, rate: float, *, steps: int | None) -> EngineName:
    """Engine that takes one load, where it can."""
    solvable = kind != "exact" and steps is None
    if name == "auto":
        if solvable:
            return "quasi-static"
        return "slow-update" if kind == "slow" else "full-convolution"
    if name == "quasi-static" and kind == "exact":
        raise ParameterError(
            'engine "quasi-static" has no solve for kind "exact", whose outcome depends on the steps; '
            'use engine "full-convolution" or "auto"'
        )
    if name == "quasi-static" and steps is not None:
        raise ParameterError(
            f'steps_per_load is {steps} but engine "quasi-static" takes no steps; leave steps_per_load at "rest", '
            'or use engine "slow-update" or "full-convolution"'
        )
    if name == "slow-update" and kind != "slow":
        raise ParameterError(
            f'engine "slow-update" has the slow kernel only, and this load asks for kind "{kind}" '
            f'(loading_rate {rate:g}); use engine "full-convolution" or "auto"'
        )
    return name


@dataclass(frozen=True)
class _Outcome:
    """Grading after one load, and its fabric where that is wanted."""

    grainsize: Floats
    points: tuple[PointMass, ...]
    crushed: float
    report: SolveReport | StepReport
    fabric: Fabric | None


@dataclass
class _Segment:
    """Solves between two remixings or changes of rate, each from the last fabric that was wanted."""

    solver: QuasiStatic
    start: Fabric
    crushed_before: float
    largest: float = 0.0

    def after(self, load: float, *, with_fabric: bool) -> _Outcome:
        """Outcome of one more load: one solve to the largest so far, since the way there does not matter."""
        self.largest = max(self.largest, load)
        if with_fabric:
            fabric = self.solver.solve(self.start, self.largest)
            report = self.solver.report
            self.start, self.crushed_before = fabric, self.crushed_before + report.crushed
            return _Outcome(fabric.grainsize(), tuple(fabric.points), self.crushed_before, report, fabric)
        after = self.solver.grading_after(self.start, self.largest)
        crushed = self.crushed_before + after.report.crushed
        return _Outcome(after.grainsize, tuple(after.points), crushed, after.report, None)


class _Engines:
    """Makes the engine of each load, and keeps it for the loads that want the same."""

    def __init__(self, grid: LogGrid, material: Material, scheme: Scheme) -> None:
        self._grid = grid
        self._material = material
        self._scheme = scheme
        self._steppers: dict[tuple[EngineName, Kind, float], SlowUpdate | FullConvolution] = {}
        self._solvers: dict[float, QuasiStatic] = {}
        self.names: list[str] = []

    def _note(self, name: EngineName) -> None:
        if name not in self.names:
            self.names.append(name)

    def stepper(self, name: EngineName, kind: Kind, rate: float) -> SlowUpdate | FullConvolution:
        self._note(name)
        rate = rate if kind == "blend" else 0.0
        if (name, kind, rate) not in self._steppers:
            self._steppers[name, kind, rate] = (
                SlowUpdate(self._grid, self._material, fragment_rule=self._scheme)
                if name == "slow-update"
                else FullConvolution(self._grid, self._material, kind, loading_rate=rate, fragment_rule=self._scheme)
            )
        return self._steppers[name, kind, rate]

    def solver(self, rate: float) -> QuasiStatic:
        self._note("quasi-static")
        if rate not in self._solvers:
            self._solvers[rate] = QuasiStatic(self._grid, self._material, self._scheme, rate)
        return self._solvers[rate]


@dataclass
class _Records:
    """What a run writes down after each load."""

    outcomes: list[_Outcome] = field(default_factory=list)
    kept: list[Fabric | None] = field(default_factory=list)

    def add(self, outcome: _Outcome, *, keep: bool) -> None:
        self.outcomes.append(outcome)
        self.kept.append(outcome.fabric if keep else None)


class _Path:
    """Walks a load path: what has been loaded so far, and how the next load is taken from there."""

    def __init__(self, start: Fabric, engines: _Engines, steps: int | None) -> None:
        self._fabric = start
        self._engines = engines
        self._steps = steps
        self._crushed = 0.0
        self._segment: _Segment | None = None

    def load(self, name: EngineName, kind: Kind, rate: float, load: float, *, with_fabric: bool) -> _Outcome:
        """Take the packing through one load."""
        if name != "quasi-static":
            self._close_segment()
            return self._step(name, kind, rate, load)
        solver = self._engines.solver(1.0 if kind == "fast" else rate)
        if self._segment is None or self._segment.solver is not solver:
            self._close_segment()
            self._segment = _Segment(solver, self._fabric, self._crushed)
        return self._segment.after(load, with_fabric=with_fabric)

    def remix(self) -> None:
        """Mix the packing anew."""
        self._close_segment()
        self._fabric = remix(self._fabric)

    def _close_segment(self) -> None:
        """Bring the fabric up to date before something starts from it."""
        if self._segment is not None:
            done = self._segment.after(0.0, with_fabric=True)
            assert done.fabric is not None
            self._fabric, self._crushed, self._segment = done.fabric, done.crushed, None

    def _step(self, name: EngineName, kind: Kind, rate: float, load: float) -> _Outcome:
        engine = self._engines.stepper(name, kind, rate)
        before = self._fabric.binned()
        p = engine.settle(before.probability, load, steps=self._steps)
        # After a fixed number of steps some mass may still lie inside the zone: at rest under no known load.
        settled = max(load, before.settled_at or 0.0) if self._steps is None else None
        self._fabric = Fabric(before.grid, p, settled_at=settled, mean=before.mean)
        self._crushed += engine.report.crushed
        return _Outcome(self._fabric.grainsize(), (), self._crushed, engine.report, self._fabric)


class Simulation:
    """A material and a start, ready to be loaded.

    Parameters
    ----------
    material : Material
    start : Grading or Fabric
        A grading is mixed completely (Eq. 64); a fabric is taken as it is, on its own grid.
    grid : LogGrid, optional
        For a grading. Left out, `run` sizes one from grading, fragments and largest load
        (`fitting_grid`).
    mean : {"arithmetic", "geometric"}
        How two neighbours make a neighbourhood grainsize (Eq. 48 or 65), for a grading.
    scheme : {"conservative", "paper"}
        How fragments fall into bins; see `fragment_pmf`.

    Raises
    ------
    ParameterError
        For a scheme it does not know, or a grid beside a fabric that has another.

    Examples
    --------
    >>> import comminute as cm
    >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0))
    >>> result = sim.run(stress_ratio=[0.5, 1.0])
    >>> result.crushes[0], bool(result.crushes[1] > 0.4)
    (np.float64(0.0), True)
    """

    def __init__(
        self,
        material: Material,
        start: Grading | Fabric,
        *,
        grid: LogGrid | None = None,
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        if scheme not in ("conservative", "paper"):
            raise ParameterError(f"scheme is '{scheme}'; it must be one of 'conservative', 'paper'")
        if isinstance(start, Fabric) and grid is not None and grid != start.grid:
            raise ParameterError(f"grid is {grid} but the fabric has {start.grid}; leave grid out")
        self.material = material
        self.start = start
        self.grid = start.grid if isinstance(start, Fabric) else grid
        self.mean: Mean = mean
        self.scheme: Scheme = scheme

    def __eq__(self, other: object) -> bool:
        """Equal in everything that a run depends on."""
        return isinstance(other, Simulation) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        grid = "" if self.grid is None else f", grid={self.grid}"
        return f"Simulation({self.material}, {self.start}{grid}, mean='{self.mean}', scheme='{self.scheme}')"

    def initial_fabric(self, max_stress_ratio: float) -> Fabric:
        """Fabric at the start of a run up to a load, on the grid that the run uses.

        Parameters
        ----------
        max_stress_ratio : float
            Largest load to come; sizes the grid where none was given.

        Returns
        -------
        Fabric
        """
        if isinstance(self.start, Fabric):
            return self.start
        grid = self.grid or fitting_grid(self.start, self.material, max_stress_ratio)
        return mixed_fabric(self.start, grid, mean=self.mean)

    def run(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: float | Iterable[float] | None = None,
        loading_rate: float | Iterable[float] = 0.0,
        remix_after: Iterable[int] = (),
        engine: EngineName = "auto",
        kind: Kind | None = None,
        steps_per_load: int | Literal["rest"] = "rest",
        keep_fabrics: Literal["all", "last"] | Sequence[int] = "all",
        on_load: Callable[[int], object] | None = None,
    ) -> Result:
        """Take the start through a load path.

        Parameters
        ----------
        stress_ratio : float or sequence
            Loads, each >= 0, in any order: unloading and 0 are allowed.
        stress : float or sequence
            The same in the unit of the material's first_crush_stress. Give one of the two.
        loading_rate : float or sequence
            Share of the fast kernel (Eq. 67), in [0, 1], one for all or one per load.
        remix_after : sequence of int
            Indices of loads after which the packing is remixed.
        engine : {"auto", "quasi-static", "slow-update", "full-convolution"}
            "auto" takes the quasi-static solver wherever it is exact: every kernel but "exact", to rest.
            Otherwise the slow update for the slow kernel, and the full convolution for the others.
        kind : {"slow", "exact", "fast", "blend"}, optional
            Kernel. Left out: slow, or the blend where a loading rate is given.
        steps_per_load : int or "rest"
            For time-stepping engines, steps at each load: a number, or as many as bring the state to rest.
        keep_fabrics : {"all", "last"} or sequence of int
            For which loads `Result.fabric` is kept, N x N numbers each.
        on_load : callable, optional
            Called with the index of each load when it is finished, for progress bars.

        Returns
        -------
        Result

        Raises
        ------
        ParameterError
            For a load, rate, index or word outside its range; the message names it.
        Interrupted
            On Ctrl-C; its `result` has the finished loads.

        Warns
        -----
        ResolutionWarning
            If more than 1 % of the mass ends in the fines bin, or the crush zone reaches it.
        """
        path = _load_path(self.material, stress_ratio, stress, loading_rate, remix_after)
        if engine not in ENGINES:
            raise ParameterError(f"engine is '{engine}'; it must be one of {', '.join(map(repr, ENGINES))}")
        if steps_per_load != "rest" and not (isinstance(steps_per_load, int) and steps_per_load >= 1):
            raise ParameterError(f'steps_per_load is {steps_per_load!r}; it must be "rest" or a number of at least 1')
        fabric = self.initial_fabric(float(path.stress_ratio.max()))
        engines = _Engines(fabric.grid, self.material, self.scheme)
        wanted = _wanted(keep_fabrics, path.stress_ratio.size)
        steps = None if steps_per_load == "rest" else steps_per_load
        rules = [_kind_of(kind, float(rate)) for rate in path.loading_rate]
        names = [
            _engine_of(engine, rule, float(rate), steps=steps)
            for rule, rate in zip(rules, path.loading_rate, strict=True)
        ]
        records = _Records()
        walk = _Path(fabric, engines, steps)
        rates, remixed = tuple(path.loading_rate.tolist()), tuple(sorted(path.remix_after))
        chained = len(wanted) == path.stress_ratio.size
        recipe = Recipe(rates, remixed, engine, kind, steps_per_load, path.by_stress, chained)
        try:
            for k, load in enumerate(path.stress_ratio):
                rate = float(path.loading_rate[k])
                outcome = walk.load(names[k], rules[k], rate, float(load), with_fabric=k in wanted)
                records.add(outcome, keep=k in wanted)
                if k in path.remix_after:
                    walk.remix()
                if on_load is not None:
                    on_load(k)
        except KeyboardInterrupt:
            done = len(records.outcomes)
            raise Interrupted(self._result(fabric, path, engines, records, recipe) if done else None) from None
        result = self._result(fabric, path, engines, records, recipe)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=2)
        return result

    def _result(self, start: Fabric, path: LoadPath, engines: _Engines, records: _Records, recipe: Recipe) -> Result:
        done = len(records.outcomes)
        pmf = np.array([outcome.grainsize for outcome in records.outcomes])
        crushes = np.array([outcome.crushed for outcome in records.outcomes])
        ratios = path.stress_ratio[:done]
        unit = self.start.unit if isinstance(self.start, Grading) else ""
        assumed = self.start.notes if isinstance(self.start, Grading) else ()
        return Result(
            material=self.material,
            grid=start.grid,
            start=start,
            unit=unit,
            stress_ratio=ratios,
            stress=None if path.stress is None else path.stress[:done],
            pmf=pmf,
            crushes=crushes,
            mass_error=np.array([math.fsum(row) - 1.0 for row in pmf]),
            engine=" + ".join(engines.names),
            scheme=self.scheme,
            notes=(*assumed, *_explained(ratios, crushes)),
            warnings=tuple(_resolution_warnings(start.grid, self.material, ratios, pmf, unit)),
            fabrics=tuple(records.kept),
            points=tuple(outcome.points for outcome in records.outcomes),
            reports=tuple(outcome.report for outcome in records.outcomes),
            recipe=recipe.of_first(done),
        )


def _wanted(keep: Literal["all", "last"] | Sequence[int], loads: int) -> frozenset[int]:
    if keep == "all":
        return frozenset(range(loads))
    if keep == "last":
        return frozenset([loads - 1])
    if isinstance(keep, str):
        raise ParameterError(f"keep_fabrics is '{keep}'; it must be 'all', 'last' or indices of loads")
    for index in keep:
        if not 0 <= index < loads:
            raise ParameterError(f"keep_fabrics has {index}; it must hold indices of loads, 0 to {loads - 1}")
    return frozenset(keep)


def _explained(loads: Floats, crushes: Floats) -> list[str]:
    """One line each for loads that are allowed but may surprise."""
    notes = []
    if np.any((loads > 0.0) & (loads < 1.0)):
        notes.append("stress ratios below 1 crush only grains larger than the reference size (more so among equals)")
    if np.any(np.diff(loads) < 0.0):
        notes.append("unloading changes nothing: a load crushes only where it exceeds all earlier ones")
    if crushes[-1] == 0.0:
        notes.append("nothing crushed: the load path stays below what the weakest grain bears")
    return notes


def _resolution_warnings(grid: LogGrid, material: Material, loads: Floats, pmf: Floats, unit: str) -> list[str]:
    """Where the fines bin spoils the answer, and below which size."""
    in_unit = f" {unit}" if unit else ""
    found = []
    worst = int(np.argmax(pmf[:, 0]))
    if pmf[worst, 0] > FINES_LIMIT:
        found.append(
            f"{100 * pmf[worst, 0]:.3g} % of the mass lies in the fines bin at stress ratio "
            f"{loads[worst]:g}: curves below a size of {grid.edge_sizes[1]:.3g}{in_unit} are not to be "
            "trusted; lower psi_min"
        )
    distrusted = CrushZones(grid, material, float(loads.max())).distrusted_below
    if distrusted > -math.inf:
        size = math.exp(min(distrusted, 700.0))
        found.append(
            f"the crush zone reaches the fines bin at stress ratio {loads.max():g}: curves below a size of "
            f"{size:.3g}{in_unit} are not exact; lower psi_min"
        )
    return found

"""The continuum along a load path: which kernel and engine take a load, and from which fabric."""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate

from comminute._core import (
    Fabric,
    FullConvolution,
    LogGrid,
    Marginal,
    Material,
    QuasiStatic,
    SlowUpdate,
    remix,
)
from comminute.runs.load_path import Load, LoadPath
from comminute.runs.outcomes import Outcome, mass_error
from comminute.runs.recipe import Recipe
from comminute.util.choices import EngineName, Kind, Scheme, require_word
from comminute.util.errors import parameter_error

LOADS_AHEAD = 16  # whose gradings are solved together; a Ctrl-C waits for so many
SEPARATOR = " + "  # between the engines of a result that took more than one


def kind_of(kind: Kind | None, rate: float) -> Kind:
    """Kernel of one load: slow unless a rate or a kind says otherwise."""
    if kind is None:
        return "blend" if rate > 0.0 else "slow"
    require_word("kind", kind, Kind)
    if rate > 0.0 and kind != "blend":
        finding = f"is {rate:g} but kind is '{kind}'"
        raise parameter_error("loading_rate", rate, "a rate belongs to the blend: leave kind out", finding=finding)
    return kind


def engine_of(name: EngineName, kind: Kind, rate: float, *, steps: int | None) -> EngineName:
    """Engine that takes one load of a kernel; an error where the one asked for cannot."""
    solvable = kind != "exact" and steps is None
    if name == "auto":
        if solvable:
            return "quasi-static"
        return "slow-update" if kind == "slow" else "full-convolution"
    if name == "quasi-static" and kind == "exact":
        finding = 'has no solve for kind "exact", whose outcome depends on the steps'
        rule = 'use engine "full-convolution" or "auto"'
        raise parameter_error("engine", name, rule, subject='engine "quasi-static"', finding=finding)
    if name == "quasi-static" and steps is not None:
        finding = f'is {steps} but engine "quasi-static" takes no steps'
        rule = 'leave steps_per_load at "rest", or use engine "slow-update" or "full-convolution"'
        raise parameter_error("steps_per_load", steps, rule, finding=finding)
    if name == "slow-update" and kind != "slow":
        finding = f'has the slow kernel only, and this load asks for kind "{kind}" (loading_rate {rate:g})'
        rule = 'use engine "full-convolution" or "auto"'
        raise parameter_error("engine", name, rule, subject='engine "slow-update"', finding=finding)
    return name


def choices(recipe: Recipe) -> list[tuple[Kind, EngineName]]:
    """Kernel and engine of each load that a recipe names.

    Raises
    ------
    ParameterError
        For the first load that the engine asked for cannot take.
    """
    steps = steps_of(recipe)
    kinds = [kind_of(recipe.kind, rate) for rate in recipe.loading_rate]
    rates = recipe.loading_rate
    return [(kind, engine_of(recipe.engine, kind, rate, steps=steps)) for kind, rate in zip(kinds, rates, strict=True)]


def steps_of(recipe: Recipe) -> int | None:
    """Find how many steps a time-stepping engine takes at each load; None: as many as bring the packing to rest."""
    return None if recipe.steps_per_load == "rest" else recipe.steps_per_load


class _Segment:
    """Solves between two remixings or changes of solver, each from the fabric at the beginning.

    The way to a load does not matter to its outcome, so one solve to the largest load so far gives it. A fabric is
    computed where it is asked for, and whether it is changes no bit of any outcome. Gradings are solved for some loads
    ahead, since many together take less time than one after the other.
    """

    def __init__(self, solver: QuasiStatic, fabric: Fabric, crushed: float) -> None:
        self.solver = solver
        self._fabric = fabric
        self._crushed = crushed
        self._largest = 0.0
        self._latest: tuple[Fabric, float] | None = None  # after the largest load, where it is known
        self._gradings: dict[float, Outcome] = {}  # after this load and some larger ones

    def after(self, load: float, *, with_fabric: bool, ahead: Callable[[], list[float]] = list) -> Outcome:
        """Outcome of one more load; `ahead` gives the loads that come after it."""
        self._raise_to(load)
        if not with_fabric:
            if self._largest not in self._gradings:
                self._look_ahead(ahead())
            return self._gradings[self._largest]
        fabric, report = self.solver.solve(self._fabric, self._largest), self.solver.report
        grainsize, crushed = fabric.grainsize(), self._crushed + report.crushed
        self._latest = fabric, crushed
        return Outcome(grainsize, crushed, mass_error(grainsize), tuple(fabric.points), report, fabric)

    def skip(self, load: float, outcome: Outcome) -> None:
        """Go past a load whose outcome is known."""
        self._raise_to(load)
        if outcome.fabric is not None:
            self._latest = outcome.fabric, outcome.crushed

    def end(self) -> tuple[Fabric, float]:
        """Fabric after the last load, and the crushes a cell has been through by then."""
        if self._latest is None:
            self.after(0.0, with_fabric=True)
            assert self._latest is not None
        return self._latest

    def _look_ahead(self, loads: list[float]) -> None:
        largest = list(dict.fromkeys(accumulate([self._largest, *loads], max)))
        gradings = self.solver.gradings_after(self._fabric, largest)
        self._gradings = {load: self._outcome(after) for load, after in zip(largest, gradings, strict=True)}

    def _outcome(self, after: Marginal) -> Outcome:
        report = after.report
        points = tuple(after.points)
        return Outcome(after.grainsize, self._crushed + report.crushed, after.mass_error, points, report)

    def _raise_to(self, load: float) -> None:
        if load > self._largest:
            self._largest, self._latest = load, None


class Engines:
    """Engines of one grid and material, each made for the first load that it takes and kept for the others."""

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
        """Time-stepping engine of a kernel and loading rate."""
        self._note(name)
        rate = rate if kind == "blend" else 0.0
        if (name, kind, rate) not in self._steppers:
            self._steppers[name, kind, rate] = (
                SlowUpdate(self._grid, self._material, scheme=self._scheme)
                if name == "slow-update"
                else FullConvolution(self._grid, self._material, kind, loading_rate=rate, scheme=self._scheme)
            )
        return self._steppers[name, kind, rate]

    def solver(self, rate: float) -> QuasiStatic:
        """Quasi-static solver of a loading rate."""
        self._note("quasi-static")
        if rate not in self._solvers:
            self._solvers[rate] = QuasiStatic(self._grid, self._material, self._scheme, rate)
        return self._solvers[rate]


class ContinuumWalker:
    """Fabric of the continuum on its way along a load path.

    Parameters
    ----------
    fabric : Fabric
        State before the first load to come.
    material : Material
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`.
    recipe : Recipe
        Kernel and engine of each load of the path, and the steps a time-stepping engine takes.
    path : LoadPath
        Loads of the recipe.

    Raises
    ------
    ParameterError
        For a load that the engine asked for cannot take.
    """

    def __init__(self, fabric: Fabric, material: Material, scheme: Scheme, recipe: Recipe, path: LoadPath) -> None:
        self._choices = choices(recipe)
        self._path = path
        self._engines = Engines(fabric.grid, material, scheme)
        self._fabric = fabric
        self._steps = steps_of(recipe)
        self._crushed = 0.0
        self._segment: _Segment | None = None
        self._segment_is_of: tuple[Kind, float] | None = None

    @property
    def engine(self) -> str:
        """Engines that have taken a load, in the order of their first."""
        return SEPARATOR.join(self._engines.names)

    def load(self, load: Load, *, with_fabric: bool) -> Outcome:
        """Take the fabric through one load; see `Walker`."""
        kind, name = self._choices[load.place]
        if name != "quasi-static":
            self._end_segment()
            return self._step(name, kind, load)
        segment = self._segment_of(kind, load)
        return segment.after(load.stress_ratio, with_fabric=with_fabric, ahead=lambda: self._ahead(load))

    def _ahead(self, load: Load) -> list[float]:
        """Find the loads after this one that the same solver takes on from the same fabric."""
        path, first = self._path, load.place
        end = min(first + LOADS_AHEAD, len(self._choices))
        for place in range(first, end):
            other = place + 1 < end and (self._choices[place + 1], path.loading_rate[place + 1])
            if place in path.remix_after or other != (self._choices[first], load.loading_rate):
                return list(path.stress_ratio[first + 1 : place + 1].tolist())
        return []

    def skip(self, load: Load, outcome: Outcome) -> None:
        """Go past a load whose outcome is known, to the state in which taking it would have ended, in every bit."""
        kind, name = self._choices[load.place]
        if name == "quasi-static":
            self._segment_of(kind, load).skip(load.stress_ratio, outcome)
            return
        self._end_segment()
        if outcome.fabric is None:
            self._step(name, kind, load)
        else:
            self._engines.stepper(name, kind, load.loading_rate)  # which names it
            self._fabric, self._crushed = outcome.fabric, outcome.crushed

    def _segment_of(self, kind: Kind, load: Load) -> _Segment:
        if self._segment is not None and self._segment_is_of == (kind, load.loading_rate):
            return self._segment
        self._segment_is_of = kind, load.loading_rate
        solver = self._engines.solver(1.0 if kind == "fast" else load.loading_rate)
        if self._segment is None or self._segment.solver is not solver:
            self._end_segment()
            self._segment = _Segment(solver, self._fabric, self._crushed)
        return self._segment

    def remix(self) -> None:
        """Mix the packing anew."""
        self._end_segment()
        self._fabric = remix(self._fabric)

    def _end_segment(self) -> None:
        """Bring the fabric up to date before something else starts from it."""
        if self._segment is not None:
            self._fabric, self._crushed = self._segment.end()
            self._segment = None

    def _step(self, name: EngineName, kind: Kind, load: Load) -> Outcome:
        engine = self._engines.stepper(name, kind, load.loading_rate)
        before = self._fabric.binned()
        p = engine.settle(before.probability, load.stress_ratio, steps=self._steps)
        # A fixed number of steps may leave mass inside the zone: the state is then at rest under no known load.
        settled = max(load.stress_ratio, before.settled_at or 0.0) if self._steps is None else None
        self._fabric = Fabric(before.grid, p, settled_at=settled, mean=before.mean)
        self._crushed += engine.report.crushed
        grainsize = self._fabric.grainsize()
        return Outcome(grainsize, self._crushed, mass_error(grainsize), (), engine.report, self._fabric)

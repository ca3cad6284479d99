"""The way of a fabric along a load path: which engine takes a load, and from where."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Fabric,
    FullConvolution,
    LogGrid,
    Material,
    ParameterError,
    PointMass,
    QuasiStatic,
    SlowUpdate,
    SolveReport,
    StepReport,
    remix,
)
from comminute.util.choices import EngineName, Kind, Scheme, require_word

Floats = npt.NDArray[np.float64]


def kind_of(kind: Kind | None, rate: float) -> Kind:
    """Kernel of one load: slow unless a rate or a kind says otherwise."""
    if kind is None:
        return "blend" if rate > 0.0 else "slow"
    require_word("kind", kind, Kind)
    if rate > 0.0 and kind != "blend":
        raise ParameterError(
            f"loading_rate is {rate:g} but kind is '{kind}'; a rate belongs to the blend: leave kind out"
        )
    return kind


def engine_of(name: EngineName, kind: Kind, rate: float, *, steps: int | None) -> EngineName:
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


class Outcome(NamedTuple):
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

    def after(self, load: float, *, with_fabric: bool) -> Outcome:
        """Outcome of one more load: one solve to the largest so far, since the way there does not matter."""
        self.largest = max(self.largest, load)
        if with_fabric:
            fabric = self.solver.solve(self.start, self.largest)
            report = self.solver.report
            self.start, self.crushed_before = fabric, self.crushed_before + report.crushed
            return Outcome(fabric.grainsize(), tuple(fabric.points), self.crushed_before, report, fabric)
        after = self.solver.grading_after(self.start, self.largest)
        crushed = self.crushed_before + after.report.crushed
        return Outcome(after.grainsize, tuple(after.points), crushed, after.report, None)


class Engines:
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
        """Engine that takes time steps."""
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
        """Solver for a loading rate."""
        self._note("quasi-static")
        if rate not in self._solvers:
            self._solvers[rate] = QuasiStatic(self._grid, self._material, self._scheme, rate)
        return self._solvers[rate]


@dataclass
class Records:
    """What a run writes down after each load."""

    outcomes: list[Outcome] = field(default_factory=list)
    kept: list[Fabric | None] = field(default_factory=list)

    def add(self, outcome: Outcome, *, keep: bool) -> None:
        """Note one load."""
        self.outcomes.append(outcome)
        self.kept.append(outcome.fabric if keep else None)


class Walk:
    """Walks a load path: what has been loaded so far, and how the next load is taken from there."""

    def __init__(self, start: Fabric, engines: Engines, steps: int | None) -> None:
        self._fabric = start
        self._engines = engines
        self._steps = steps
        self._crushed = 0.0
        self._segment: _Segment | None = None

    def load(self, name: EngineName, kind: Kind, rate: float, load: float, *, with_fabric: bool) -> Outcome:
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

    def _step(self, name: EngineName, kind: Kind, rate: float, load: float) -> Outcome:
        engine = self._engines.stepper(name, kind, rate)
        before = self._fabric.binned()
        p = engine.settle(before.probability, load, steps=self._steps)
        # After a fixed number of steps some mass may still lie inside the zone: at rest under no known load.
        settled = max(load, before.settled_at or 0.0) if self._steps is None else None
        self._fabric = Fabric(before.grid, p, settled_at=settled, mean=before.mean)
        self._crushed += engine.report.crushed
        return Outcome(self._fabric.grainsize(), (), self._crushed, engine.report, self._fabric)

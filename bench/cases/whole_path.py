"""Three gradings, 50 loads each, to one accuracy: everybody at the coarsest grid, and the fewest steps, that reach it.

The error is the largest distance of the grading curve from that of the quasi-static solver on a much finer grid, over
all loads and all bin edges more than `CUT` above the grid's bottom, exact sizes of the start aside (the curve jumps
there). Peers step in time: at each load slow steps are repeated until less than a tolerance of the mass is active.
Their grid and tolerance are found with `SlowUpdate`, whose steps are the same to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

import comminute as cm
from cases.common import problem_on
from contestants.model import Floats
from contestants.numba_push import NumbaSteps
from contestants.scipy_steps import SciPySteps
from harness import OURS, Check, Contestant, Goal, Trial, largest_difference

PSI_MIN, PSI_MAX, CUT = -9.5, 0.5, 0.5
LADDER = (64, 91, 128, 181, 256, 362, 512, 724, 1024, 1448, 2048)  # N, by factors of √2; fewer would draw no curve
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-7)
SAME_STEPS = 1e-12  # between peers that take the same steps
REFERENCE_CHECK = 0.1  # of the error asked for, between the reference and a grid half as fine


@dataclass(frozen=True)
class _Start:
    grading: cm.Grading
    jumps: tuple[float, ...] = ()  # exact log sizes


STARTS = {
    "power law": _Start(cm.power_law(2.5, 2.5e-3, 1.0)),
    "lognormal": _Start(cm.lognormal(0.3, 0.5, largest=1.0)),
    "gap-graded": _Start(cm.gap_graded(1.0, 0.1), (0.0, math.log(0.1))),
}


def _grid(bins: int) -> cm.LogGrid:
    return cm.LogGrid(PSI_MIN, PSI_MAX, bins)


def _solved(start: _Start, loads: Floats, bins: int) -> Floats:
    """Cumulative curves by comminute, set-up and all."""
    simulation = cm.Simulation(cm.Material(), start.grading, grid=_grid(bins))
    return np.asarray(simulation.run(stress_ratio=loads, keep_fabrics=()).cdf)


class _Judge:
    """Knows the curves on a fine grid."""

    def __init__(self, start: _Start, loads: Floats, bins: int, error: float) -> None:
        self._jumps, self._grid = start.jumps, _grid(bins)
        self._curves = _solved(start, loads, bins)
        self.check = Check(
            "reference, half as fine", self.error(_solved(start, loads, bins // 2)), REFERENCE_CHECK * error
        )

    def error(self, curves: Floats) -> float:
        """Largest distance of curves on any grid."""
        edges = _grid(curves.shape[1]).edges[1:]
        judged = edges > PSI_MIN + CUT
        for jump in self._jumps:
            judged &= np.abs(edges - jump) > self._grid.spacing
        fine = self._grid.edges[1:]
        return max(
            largest_difference(np.interp(edges[judged], fine, known), curve[judged])
            for known, curve in zip(self._curves, curves, strict=True)
        )


def _stepped(p: Floats, loads: Floats, step: Callable[[float], tuple[Floats, float]], tolerance: float) -> Floats:
    """Curves by time stepping: `step` takes one at a load, and gives the state and what was active before it."""
    curves = np.empty((len(loads), len(p)))
    for n, load in enumerate(loads):
        active = 1.0
        while active > tolerance:
            p, active = step(float(load))
        curves[n] = np.cumsum(p.sum(axis=1))
    return curves


class _Stepping:
    """Time stepping of one start on one grid by any of three programs."""

    def __init__(self, start: _Start, loads: Floats, bins: int, tolerance: float) -> None:
        self.bins, self.tolerance = bins, tolerance
        self._grid, self._loads = _grid(bins), loads
        self._problem = problem_on(self._grid)
        self._start = cm.mixed_fabric(start.grading, self._grid, points="binned").probability

    def by_slow_update(self) -> Floats:
        """Our own engine, with which the grid is found."""
        p, engine = self._start.copy(), cm.SlowUpdate(self._grid, cm.Material(), scheme="paper")

        def step(load: float) -> tuple[Floats, float]:
            engine.step(p, load, out=p)
            return p, engine.report.active

        return _stepped(p, self._loads, step, self.tolerance)

    def by_numba(self) -> Floats:
        """Direct push."""
        p, engine = self._start.copy(), NumbaSteps(self._problem, float(self._loads.max()))
        return _stepped(p, self._loads, lambda load: (p, engine.step(p, load)), self.tolerance)

    def by_scipy(self) -> Floats:
        """Separable convolutions."""
        p, engine = self._start.copy(), SciPySteps(self._problem)

        def step(load: float) -> tuple[Floats, float]:
            nonlocal p
            p, active = engine.step_and_active(p, load, "slow")
            return p, active

        return _stepped(p, self._loads, step, self.tolerance)


def _coarsest_solve(start: _Start, loads: Floats, judge: _Judge, error: float) -> int:
    return next(bins for bins in LADDER if judge.error(_solved(start, loads, bins)) <= error)


def _coarsest_stepping(start: _Start, loads: Floats, judge: _Judge, error: float) -> _Stepping:
    """Coarsest grid on which steps to rest suffice, then the loosest tolerance there."""
    for bins in LADDER:
        if judge.error(_Stepping(start, loads, bins, TOLERANCES[-1]).by_slow_update()) <= error:
            break
    for tolerance in TOLERANCES:
        stepping = _Stepping(start, loads, bins, tolerance)
        if judge.error(stepping.by_slow_update()) <= error:
            return stepping
    raise SystemExit(f"no grid of up to {LADDER[-1]} bins brings time stepping to an error of {error:g}")


def trial(names: tuple[str, ...], loads: Floats, reference: int, error: float) -> Trial:
    """All starts as one job."""
    starts = [STARTS[name] for name in names]
    judges = [_Judge(start, loads, reference, error) for start in starts]
    bins = [_coarsest_solve(start, loads, judge, error) for start, judge in zip(starts, judges, strict=True)]
    stepping = [_coarsest_stepping(start, loads, judge, error) for start, judge in zip(starts, judges, strict=True)]
    checks = [judge.check for judge in judges]
    first = _Stepping(starts[0], loads[:2], stepping[0].bins, stepping[0].tolerance)
    checks.append(
        Check("SciPy steps, two loads", largest_difference(first.by_scipy(), first.by_slow_update()), SAME_STEPS)
    )
    for name, start, n, stepper, judge in zip(names, starts, bins, stepping, judges, strict=True):
        checks += [
            Check(f"{name}, {OURS}, N = {n}", judge.error(_solved(start, loads, n)), error),
            Check(
                f"{name}, steps, N = {stepper.bins}, to {stepper.tolerance:g}", judge.error(stepper.by_numba()), error
            ),
        ]
    ours = [partial(_solved, start, loads, n) for start, n in zip(starts, bins, strict=True)]
    contestants = [
        Contestant(OURS, lambda: [solve() for solve in ours]),
        Contestant("Numba push, time stepping", lambda: [stepper.by_numba() for stepper in stepping]),
        Contestant("comminute, slow-update steps", lambda: [stepper.by_slow_update() for stepper in stepping]),
        Contestant("SciPy, time stepping", lambda: [stepper.by_scipy() for stepper in stepping]),
    ]
    return Trial(
        case="whole path",
        title=f"Whole path, {len(starts)} gradings × {len(loads)} loads, equal error {error:g} of the grading curve",
        contestants=contestants,
        checks=checks,
        goals=[Goal("≥ 10⁴ × SciPy time stepping", "SciPy, time stepping", OURS, least=1e4)],
        note="comminute's time includes mixing the start and setting up the solver; the peers are given the start",
    )


def trials(short: bool) -> Iterator[Trial]:
    """One job."""
    if short:
        yield trial(("power law",), np.geomspace(2.0, 100.0, 4), 1601, 2e-2)
    else:
        yield trial(tuple(STARTS), np.geomspace(1.2, 1e4, 50), 6001, 5e-4)

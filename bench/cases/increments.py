"""Slow loading in small increments: 200 loads spaced evenly in log up to 10^4, one slow step at each, in place."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import comminute as cm
from cases.common import LOAD, grid_of, problem_on, start_on
from contestants.copies import Copy
from contestants.model import Floats
from contestants.numba_push import NumbaSteps
from contestants.scipy_steps import SciPySteps
from harness import OURS, Check, Contestant, Goal, Trial, largest_difference

ANSWER = 1e-13
LOADS = np.geomspace(1.0, LOAD, 200)
TIMED = 7  # the last loads of the path, where the zone is widest
CONVOLUTION = "full convolution"


class _Path:
    """The states before the last loads; every contestant is given the same one, at the same load, in its own array."""

    def __init__(self, grid: cm.LogGrid, engine: cm.SlowUpdate) -> None:
        p = start_on(grid).probability.copy()
        for load in LOADS[:-TIMED]:
            engine.step(p, load, out=p)
        self._before: list[Floats] = []
        for load in LOADS[-TIMED:]:
            self._before.append(p.copy())
            engine.step(p, load, out=p)
        self._number = 0

    def turn(self, number: int) -> None:
        """Go to the load of a round."""
        self._number = number % TIMED

    @property
    def state(self) -> Floats:
        """State before this round's load."""
        return self._before[self._number]

    @property
    def load(self) -> float:
        """Load of the round."""
        return float(LOADS[len(LOADS) - TIMED + self._number])


def trial(bins: int) -> Trial:
    """One size."""
    grid, material = grid_of(bins), cm.Material()
    update = cm.SlowUpdate(grid, material, scheme="paper")
    convolution = cm.FullConvolution(grid, material, "slow", scheme="paper", path="transforms")
    problem = problem_on(grid)
    scipy_steps, numba_steps = SciPySteps(problem), NumbaSteps(problem, LOAD)
    path = _Path(grid, update)
    p = np.empty((bins, bins))

    def restore() -> None:
        np.copyto(p, path.state)

    engines: dict[str, Callable[[], object]] = {
        OURS: lambda: update.step(p, path.load, out=p),
        CONVOLUTION: lambda: convolution.step(p, path.load, out=p),
        "Numba push": lambda: numba_steps.step(p, path.load),
        "SciPy": lambda: np.copyto(p, scipy_steps.step(p, path.load, "slow")),
    }
    checks = []
    for number in range(TIMED):
        path.turn(number)
        restore()
        engines[OURS]()
        ours = p.copy()
        for name in list(engines)[1:]:
            restore()
            engines[name]()
            checks.append(Check(f"{name}, load {path.load:.0f}", largest_difference(p, ours), ANSWER))
    copy = Copy(p)
    return Trial(
        case="slow update",
        title=f"Slow update, one of the last of 200 increments to 10⁴, N = {bins}, in place",
        contestants=[Contestant(name, run, restore) for name, run in engines.items()] + [Contestant("copy", copy.run)],
        checks=checks,
        goals=[Goal("≤ 1/20 of the FFTW step", OURS, CONVOLUTION, most=0.05)] if bins == 1000 else [],
        size=bins,
        between_rounds=path.turn,
    )


def trials(short: bool) -> Iterator[Trial]:
    """From small to large."""
    for bins in (125,) if short else (250, 500, 1000, 1024, 2000):
        yield trial(bins)

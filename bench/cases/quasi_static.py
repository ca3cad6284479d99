"""One quasi-static solve from a power-law packing to 10^4: the grading alone, and the whole state."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import cycle

import numpy as np

import comminute as cm
from cases.common import LOAD, grid_of, problem_on, start_on
from contestants.copies import CacheSweep, Copy
from contestants.model import Floats
from contestants.numba_push import shares_by_distance, solve, without_rest
from harness import OURS, Check, Contestant, Goal, Trial, largest_difference

ANSWER = 1e-14
MARGINAL, STATE = f"{OURS}, grading", f"{OURS}, state"
NUMBA_UP_TO = 2000  # the push needs O(N^2 W)


class _NumbaSolve:
    """The state out of place; zone and fragments are given, at no cost to it."""

    def __init__(self, grid: cm.LogGrid, material: cm.Material, state: Floats) -> None:
        self._share = shares_by_distance(cm.active_share(grid, material, LOAD))
        self._landing, self._below = without_rest(problem_on(grid, "conservative").fragments)
        self._state = state
        self.out = np.empty_like(state)
        self._crushing = np.empty(grid.bins)

    def run(self) -> None:
        """Solve."""
        np.copyto(self.out, self._state)
        solve(self.out, self._share, self._landing, self._below, self._crushing)


def trial(bins: int, *, cold: bool) -> Trial:
    """Grading and state at one size, with the caches left alone or swept before every run."""
    grid, material = grid_of(bins), cm.Material()
    start = start_on(grid)
    state, after = start.probability, np.empty((bins, bins))
    solver = cm.QuasiStatic(grid, material)
    by_bins = cm.QuasiStatic(grid, material, path="direct").solve(state, LOAD)
    of_state = solver.solve(start, LOAD).grainsize()
    copy = Copy(state)
    before: Callable[[], object] | None = CacheSweep().run if cold else None
    checks = [
        Check("state, bin by bin", largest_difference(solver.solve(state, LOAD, out=after), by_bins), ANSWER),
        Check("grading, of the state", largest_difference(solver.marginal(start, LOAD), of_state), ANSWER),
    ]
    loads = cycle((0.999 * LOAD, LOAD))  # the solver would keep the zone of the load before
    contestants = [
        Contestant(MARGINAL, lambda: solver.marginal(start, next(loads)), before),
        Contestant(STATE, lambda: solver.solve(state, next(loads), out=after), before),
        Contestant("copy", copy.run, before),
    ]
    if bins <= NUMBA_UP_TO:
        numba = _NumbaSolve(grid, material, state)
        numba.run()
        checks.append(Check("Numba push", largest_difference(numba.out, by_bins), ANSWER))
        contestants.append(Contestant("Numba push, state", numba.run, before))
    named = bins in {1000, 4000}
    caches = "cold caches" if cold else "warm caches"
    return Trial(
        case=f"quasi-static solve, {caches}",
        title=f"Quasi-static solve, N = {bins}, {caches}",
        contestants=contestants,
        checks=checks,
        goals=[
            Goal("grading ≤ 0.5 copies of the state", MARGINAL, "copy", most=0.5),
            Goal("state ≤ 4 copies of the state", STATE, "copy", most=4.0),
        ]
        if named
        else [],
        size=bins,
        note=f"the state has {8e-6 * bins**2:.1f} MB; cold: three last-level caches are written before each run",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Warm and cold, from small to large."""
    for cold in (False, True):
        for bins in (125,) if short else (250, 500, 1000, 1024, 2000, 4000):
            yield trial(bins, cold=cold)

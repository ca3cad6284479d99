"""Many small problems: 10 000 states of 64 bins, each taken to a load of its own, as a host code's material points are.

The library has no call for many states yet, so ours is a Python loop over `QuasiStatic.solve`; its overhead is part of
the figure. Two threads share the list, one solver each.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import comminute as cm
from cases.common import LOAD, grid_of, problem_on, start_on
from contestants.model import Floats
from contestants.numba_push import shares_by_distance, solve_many, without_rest
from harness import OURS, PER_SECOND, Check, Contestant, Goal, Trial, largest_difference

BINS = 64
LOADS = np.geomspace(2.0, LOAD, 32)
ANSWER = 1e-14
THREADED = f"{OURS}, 2 threads"


def _solve_all(solver: cm.QuasiStatic, states: Floats, loads: Floats, out: Floats) -> None:
    solve = solver.solve
    for state, load, after in zip(states, loads.tolist(), out, strict=True):
        solve(state, load, None, after)


def trial(count: int) -> Trial:
    """One batch."""
    grid, material = grid_of(BINS), cm.Material()
    which = np.arange(count) % len(LOADS)
    loads = LOADS[which]
    states = np.repeat(start_on(grid).probability[None], count, axis=0)
    out, pushed = np.empty_like(states), np.empty_like(states)
    solvers = [cm.QuasiStatic(grid, material) for _ in range(2)]
    halves = (slice(0, count // 2), slice(count // 2, count))
    shares = [shares_by_distance(cm.active_share(grid, material, load)) for load in LOADS]
    width = max(share.shape[1] for share in shares)
    table = np.array([np.pad(share, ((0, 0), (0, width - share.shape[1]))) for share in shares])
    landing, below = without_rest(problem_on(grid, "conservative").fragments)
    pool = ThreadPoolExecutor(2)

    def by_two() -> None:
        list(pool.map(lambda k: _solve_all(solvers[k], states[halves[k]], loads[halves[k]], out[halves[k]]), (0, 1)))

    def by_numba() -> None:
        np.copyto(pushed, states)
        solve_many(pushed, table, which, landing, below)

    by_two()
    first = out.copy()
    by_numba()
    _solve_all(solvers[0], states, loads, out)
    return Trial(
        case="many small problems",
        title=f"Many small problems, N = {BINS}, full state, {count} of them",
        contestants=[
            Contestant(OURS, lambda: _solve_all(solvers[0], states, loads, out), work=count),
            Contestant(THREADED, by_two, work=count),
            Contestant("Numba push", by_numba, work=count),
        ],
        checks=[
            Check("2 threads", largest_difference(first, out), 0.0),
            Check("Numba push", largest_difference(pushed, out), ANSWER),
        ],
        goals=[
            Goal("≥ 20 000 solves a second and core", OURS, PER_SECOND, least=20_000.0),
            Goal("≥ 1.8 × with 2 threads", OURS, THREADED, least=1.8),
        ],
        unit="solve",
        note="a Python loop over `solve`; Numba is given the zones of the 32 loads ready made",
    )


def trials(short: bool) -> Iterator[Trial]:
    """One batch."""
    yield trial(200 if short else 10_000)

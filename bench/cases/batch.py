"""Many small problems: 10 000 states of 64 bins, each taken to a load of its own, as a host code's material points are.

Ours is one call of `solve_batch`, on one thread and on two, and beside it what a Python loop over `solve` takes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import comminute as cm
from cases.common import LOAD, grid_of, problem_on, start_on
from contestants.model import Floats
from contestants.numba_push import shares_by_distance, solve_many, without_rest
from harness import OURS, PER_SECOND, Check, Contestant, Goal, Trial, largest_difference

BINS = 64
LOADS = np.geomspace(2.0, LOAD, 32)
ANSWER = 1e-14
THREADED, LOOP = f"{OURS}, 2 threads", f"{OURS}, loop over solve"


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
    solver = cm.QuasiStatic(grid, material)
    shares = [shares_by_distance(cm.active_share(grid, material, load)) for load in LOADS]
    width = max(share.shape[1] for share in shares)
    table = np.array([np.pad(share, ((0, 0), (0, width - share.shape[1]))) for share in shares])
    landing, below = without_rest(problem_on(grid, "conservative").fragments)

    def batch(threads: int) -> None:
        solver.solve_batch(states, loads, out=out, threads=threads)

    def by_numba() -> None:
        np.copyto(pushed, states)
        solve_many(pushed, table, which, landing, below)

    _solve_all(solver, states, loads, out)
    looped = out.copy()
    batch(2)
    threaded = out.copy()
    by_numba()
    batch(1)
    return Trial(
        case="many small problems",
        title=f"Many small problems, N = {BINS}, full state, {count} of them",
        contestants=[
            Contestant(OURS, lambda: batch(1), work=count),
            Contestant(THREADED, lambda: batch(2), work=count),
            Contestant(LOOP, lambda: _solve_all(solver, states, loads, out), work=count),
            Contestant("Numba push", by_numba, work=count),
        ],
        checks=[
            Check("2 threads", largest_difference(threaded, out), 0.0),
            Check("loop over solve", largest_difference(looped, out), 0.0),
            Check("Numba push", largest_difference(pushed, out), ANSWER),
        ],
        goals=[
            Goal("≥ 20 000 solves a second and core", OURS, PER_SECOND, least=20_000.0),
            Goal("≥ 1.5 × ahead of the Numba push", "Numba push", OURS, least=1.5),
            Goal("≥ 1.9 × with 2 threads", OURS, THREADED, least=1.9),
        ],
        unit="solve",
        note="32 loads; Numba is given their zones ready made, ours makes each once a batch, the loop each time",
    )


def trials(short: bool) -> Iterator[Trial]:
    """One batch."""
    yield trial(200 if short else 10_000)

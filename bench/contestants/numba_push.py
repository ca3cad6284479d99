"""Direct push in Numba: every active cell hands its mass down its row or column, one multiplication a fragment bin.

Loops run along an arm of a shell (the cells whose larger index is m), where memory is contiguous and LLVM vectorises.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from contestants.model import Floats, Problem


@njit(cache=True)
def slow_step(
    p: Floats, band: npt.NDArray[np.int64], fragments: Floats, below: Floats, row: Floats, column: Floats
) -> float:
    """One synchronous step of the slow kernel, in place; returns the mass it found active.

    `row` and `column` are (N, W) scratch for what leaves shell m: cell (m, m-d) and cell (m-d, m).
    """
    bins = p.shape[0]
    active = 0.0
    for m in range(1, bins):
        reach = min(band[m], m)
        for d in range(reach + 1):
            half = 0.5 if d == 0 else 1.0
            row[m, d] = half * p[m, m - d]
            column[m, d] = half * p[m - d, m]
            active += row[m, d] + column[m, d]
            p[m, m - d] = 0.0
            p[m - d, m] = 0.0
    for m in range(1, bins):
        reach = min(band[m], m)
        # Arms at rest inside cost one look: a small rise of the load wakes cells at the far end alone.
        first = 0
        while first <= reach and row[m, first] == 0.0:
            first += 1
        if first <= reach:
            near, far = m - first, m - reach
            for i in range(m + 1):
                share = below[m] if i == 0 else fragments[m - i]
                if share != 0.0:
                    for j in range(far, near + 1):
                        p[i, j] += share * row[m, m - j]
        for d in range(reach + 1):
            mass = column[m, d]
            if mass != 0.0:
                i = m - d
                p[i, 0] += mass * below[m]
                for j in range(1, m + 1):
                    p[i, j] += mass * fragments[m - j]
    return active


@njit(cache=True)
def solve(p: Floats, share: Floats, landing: Floats, below: Floats, crushing: Floats) -> None:
    """Quasi-static state in place: shells from coarse to fine, each active cell pushed once.

    `share[m, d]` is the active share of the cells of shell m at distance d, zero beyond the zone; `landing` and `below`
    are the fragments that leave their bin; `crushing` is (N) scratch.
    """
    bins = p.shape[0]
    for m in range(bins - 1, 0, -1):
        half = 0.5 * share[m, 0] * p[m, m]
        p[m, m] -= 2.0 * half
        p[m, 0] += half * below[m]
        p[0, m] += half * below[m]
        for j in range(1, m):
            p[m, j] += half * landing[m - j]
            p[j, m] += half * landing[m - j]
        reach = 0
        while reach < m and reach + 1 < share.shape[1] and share[m, reach + 1] > 0.0:
            reach += 1
        far = m - reach
        for j in range(far, m):
            crushing[j] = share[m, m - j] * p[m, j]
            p[m, j] -= crushing[j]
        for i in range(m):
            part = below[m] if i == 0 else landing[m - i]
            for j in range(far, m):
                p[i, j] += part * crushing[j]
        for i in range(far, m):
            mass = share[m, m - i] * p[i, m]
            p[i, m] -= mass
            p[i, 0] += mass * below[m]
            for j in range(1, m):
                p[i, j] += mass * landing[m - j]


@njit(cache=True)
def solve_many(states: Floats, shares: Floats, which: npt.NDArray[np.int64], landing: Floats, below: Floats) -> None:
    """Many problems, one after the other, in place."""
    crushing = np.empty(states.shape[1])
    for n in range(states.shape[0]):
        solve(states[n], shares[which[n]], landing, below, crushing)


class NumbaSteps:
    """Time stepping by direct push, in place."""

    def __init__(self, problem: Problem, widest_load: float) -> None:
        self._problem = problem
        width = int(problem.band(widest_load).max()) + 1
        self._row = np.zeros((problem.bins, width))
        self._column = np.zeros((problem.bins, width))

    def step(self, p: Floats, stress_ratio: float) -> float:
        """One step of the slow kernel; returns the mass that was active."""
        problem = self._problem
        band = problem.band(stress_ratio)
        return float(slow_step(p, band, problem.fragments, problem.below, self._row, self._column))


def without_rest(fragments: Floats) -> tuple[Floats, Floats]:
    """Fragments of a crush that is repeated until it leaves its bin, and their sums from m on."""
    landing = fragments / (1.0 - fragments[0])
    landing[0] = 0.0
    # Below from the far end loses nothing: what is not landed above bin 0 is in it.
    below = np.concatenate([[1.0], 1.0 - np.cumsum(landing)[:-1]])
    return landing, below


def shares_by_distance(active_share: Floats) -> Floats:
    """(N, W) active share at [m, m - d] from the (N, N) table, cut where every shell's zone has ended."""
    bins = len(active_share)
    share = np.zeros((bins, bins))
    for m in range(bins):
        share[m, : m + 1] = active_share[m, m::-1]
    width = int(np.flatnonzero(share.any(axis=0)).max(initial=0)) + 1
    return np.ascontiguousarray(share[:, :width])

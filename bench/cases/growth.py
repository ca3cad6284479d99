"""How the cost of a grading grows with N: the range is fixed, so the zone's width in bins grows with N too."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

import comminute as cm
from cases.common import LOAD, grid_of, start_on
from contestants.copies import Copy
from harness import OURS, Check, Contestant, Trial, largest_difference

SIZES = (250, 256, 500, 512, 1000, 1024, 2000, 2048, 4000, 4096, 8000, 8192)


def trial(bins: int) -> Trial:
    """One size; checked against the sum bin by bin, which shares no recursion with it."""
    grid, material = grid_of(bins), cm.Material()
    start = start_on(grid)
    solver = cm.QuasiStatic(grid, material)
    by_bins = cm.QuasiStatic(grid, material, path="direct").marginal(start, LOAD)
    copy = Copy(start.probability)
    loads = cycle((0.999 * LOAD, LOAD))  # the solver would keep the zone of the load before
    return Trial(
        case="growth of the grading solve",
        title=f"Grading solve, N = {bins}",
        contestants=[
            Contestant(OURS, lambda: solver.marginal(start, next(loads))),
            Contestant("copy of the state", copy.run),
        ],
        checks=[Check("bin by bin", largest_difference(solver.marginal(start, LOAD), by_bins), 1e-14)],
        size=bins,
        steepest=2.0,
    )


def trials(short: bool) -> Iterator[Trial]:
    """Round sizes and powers of two side by side."""
    for bins in (125, 128) if short else SIZES:
        yield trial(bins)

"""Cost of one quasi-static solve, as ratios to a copy of the state, from one run that first checks the answers.

    python bench/solves.py [BINS...]

Power-law start on psi from -6 to 1, stress ratio 10^4. Each answer is checked against the same solve bin by bin, and
the marginal against the rows of the state; then the contestants take turns.
"""

import statistics
import sys
import time
from collections.abc import Callable

import numpy as np

import comminute as cm

LOAD = 1e4
ROUNDS = 15
ANSWER = 1e-14


def seconds(work: Callable[[], object]) -> float:
    """Wall time of one call."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def measure(bins: int) -> list[float]:
    """Median seconds of a copy, a marginal from a Fabric, and a state out of place."""
    grid, material = cm.LogGrid(-6.0, 1.0, bins), cm.Material()
    start = cm.mixed_fabric(cm.power_law(2.5, 2.5e-3, 1.0), grid)
    state, after = start.probability, np.empty((bins, bins))
    solver = cm.QuasiStatic(grid, material)
    by_bins = cm.QuasiStatic(grid, material, path="direct").solve(state, LOAD)
    error = float(np.abs(solver.solve(state, LOAD, out=after) - by_bins).max())
    error = max(error, float(np.abs(solver.marginal(start, LOAD) - by_bins.sum(axis=1)).max()))
    if error > ANSWER:
        raise SystemExit(f"N = {bins}: answers differ by {error:.1e}, more than {ANSWER:.0e}")
    copy = np.empty_like(after)
    contestants: list[Callable[[], object]] = [
        lambda: np.copyto(copy, state),
        lambda: solver.marginal(start, LOAD),
        lambda: solver.solve(state, LOAD, out=after),
    ]
    rounds = [[seconds(work) for work in contestants] for _ in range(ROUNDS)]
    return [statistics.median(column) for column in zip(*rounds, strict=True)]


def main(sizes: list[int]) -> None:
    """Print the table."""
    print("    N        copy    marginal       state   marginal/copy   state/copy   state ns/cell")
    for bins in sizes:
        copy, marginal, state = measure(bins)
        print(
            f"{bins:5d} {1e3 * copy:8.3f} ms {1e3 * marginal:8.3f} ms {1e3 * state:8.3f} ms {marginal / copy:15.2f} "
            f"{state / copy:12.2f} {1e9 * state / bins**2:15.2f}"
        )


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]] or [250, 500, 1000, 1024, 2000, 4000])

"""Cost of one time step by either engine, as ratios from one run that first checks the answers.

    python bench/steps.py [BINS...]

For each N: 200 loads spaced evenly in log stress ratio up to 10^4 from a power-law start, one slow step at each (the
increment that Section 8.2 of the paper has in mind). The two engines and a copy of the state take turns.
"""

import statistics
import sys
import time

import numpy as np

import comminute as cm

LOADS = np.geomspace(1.0, 1e4, 200)
ROUNDS = 7
ANSWER = 1e-13


def start(bins: int) -> tuple[cm.LogGrid, np.ndarray]:
    """Power-law packing on the paper's range of sizes."""
    grid = cm.LogGrid(-6.0, 1.0, bins)
    return grid, cm.mixed_fabric(cm.power_law(2.5, 2.5e-3, 1.0), grid).probability.copy()


def seconds(work: object, *arguments: object, **options: object) -> float:
    """Wall time of one call."""
    begin = time.perf_counter()
    work(*arguments, **options)  # type: ignore[operator]
    return time.perf_counter() - begin


def measure(bins: int) -> tuple[float, float, float]:
    """Median seconds of a slow update, a full convolution and a copy, over the last loads of the path."""
    grid, p = start(bins)
    material = cm.Material()
    update, convolution = cm.SlowUpdate(grid, material), cm.FullConvolution(grid, material, "slow")
    for load in LOADS[:-ROUNDS]:
        update.step(p, load, out=p)
    q, copy = p.copy(), np.empty_like(p)
    times: list[tuple[float, float, float]] = []
    for load in LOADS[-ROUNDS:]:
        times.append(
            (
                seconds(update.step, p, load, out=p),
                seconds(convolution.step, q, load, out=q),
                seconds(np.copyto, copy, q),
            )
        )
        error = np.abs(p - q).max()
        if error > ANSWER:
            raise SystemExit(f"N = {bins}: the engines differ by {error:.1e}, more than {ANSWER:.0e}")
    medians = [statistics.median(column) for column in zip(*times, strict=True)]
    return medians[0], medians[1], medians[2]


def main(sizes: list[int]) -> None:
    """Print the table."""
    print("    N   slow update   full convolution       copy   convolution/update   update/copy")
    for bins in sizes:
        update, convolution, copy = measure(bins)
        print(
            f"{bins:5d} {1e3 * update:10.3f} ms {1e3 * convolution:15.2f} ms {1e3 * copy:7.3f} ms "
            f"{convolution / update:20.1f} {update / copy:13.2f}"
        )


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]] or [250, 500, 1000, 1024, 2000])

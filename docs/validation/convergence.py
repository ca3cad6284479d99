"""Order of convergence in the bin width, as tables; `python docs/validation/convergence.py` rewrites convergence.md.

The test suite imports this file and asserts what the page says.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

import comminute as cm

Floats = npt.NDArray[np.float64]
Scheme = Literal["conservative", "paper"]
Reading = Literal["linear", "cubic"]

BINS = (65, 129, 257, 513, 1025)
LENGTH = 8.5
LOWEST, TIP_CLEARANCE = -6.0, 0.2
BEGIN, END = "<!-- tables -->", "<!-- end of tables -->"


def normal_pmf(grid: cm.LogGrid, mean: float, sd: float) -> Floats:
    """Bin masses of a normal law in psi; what lies off the grid joins its end bins."""
    finer = np.array([0.5 * math.erfc((mean - edge) / (sd * math.sqrt(2.0))) for edge in grid.edges])
    finer[[0, -1]] = 0.0, 1.0
    return np.diff(finer)


def tip_of(stress_ratio: float) -> float:
    """Log size that crushes among equals, w = 3 and reference size 1."""
    return -math.log(stress_ratio)


def lowest_centre(stress_ratio: float, *, tip_on_centre: bool) -> float:
    """psi_min: -8, or less than half a coarsest bin away from it such that the tip is a centre of every grid."""
    tip, widest = tip_of(stress_ratio), LENGTH / (BINS[0] - 1)
    return tip - round((tip + 8.0) / widest) * widest if tip_on_centre else -8.0


def cdf(bins: int, n: float, stress_ratio: float, scheme: Scheme, psi_min: float, reading: Reading) -> Floats:
    """Mass fraction finer than the centres of the coarsest grid, read between the edges of bins."""
    grid = cm.LogGrid(psi_min, psi_min + LENGTH, bins)
    start = np.outer(normal_pmf(grid, -1.0, 0.4), normal_pmf(grid, -1.2, 0.3))
    after = cm.QuasiStatic(grid, cm.Material(fabric_width=n), scheme).marginal(start, stress_ratio)
    at_edges = np.append(0.0, np.cumsum(after))
    i = np.arange(1, BINS[0] - 1) * ((bins - 1) // (BINS[0] - 1))
    linear = np.asarray(0.5 * (at_edges[i] + at_edges[i + 1]))
    if reading == "linear":
        return linear
    return np.asarray((18.0 * linear - at_edges[i - 1] - at_edges[i + 2]) / 16.0)


def errors(
    n: float,
    stress_ratio: float,
    *,
    reading: Reading = "linear",
    tip_on_centre: bool = False,
    clearance: float = TIP_CLEARANCE,
) -> dict[Scheme, list[float]]:
    """Largest error of the cdf for each number of bins, both schemes against one extrapolated solution."""
    psi_min = lowest_centre(stress_ratio, tip_on_centre=tip_on_centre)
    at = psi_min + LENGTH / (BINS[0] - 1) * np.arange(1, BINS[0] - 1)
    read = (at >= LOWEST) & (np.abs(at - tip_of(stress_ratio)) > clearance)
    fine, finest = (cdf(bins, n, stress_ratio, "conservative", psi_min, "cubic") for bins in (2049, 4097))
    exact = finest + (finest - fine) / 3.0

    def worst(scheme: Scheme, bins: int) -> float:
        return float(np.abs(cdf(bins, n, stress_ratio, scheme, psi_min, reading) - exact)[read].max())

    return {
        "conservative": [worst("conservative", bins) for bins in BINS],
        "paper": [worst("paper", bins) for bins in BINS],
    }


def orders(of_errors: list[float]) -> list[float]:
    """Exponents of h between successive grids."""
    return [math.log2(coarse / fine) for coarse, fine in pairwise(of_errors)]


def table(
    cases: list[tuple[float, float]], reading: Reading, *, tip_on_centre: bool = False, clearance: float = TIP_CLEARANCE
) -> str:
    """Markdown table of errors and orders."""
    lines = ["| load | n | scheme | " + " | ".join(f"N = {bins}" for bins in BINS) + " | orders |"]
    lines.append("|---" * (len(BINS) + 4) + "|")
    for stress_ratio, n in cases:
        of_schemes = errors(n, stress_ratio, reading=reading, tip_on_centre=tip_on_centre, clearance=clearance)
        for scheme, worst in of_schemes.items():
            shown = " | ".join(f"{error:.1e}" for error in worst)
            order = " ".join(f"{value:.2f}" for value in orders(worst)) if max(worst) > 1e-12 else "(rounding)"
            lines.append(f"| {stress_ratio:g} | {n:g} | {scheme} | {shown} | {order} |")
    return "\n".join(lines)


def page() -> str:
    """Return the part of the page that this script writes."""
    every = [(8.0, 0.05), (8.0, 1.0), (8.0, 100.0), (1e4, 0.05), (1e4, 1.0), (1e4, 100.0)]
    wide = [(8.0, 1.0), (8.0, 100.0)]
    return "\n\n".join(
        [
            f"comminute {cm.__version__}.",
            "## Linear reading",
            table(every, "linear"),
            "## Cubic reading",
            table(every, "cubic"),
            "## Tip on a bin centre of every grid",
            "Linear reading:",
            table(wide, "linear", tip_on_centre=True),
            "Cubic reading:",
            table(wide, "cubic", tip_on_centre=True),
            "## At the tip",
            "Linear reading, sizes next to the tip included, the tip on a bin centre:",
            table(wide, "linear", tip_on_centre=True, clearance=-1.0),
        ]
    )


def main() -> None:
    """Rewrite the tables of convergence.md."""
    path = Path(__file__).with_suffix(".md")
    before, rest = path.read_text(encoding="utf-8").split(BEGIN)
    after = rest.split(END)[1]
    path.write_text(f"{before}{BEGIN}\n\n{page()}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()

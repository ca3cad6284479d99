"""Order of convergence in the bin width, as tables; `python docs/validation/convergence.py` rewrites convergence.md.

The test suite imports this file and asserts what the page says.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise, product
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

import comminute as cm

Floats = npt.NDArray[np.float64]
Scheme = Literal["conservative", "paper"]
Reading = Literal["fixed sizes", "fixed sizes, by cubics", "edges"]

SCHEMES: tuple[Scheme, ...] = ("conservative", "paper")
BINS = (65, 129, 257, 513, 1025)
PSI_MIN, PSI_MAX = -8.0, 0.5
PLACEMENTS = 16
SIZES = np.arange(-60, 4) / 10.0  # in psi
CLEARANCE = 0.1  # of sizes read from kinks of the curve: one and a half bins at 129
REFERENCE_BINS = 8193
BEGIN, END = "<!-- tables -->", "<!-- end of tables -->"


def cubic(values: Floats, place: Floats, first: npt.NDArray[np.int64]) -> Floats:
    """Value at a place, in steps, of the cubic through four values from the first on."""
    t = place - first
    weights = [
        -(t - 1) * (t - 2) * (t - 3) / 6,
        t * (t - 2) * (t - 3) / 2,
        -t * (t - 1) * (t - 3) / 2,
        t * (t - 1) * (t - 2) / 6,
    ]
    return np.asarray(sum(weight * values[first + i] for i, weight in enumerate(weights)))


class Curve(NamedTuple):
    """Mass fraction finer at the edges of bins."""

    edges: Floats
    finer: Floats

    def between(self, psi: Floats, at: Reading) -> Floats:
        """Read as the library reads, linearly in psi between edges; or by cubics, which add no error to speak of."""
        if at != "fixed sizes, by cubics":
            return np.interp(psi, self.edges, self.finer)
        place = (psi - self.edges[0]) / (self.edges[1] - self.edges[0])
        return cubic(self.finer, place, np.floor(place).astype(np.int64) - 1)


def normal_pmf(grid: cm.LogGrid, mean: float, sd: float) -> Floats:
    """Bin masses of a normal law in psi; what lies off the grid joins its end bins."""
    finer = np.array([0.5 * math.erfc((mean - edge) / (sd * math.sqrt(2.0))) for edge in grid.edges])
    finer[[0, -1]] = 0.0, 1.0
    return np.diff(finer)


def solve(bins: int, n: float, stress_ratio: float, scheme: Scheme, psi_max: float = PSI_MAX) -> Curve:
    """Grading of the lognormal start under one load, w = 3 and reference size 1."""
    grid = cm.LogGrid(PSI_MIN, psi_max, bins)
    start = np.outer(normal_pmf(grid, -1.0, 0.4), normal_pmf(grid, -1.2, 0.3))
    after = cm.QuasiStatic(grid, cm.Material(fabric_width=n), scheme).marginal(start, stress_ratio)
    return Curve(grid.edges, np.append(0.0, np.cumsum(after)))


def tip(stress_ratio: float) -> float:
    """Log size that crushes among equals, the tip of the zone; w = 3, reference size 1."""
    return -math.log(stress_ratio)


def kinks(n: float, stress_ratio: float) -> list[float]:
    """Kinks of the curve among the sizes read: the tip, and the size whose band reaches the fines bin."""
    psi = np.linspace(SIZES[0] - 1.0, PSI_MAX, 200_001)
    excess = psi - tip(stress_ratio)
    reaches = (excess > 0.0) & (psi - n * np.sqrt(2.0 * np.maximum(excess, 0.0)) < PSI_MIN)
    crossings = psi[1:][np.diff(reaches.astype(int)) != 0]
    return [float(kink) for kink in (tip(stress_ratio), *crossings) if kink > psi[0]]


def placements(bins: int, n: float, stress_ratio: float) -> list[float]:
    """psi_max of grids that carry the first kink through all places of a bin; psi_min, the fines' size, stays."""
    length, cells = PSI_MAX - PSI_MIN, bins - 1
    above = (anchor(n, stress_ratio) - PSI_MIN) / length * cells
    return [PSI_MIN + length * above / (above - moved / PLACEMENTS) for moved in range(PLACEMENTS)]


def anchor(n: float, stress_ratio: float) -> float:
    """Size whose place in its bin is varied; any will do where there is no kink."""
    return (kinks(n, stress_ratio) or [-4.0])[0]


def exact(n: float, stress_ratio: float) -> Callable[[Floats], Floats]:
    """Curve of a fine grid with the first kink on an edge, read by cubics that do not reach across it."""
    kink, cells = anchor(n, stress_ratio), REFERENCE_BINS - 1
    edge = round((kink - PSI_MIN) / (PSI_MAX - PSI_MIN) * cells + 0.5)
    spacing = (kink - PSI_MIN) / (edge - 0.5)
    finer = solve(REFERENCE_BINS, n, stress_ratio, "conservative", PSI_MIN + spacing * cells).finer

    def read(psi: Floats) -> Floats:
        place = (psi - PSI_MIN) / spacing + 0.5
        first = np.floor(place).astype(np.int64) - 1
        return cubic(finer, place, np.where(psi < kink, np.minimum(first, edge - 3), np.maximum(first, edge)))

    return read


def errors(
    n: float, stress_ratio: float, scheme: Scheme, *, at: Reading = "fixed sizes", one_grid: bool = False
) -> list[float]:
    """Largest error over all placements of the grid, for each number of bins.

    At fixed sizes both kinks are avoided, for they lie inside a bin; at edges that of the fines bin only.
    """
    avoid = [kink for kink in kinks(n, stress_ratio) if at != "edges" or kink != tip(stress_ratio)]
    expected = exact(n, stress_ratio)

    def error(curve: Curve) -> float:
        psi = curve.edges if at == "edges" else SIZES
        among = (psi >= SIZES[0]) & (psi <= SIZES[-1])
        read = psi[among & np.all([np.abs(psi - place) >= CLEARANCE - 1e-9 for place in avoid], axis=0)]
        return float(np.abs(curve.between(read, at) - expected(read)).max())

    def worst(bins: int) -> float:
        ends = [PSI_MAX] if one_grid else placements(bins, n, stress_ratio)
        return max(error(solve(bins, n, stress_ratio, scheme, end)) for end in ends)

    return [worst(bins) for bins in BINS]


def orders(of_errors: list[float]) -> list[float]:
    """Exponents of h between successive grids."""
    return [math.log2(coarse / fine) for coarse, fine in pairwise(of_errors)]


def table(at: Reading, *, one_grid: bool = False) -> str:
    """Markdown table of errors and orders of both schemes."""
    lines = ["| load | n | scheme | " + " | ".join(f"N = {bins}" for bins in BINS) + " | orders |"]
    lines.append("|---" * (len(BINS) + 4) + "|")
    for stress_ratio, n in product((8.0, 1e4), (0.05, 1.0, 100.0)):
        for scheme in SCHEMES:
            found = errors(n, stress_ratio, scheme, at=at, one_grid=one_grid)
            shown = " | ".join(f"{error:.1e}" for error in found)
            order = " ".join(f"{value:.2f}" for value in orders(found)) if max(found) > 1e-12 else "(rounding)"
            lines.append(f"| {stress_ratio:g} | {n:g} | {scheme} | {shown} | {order} |")
    return "\n".join(lines)


def page() -> str:
    """Return the part of the page that this script writes."""
    return "\n\n".join(
        [
            f"comminute {cm.__version__}.",
            "## At fixed sizes, worst of 16 grids",
            table("fixed sizes"),
            "## At the edges of bins, worst of 16 grids",
            table("edges"),
            "## At fixed sizes, one grid",
            table("fixed sizes", one_grid=True),
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

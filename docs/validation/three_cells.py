"""Distance of the law of three cells to the lattice: starts, fabric widths, moduli, fragment laws and means.

Writes three_cells.md beside it, or three_cells_scattered.md with the word "scattered", where each grain has a strength
of its own; some minutes each. The distance is that of Kolmogorov and Smirnov at the ends of all nodes
and on both sides of exact sizes, with the lattice's sizes as they are.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import comminute as cm

REPORTS = {
    False: ("three_cells.md", "The law of three cells against the lattice"),
    True: ("three_cells_scattered.md", "The law of three cells against the lattice: scattered strengths"),
}
LOADS = [1.5, 2.0, 4.0, 8.0, 32.0, 100.0, 1e3, 1e4]
CELLS, RINGS, SEED = 100_000, 40, 7
STARTS = {
    "equal sizes": cm.monodisperse(1.0),
    "band 0.5 to 1": cm.uniform_size(0.5, 1.0),
    "gap-graded": cm.gap_graded(1.0, 0.1),
    "well graded": cm.power_law(2.5, 1e-2, 1.0),
}
LAWS: dict[str, cm.WeibullFragments | cm.PowerLawFragments | cm.LogNormalFragments] = {
    "Weibull 1, 1": cm.WeibullFragments(),
    "uniform X": cm.PowerLawFragments(1.0),
    "Weibull 0.5, 2": cm.WeibullFragments(0.5, 2.0),
    "lognormal": cm.LogNormalFragments(-1.0, 0.5),
}


def distance(law: cm.Resolved, lattice: cm.Lattice) -> float:
    """Largest difference of the two curves."""
    sizes, grid = np.sort(lattice.psi, axis=None), law.grid
    rounding = np.where(np.append(grid.exact[1:], False), -1e-12, 1e-12)
    finer = np.searchsorted(sizes, grid.upper + rounding) / sizes.size
    shown = grid.upper > grid.upper[0] + 0.1
    return float(np.abs(finer - law.cdf())[shown].max())


def row(material: cm.Material, start: cm.Grading, mean: str, rings: int) -> list[float]:
    """Distances after each load, and after mixing to 32 and again to 4."""
    law = cm.Resolved(material, start, mean=mean)  # type: ignore[arg-type]
    lattice = cm.Lattice(CELLS, material, start, replicas=rings, seed=SEED, threads=2, mean=mean)  # type: ignore[arg-type]
    found = []
    for load in LOADS:
        law.load_to(load)
        lattice.load_to(load)
        found.append(distance(law, lattice))
    for load in (32.0, 4.0):
        law.remix()
        lattice.remix()
        law.load_to(load)
        lattice.load_to(load)
    return [*found, distance(law, lattice)]


def materials(scattered: bool) -> Iterator[tuple[str, cm.Material, str]]:
    """Name, material and mean of each table's rows."""

    def with_width(width: float, **fields: Any) -> cm.Material:
        return cm.Material(fabric_width=width, strength_scatter=scattered, **fields)

    for width in (0.02, 0.05, 0.1, 0.2, 0.4):
        yield f"n = {width:g}", with_width(width), "arithmetic"
    for width in (0.05, 0.2):
        yield f"n = {width:g}, w = 6", with_width(width, weibull_modulus=6.0), "arithmetic"
        for name, law in list(LAWS.items())[1:]:
            yield f"n = {width:g}, {name}", with_width(width, fragments=law), "arithmetic"
        yield f"n = {width:g}, geometric mean", with_width(width), "geometric"


def main(rings: int, scattered: bool) -> None:
    """Compute and write the report."""
    file, title = REPORTS[scattered]
    lines = [
        f"# {title}",
        "",
        f"comminute {cm.__version__}; written by `docs/validation/three_cells.py`. Distance of Kolmogorov and Smirnov",
        "times 1e4.",
        f"Lattice: {rings} rings of {CELLS:,} cells, seed {SEED}, whose own noise is about "
        f"{1e4 * 0.8 / np.sqrt(CELLS * rings):.0f}. Nodes and steps by default.",
        "",
        "| material | start | " + " | ".join(f"{load:g}" for load in LOADS) + " | mixed twice |",
        "|---|---|" + "---:|" * (len(LOADS) + 1),
    ]
    for name, material, mean in materials(scattered):
        for start, grading in STARTS.items():
            numbers = row(material, grading, mean, rings)
            lines.append(f"| {name} | {start} | " + " | ".join(f"{1e4 * number:.0f}" for number in numbers) + " |")
            print(lines[-1], flush=True)
    lines += ["", "The columns are stress ratios; the last is 32 and then 4 after a mixing each."]
    Path(__file__).with_name(file).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:] if word.isdigit()]
    main(numbers[0] if numbers else RINGS, "scattered" in sys.argv[1:])

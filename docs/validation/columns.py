"""Distance of columns of the law of three cells to columns of the lattice, with the same exchanges.

Writes columns.md beside it; some ten minutes. The distance is that of Kolmogorov and Smirnov at the ends of all nodes
and on both sides of exact sizes, with the lattice's sizes as they are.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import comminute as cm

ROWS, SEED = 8, 1
LOADS = np.geomspace(32.0, 1.5, ROWS)
STARTS = {
    "equal sizes": cm.monodisperse(1.0),
    "two sizes": cm.gap_graded(1.0, float(np.exp(-2.25))),
    "band 0.9 to 1": cm.uniform_size(0.9, 1.0),
}


@dataclass(frozen=True)
class Case:
    """Rows a metre apart, a second an exchange: the probability of mixing, and k_s."""

    name: str
    start: str
    width: float
    mixing: float
    segregation: float
    times: tuple[float, ...]
    ramp: float = 0.0  # seconds in which the loads are raised from 1
    spacing: float | None = None  # of the bins, with all else as fine

    def grid(self) -> cm.ResolvedGrid | None:
        """Finer nodes, where the case has them."""
        if self.spacing is None:
            return None
        return cm.ResolvedGrid.fitting(STARTS[self.start], self.width, spacing=self.spacing, grade=0.4, support_bins=16)


MIX, SEG, RAMP = (5.0, 19.0, 76.0), (12.0, 50.0, 200.0), (10.0, 25.0, 50.0, 100.0)
CASES = [
    *(Case("mixing", start, 0.05, 0.05, 0.0, MIX) for start in STARTS),
    Case("mixing, h = 0.1", "two sizes", 0.05, 0.05, 0.0, MIX, spacing=0.1),
    Case("mixing", "equal sizes", 0.2, 0.05, 0.0, MIX),
    *(Case("segregation", start, 0.05, 0.02, 0.01, SEG) for start in STARTS),
    Case("segregation, h = 0.1", "two sizes", 0.05, 0.02, 0.01, SEG, spacing=0.1),
    Case("segregation", "equal sizes", 0.2, 0.02, 0.01, SEG),
    *(Case("ramp, mixing", start, 0.05, 0.05, 0.0, RAMP, ramp=50.0) for start in STARTS),
    *(Case("ramp, segregation", start, 0.05, 0.02, 0.02, RAMP, ramp=50.0) for start in STARTS),
]


def line(case: Case, cells: int) -> str:
    """One line of the table."""
    material, start = cm.Material(fabric_width=case.width), STARTS[case.start]
    mixing = case.mixing / (1.0 - case.mixing)
    limits: dict[str, Any] = {"largest_mixing": mixing * (1.0 + 1e-9), "largest_segregation": 1.0}
    rows: dict[str, Any] = {"height": float(ROWS), "cells": ROWS, "threads": 2} | limits
    loads: Any = (lambda _, now: LOADS ** min(now / case.ramp, 1.0)) if case.ramp else LOADS
    drive: dict[str, Any] = {"stress_ratio": loads, "mixing": mixing, "segregation": case.segregation}
    times, step = [0.0, *case.times], 1.0 if case.ramp else None
    column = cm.Column(material, start, neighbour_length=1.0, grid=case.grid(), **rows)
    law = column.run(times, step=step, fabrics="none", **drive)
    lattice = cm.ColumnLattice(material, start, cells_per_row=cells, seed=SEED, **rows).run(times, step=step, **drive)
    assert np.array_equal(law.exchanges, lattice.exchanges)
    grid = law.grid
    shown = grid.upper > grid.upper[0] + 0.1
    below_exact = np.append(grid.exact[1:], False)
    finer = lattice.cdf_at(np.exp(grid.upper + np.where(below_exact, -1e-11, 1e-12)))
    distance = np.abs(np.cumsum(law.mass, axis=2) - finer)[1:, :, shown].max(axis=2)
    size = np.abs(law.mean_size / lattice.mean_size - 1.0)[1:].max(axis=1)
    crushes = law.crushes[1:].mean(axis=1) / lattice.crushes[1:].mean(axis=1) - 1.0
    shown_distance = " ".join(f"{1e4 * mean:.0f}" for mean in distance.mean(axis=1))
    return (
        f"| {case.name} | {case.start} | {case.width:g} | {shown_distance} ({1e4 * distance.max():.0f}) "
        f"| {' '.join(f'{100 * error:.1f}' for error in size)} "
        f"| {' '.join(f'{100 * error:+.1f}' for error in crushes)} |"
    )


def main(cells: int = 400_000) -> None:
    """Write the report."""
    head = f"""# Columns of the law of three cells against columns of the lattice

comminute {cm.__version__}; written by `docs/validation/columns.py`. Distance of Kolmogorov and Smirnov times 1e4,
mean of {ROWS} rows at each time (largest row at any time); largest error of the mean size of a row in per cent; error
of the mean number of crushes of all rows in per cent. Lattice: {cells:,} cells a row, permuted partners, random order,
seed {SEED}; its own noise is about {1e4 * 0.83 / cells**0.5:.0f}. Loads 32 at the bottom to 1.5 at the top, both by
the same exchanges: mixing with the probability 0.05 at 5, 19 and 76 s; segregation with 0.02 and k_s = 0.01 at 12, 50
and 200 s; ramps of 50 s at 10, 25, 50 and 100 s. Nodes by default but for h = 0.1.

| case | start | n | distance | mean size | crushes |
|---|---|---:|---|---|---|
"""
    lines = []
    for case in CASES:
        lines.append(line(case, cells))
        print(lines[-1], flush=True)
    Path(__file__).with_suffix(".md").write_text(head + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))

"""Long statistical runs of the lattice against closed-form answers; writes a page of docs/validation.

python tests/long/lattice_statistics.py
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

import comminute as cm

REPORT = Path(__file__).parents[2] / "docs" / "validation" / "lattice-statistics.md"
CELLS = 1_000_000
SEEDS = 10
JAMMING = (1.0 - math.exp(-2.0)) / 2.0  # random sequential adsorption with nearest-neighbour exclusion


def jammed() -> tuple[float, float]:
    """Crushed fraction of equal sizes at their closed threshold, and its standard error over replicas."""
    lattice = cm.Lattice(CELLS, cm.Material(), cm.monodisperse(1.0), replicas=SEEDS, seed=1)
    lattice.load_to(1.0)
    crushed = lattice.crushes.mean(axis=1)
    return float(crushed.mean()), float(crushed.std(ddof=1) / math.sqrt(SEEDS))


def fabric_off(load: float) -> tuple[float, float, float]:
    """Without fabric, uniform fragments: KS distance of s/s_c to U(0, 1), mean and variance of the crush counts."""
    material = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(1.0))
    lattice = cm.Lattice(CELLS, material, cm.monodisperse(1.0), seed=2)
    lattice.load_to(load)
    sizes = np.sort(np.exp(lattice.psi[0]) * load)  # w = 3: s_c = 1 / load
    place = np.arange(CELLS + 1) / CELLS
    distance = max(float(np.abs(sizes - place[1:]).max()), float(np.abs(sizes - place[:-1]).max()))
    counts = lattice.crushes[0]
    return distance, float(counts.mean()), float(counts.var())


def main() -> int:
    """Run, judge and write the page."""
    found, error = jammed()
    deviation = (found - JAMMING) / error
    lines = [
        "# The lattice against closed-form answers",
        "",
        f"comminute {cm.__version__}; written by `tests/long/lattice_statistics.py`, which `make check-long` runs.",
        "",
        f"Equal sizes at a stress ratio of 1, {SEEDS} rings of {CELLS} cells: crushed fraction {found:.6f}, standard",
        f"error {error:.1e}; exact (1 - e^-2) / 2 = {JAMMING:.6f}, {deviation:+.2f} standard errors away (allowed: 3).",
        "",
        f"Fabric off, uniform fragments, a ring of {CELLS} cells. Exact: s / s_c uniform, crush counts 1 + Poisson(ln",
        "load). KS distance allowed: 1.95 / sqrt(cells), the 0.1 % level; mean of the counts: 3.3 standard errors.",
        "",
        "| load | KS distance | allowed | mean count | exact | variance | exact |",
        "|---|---|---|---|---|---|---|",
    ]
    failures = int(abs(deviation) > 3.0)
    limit = 1.95 / math.sqrt(CELLS)
    for load in (2.0, 32.0, 1e4):
        distance, mean, variance = fabric_off(load)
        rate = math.log(load)
        lines.append(
            f"| {load:g} | {distance:.2e} | {limit:.2e} | {mean:.5f} | {1.0 + rate:.5f} | {variance:.5f} | {rate:.5f} |"
        )
        failures += int(distance > limit or abs(mean - 1.0 - rate) > 3.3 * math.sqrt(rate / CELLS))
    lines += ["", f"Failures: {failures}."]
    page = "\n".join(lines) + "\n"
    print(page)
    REPORT.write_text(page, encoding="utf-8")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

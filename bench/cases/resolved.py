"""The law of three cells: equal grains through eight loads, beside a lattice that is as near.

A lattice of M cells is off by about 0.8 / sqrt(M). With as many cells as make that the distance of the law of three
cells to a large lattice, both are equally near the truth, and one of them is smooth.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import comminute as cm
from contestants.model import Floats
from harness import OURS, Check, Contestant, Goal, Trial

LOADS = [1.5, 2.0, 4.0, 8.0, 32.0, 100.0, 1e3, 1e4]
NEAR = 0.0014  # largest distance to a lattice of 4 million cells, docs/validation/three_cells.md
CELLS = int((0.8 / NEAR) ** 2)
WITNESS = 1_000_000
LATTICE, PAPER = "lattice, equally near", f"{OURS}, the paper's closure"


def _law(spacing: float, threads: int = 1) -> cm.Resolved:
    material, start = cm.Material(), cm.monodisperse(1.0)
    grid = cm.ResolvedGrid.fitting(start, material.fabric_width, spacing=spacing)
    law = cm.Resolved(material, start, grid, threads=threads)
    for load in LOADS:
        law.load_to(load)
    return law


def _lattice(cells: int, seed: int) -> cm.Lattice:
    rings = cm.Lattice(cells, cm.Material(), cm.monodisperse(1.0), seed=seed)
    for load in LOADS:
        rings.load_to(load)
    return rings


def _distance(law: cm.Resolved, rings: cm.Lattice) -> float:
    sizes, grid = np.sort(rings.psi, axis=None), law.grid
    rounding: Floats = np.where(np.append(grid.exact[1:], False), -1e-12, 1e-12)
    finer = np.searchsorted(sizes, grid.upper + rounding) / sizes.size
    return float(np.abs(finer - law.cdf())[1:].max())


def _paper() -> cm.Result:
    return cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=LOADS, keep_fabrics=[])


def trial(spacing: float) -> Trial:
    """One path of loads."""
    law, threaded = _law(spacing), _law(spacing, threads=2)
    noise = 2.0 / np.sqrt(WITNESS)  # exceeded less than once in a thousand
    two = f"{OURS}, 2 threads"
    return Trial(
        case="three cells",
        title=f"Law of three cells, {law.grid.nodes} nodes, eight loads",
        contestants=[
            Contestant(OURS, lambda: _law(spacing)),
            Contestant(two, lambda: _law(spacing, threads=2)),
            Contestant(LATTICE, lambda: _lattice(CELLS, 1)),
            Contestant(PAPER, _paper),
        ],
        checks=[
            Check("distance to a lattice of a million cells", _distance(law, _lattice(WITNESS, 2)), NEAR + noise),
            Check("2 threads", float(np.abs(threaded.pmf() - law.pmf()).max()), 0.0),
        ],
        goals=[Goal("≥ 1.4 × with 2 threads", OURS, two, least=1.4)],
        note=f"equal grains, n = 0.05, loads from 1.5 to 10 000; the lattice has {CELLS} cells, an error of {NEAR:g}",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Default nodes, and twice as many."""
    yield trial(0.2)
    if not short:
        yield trial(0.1)

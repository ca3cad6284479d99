"""Columns: eight rows of equal grains that mix and crush, beside a lattice that is as near.

A lattice of M cells a row is off by about 0.8 / sqrt(M). With as many cells as make that the distance of the law of
three cells to a large lattice, both are equally near the truth, and one of them is smooth.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import comminute as cm
from harness import OURS, Check, Contestant, Goal, Trial

ROWS, SECONDS = 8, 20.0
LOADS = np.geomspace(32.0, 1.5, ROWS)
Q = 0.02  # probability of a swap in an exchange, one a second
NEAR = 0.0025  # largest distance of a row to a lattice of 400 000 cells, docs/validation/columns.md
CELLS = int((0.8 / NEAR) ** 2)
WITNESS = 200_000
LATTICE = "lattice, equally near"
DRIVE = Q / (1.0 - Q)


class Rows:
    """A column at rest, made anew before each run."""

    def __init__(self, nodes: int | None = None, *, threads: int = 1, cells: int = 0, seed: int = 1) -> None:
        self.nodes, self.threads, self.cells, self.seed = nodes, threads, cells, seed
        self.column: cm.Column | cm.ColumnLattice | None = None

    def make(self) -> None:
        """Bring the rows to rest under their loads, which is not timed."""
        material, start = cm.Material(), cm.monodisperse(1.0)
        if self.cells:
            lattice = cm.ColumnLattice(
                material, start, height=float(ROWS), cells=ROWS, cells_per_row=self.cells, seed=self.seed
            )
            lattice.run([0.0], stress_ratio=LOADS)
            self.column = lattice
            return
        column = cm.Column(
            material,
            start,
            height=float(ROWS),
            cells=ROWS,
            neighbour_length=1.0,
            grid=None if self.nodes is None else even_nodes(self.nodes),
            largest_mixing=DRIVE * (1.0 + 1e-9),
            threads=self.threads,
        )
        column.run([0.0], stress_ratio=LOADS, fabrics="none")
        column.run([0.0, 1e-9], stress_ratio=LOADS, mixing=1e-9, fabrics="none")  # the rows are open from here on
        self.column = column

    def run(self) -> cm.ColumnResult | cm.ColumnLatticeResult:
        """Exchange for the time."""
        times = np.arange(SECONDS + 1.0)[[0, -1]]
        if isinstance(self.column, cm.Column):
            return self.column.run(times, stress_ratio=LOADS, mixing=DRIVE, fabrics="none")
        assert self.column is not None
        return self.column.run(times, stress_ratio=LOADS, mixing=DRIVE, step=1.0)


def even_nodes(nodes: int) -> cm.ResolvedGrid:
    """Make a fines bin, bins of one width below 1, and the size 1."""
    edges = np.linspace(-8.0, 0.0, nodes - 1)
    lower = np.concatenate([[-10.0], edges])
    return cm.ResolvedGrid(lower, np.append(edges, 0.0))


def trial() -> Trial:
    """Hold the default nodes against a lattice."""
    one, two = Rows(), Rows(threads=2)
    lattice, witness = Rows(cells=CELLS), Rows(cells=WITNESS, seed=2)
    for rows in (one, two, witness):
        rows.make()
    law, threaded, seen = one.run(), two.run(), witness.run()
    assert isinstance(law, cm.ColumnResult)
    assert isinstance(threaded, cm.ColumnResult)
    upper = law.grid.upper
    rounding = np.where(np.append(law.grid.exact[1:], False), -1e-11, 1e-12)
    distance = np.abs(np.cumsum(law.mass[1], axis=1) - seen.cdf_at(np.exp(upper + rounding))[1])[:, 1:].max()
    steps = ROWS * SECONDS
    both = f"{OURS}, 2 threads"
    return Trial(
        case="columns",
        title=f"Column of {ROWS} rows, {law.grid.nodes} nodes, {SECONDS:g} exchanges",
        contestants=[
            Contestant(OURS, one.run, before=one.make, work=steps),
            Contestant(both, two.run, before=two.make, work=steps),
            Contestant(LATTICE, lattice.run, before=lattice.make, work=steps),
        ],
        checks=[
            Check(f"distance to a lattice of {WITNESS} cells a row", float(distance), NEAR + 2.0 / WITNESS**0.5),
            Check("2 threads", float(np.abs(threaded.mass - law.mass).max()), 0.0),
        ],
        goals=[
            Goal("≥ 1.6 × with 2 threads", OURS, both, least=1.6),
            Goal("no slower than a lattice equally near", LATTICE, OURS, least=1.0),
        ],
        unit="row and exchange",
        note=f"equal grains, n = 0.05, loads 32 to 1.5, q = {Q}; the lattice has {CELLS} cells a row",
    )


def by_nodes() -> Trial:
    """Hold a power of two against its neighbour: rows of a table must not fall into one set of the cache."""
    fewer, more = Rows(62), Rows(64)
    results = []
    for rows in (fewer, more):
        rows.make()
        results.append(rows.run())
    names = [f"{OURS}, 62 nodes", f"{OURS}, 64 nodes"]
    difference = float(np.abs(results[0].mean_size - results[1].mean_size).max())
    return Trial(
        case="columns",
        title="Column of 62 and of 64 nodes",
        contestants=[
            Contestant(name, rows.run, before=rows.make, work=ROWS * SECONDS)
            for name, rows in zip(names, (fewer, more), strict=True)
        ],
        checks=[Check("mean sizes", difference, 2e-3)],
        goals=[Goal("64 nodes ≤ 1.2 × the time of 62", names[1], names[0], most=1.2)],
        unit="row and exchange",
        note="by the fourth power of the nodes 1.14",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Default nodes; and at full length 62 and 64."""
    yield trial()
    if not short:
        yield by_nodes()

r"""
Figure 5: where fragments go
============================

In one step the mass of an active cell, marked with a cross, leaves it and spreads over smaller sizes: along one line
where one of the two sizes crushes, over a rectangle where both do at once (the exact kernel). Fragments are put on the
grid as in the paper, where every crush moves at least one bin. Under slow loading (right) no step crushes both: on the
diagonal half of the mass goes either way. The grain crushes inside the blue curve, its neighbourhood inside the dashed
one. Colours are relative to the cell that receives most.
"""

from typing import Literal

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_fragment_kernel

material = cm.Material(fabric_width=1.2)
grid = cm.LogGrid(-9.0, 1.0, 101)
load = 8.0
cells: list[tuple[float, float, Literal["exact", "slow"]]] = [
    (0.0, -1.9, "exact"),
    (-1.9, 0.0, "exact"),
    (0.3, -0.3, "exact"),
    (0.0, 0.0, "slow"),
]


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide, in one column as two rows of two."""
    plt.rcParams.update(PRINT_STYLE)
    narrow = width < 120.0
    rows, columns, height = (2, 2, 100.0) if narrow else (1, 4, 66.0)
    figure, axes = plt.subplots(
        rows, columns, figsize=figure_size(width, height), layout="constrained", sharex=True, sharey=True
    )
    for ax, (psi, psibar, kind) in zip(axes.flat, cells, strict=True):
        cell = grid.bin_of(psi), grid.bin_of(psibar)
        plot_fragment_kernel(grid, material, load, *cell, ax, kind=kind, limits=(-5.0, 1.0), scheme="paper")
        ax.set_title(f"{ax.get_title()}, {kind}")
        ax.label_outer()
    mesh = axes.flat[0].collections[0]
    figure.colorbar(mesh, ax=list(axes.flat), location="bottom", aspect=40, shrink=0.6, label="mass per cell / largest")
    return figure


draw(170.0)
plt.show()

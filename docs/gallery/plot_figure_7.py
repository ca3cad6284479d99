r"""
Figure 7: equal grains
======================

All grains have one size at the start. The lattice (above), the continuum model (in the middle) and the law of three
cells (below) go through the same loads; in all of them the mass leaves the band around the diagonal, where neighbours
are too much alike. The curves of lattice and continuum agree to 0.06 to 0.07: already at the first load the two-cell
model crushes half of the cells, the lattice 0.432 of them, since there a crushed grain shields two neighbours. The law
of three cells knows both neighbours, and its curves are the lattice's to 0.001.
"""

import math

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_comparison

material = cm.Material(weibull_modulus=3.0, fabric_width=0.05, reference_size=1.0)
grading = cm.monodisperse(1.0)
loads = [1, 2, 8, 100, 10_000]
step = math.log(10.0) / 64.0  # sizes 1 and 0.1 are centres of bins
grid = cm.LogGrid(-279 * step, 0.0, 280)

continuum = cm.Simulation(material, grading, grid=grid).run(stress_ratio=loads)
sizes = grid.edge_sizes[40::8].tolist()  # at which the resolved closure is held against the lattice
resolved = cm.Simulation(material, grading, closure="resolved", sizes=sizes).run(stress_ratio=loads)
rings = cm.Lattice(500_000, material, grading, seed=1, replicas=4)
lattice = rings.run(stress_ratio=loads, grid=grid)


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    height = 150.0 if width < 120.0 else 210.0
    figure = plt.figure(figsize=figure_size(width, height), layout="constrained")
    shown = [loads.index(load) for load in (2, 8, 100, 10_000)]
    chosen = shown[::2] if width < 120.0 else shown
    plot_comparison(lattice, continuum, figure, resolved=resolved, loads=chosen, limits=(-3.0, 0.15))
    return figure


draw(170.0)
plt.show()

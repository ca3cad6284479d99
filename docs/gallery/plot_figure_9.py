r"""
Figure 9: a well-graded start
=============================

A power law of fractal dimension 2.5 between sizes 0.001 and 1. Few neighbours are alike, so that little crushes, and
the curves of lattice and continuum agree to a few hundredths. Of that little, though, the continuum model crushes only
about half; the law of three cells (below) crushes as much as the lattice. For a *narrow* band of sizes lattice and
continuum do not agree; see the page on how good the continuum model is.
"""

import math

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_comparison

material = cm.Material(weibull_modulus=3.0, fabric_width=0.05, reference_size=1.0)
grading = cm.power_law(fractal_dimension=2.5, smallest=1e-3, largest=1.0)
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
    plot_comparison(lattice, continuum, figure, resolved=resolved, loads=chosen, limits=(-7.0, 0.15))
    return figure


draw(170.0)
plt.show()

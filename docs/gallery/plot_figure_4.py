r"""
Figure 4: the four crush zones
==============================

For a pair of a grain :math:`\psi` and its neighbourhood :math:`\bar\psi` a load makes four zones: nothing crushes
(00), the grain (10), the neighbourhood (01), or both (11). With the paper's fabric width of 0.05 the zones 10 and 01
are too thin to see, so the map is drawn for a wider one. For any width the larger of the two is the first to crush.
"""

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_zones

material = cm.Material(fabric_width=1.2)
grid = cm.LogGrid(-4.0, 1.5, 441)


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    figure, ax = plt.subplots(figsize=figure_size(width, min(width, 110.0)), layout="constrained")
    plot_zones(grid, material, 8.0, ax)
    return figure


draw(170.0)
plt.show()

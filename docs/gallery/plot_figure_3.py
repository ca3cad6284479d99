r"""
Figure 3: which grains crush first
==================================

A grain of size :math:`s` among neighbours of mean size :math:`\bar s` crushes when the load reaches the contour on
which the pair lies. At equal sizes, on the diagonal, that takes :math:`\sigma^* = (s / s_\mathrm{max})^{-3/w}`; away
from it neighbours of another size cushion the grain and it takes far more. In log sizes the contours of
:math:`g(\psi, \bar\psi) = (\psi - \bar\psi)^2 - k \psi` are one parabola, shifted by the load.
"""

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_stress_contours

material = cm.Material(weibull_modulus=3.0, fabric_width=0.05, reference_size=1.0)
loads = [2, 8, 10_000]


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide; in one column the panels stand one above the other."""
    plt.rcParams.update(PRINT_STYLE)
    rows, columns, height = (2, 1, 160.0) if width < 120.0 else (1, 2, 84.0)
    figure, (left, right) = plt.subplots(rows, columns, figsize=figure_size(width, height), layout="constrained")
    plot_stress_contours(material, loads, left, limits=(0.0, 1.05))
    plot_stress_contours(material, loads, right, log_sizes=True, limits=(-6.0, 0.5))
    return figure


draw(170.0)
plt.show()

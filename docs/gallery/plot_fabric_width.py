r"""
How much breaks: fabric width and Weibull modulus
=================================================

The fabric width :math:`n` decides how many grains can break at all, since a neighbour that differs in :math:`\ln d` by
much more than :math:`n` cushions a grain. The Weibull modulus :math:`w` decides how fast that comes with the load: the
strength of a grain goes as :math:`d^{-3/w}`. For a graded sand (CEN standard sand), Hardin's relative breakage and the
median size against both, and against the load.

With the paper's :math:`n = 0.05`, made for pictures of nearly uniform packings, next to nothing of a graded sand breaks
under any load.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size

sizes, finer = [2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1]
sand = cm.Grading.from_sieves(sizes, finer, unit="mm")
loads = np.geomspace(1.0, 300.0, 25)
widths, moduli = (0.05, 0.1, 0.2, 0.4, 0.8), (2.0, 3.0, 6.0, 12.0)


def response(fabric_width: float, weibull_modulus: float) -> tuple[list[float], list[float]]:
    """Relative breakage and median size after each load."""
    material = cm.Material(reference_size=2.0, fabric_width=fabric_width, weibull_modulus=weibull_modulus)
    run = cm.Simulation(material, sand).run(stress_ratio=loads, keep_fabrics=[])
    curves = [run.curve(k) for k in range(loads.size)]
    return [cm.relative_breakage(sand, curve) for curve in curves], [curve.percentile(50) for curve in curves]


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    narrow = width < 120.0
    figure = plt.figure(figsize=figure_size(width, 150.0 if narrow else 110.0), layout="constrained")
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    for column, (name, values) in enumerate((("n", widths), ("w", moduli))):
        for rank, value in enumerate(values):
            fixed = (value, 3.0) if name == "n" else (0.3, value)
            colour = plt.get_cmap("viridis")(0.9 * rank / (len(values) - 1))
            for row, found in enumerate(response(*fixed)):
                axes[row, column].semilogx(loads, found, color=colour, label=f"{value:g}")
        axes[0, column].legend(title="$n$; $w = 3$" if name == "n" else "$w$; $n = 0.3$", loc="upper left")
        axes[1, column].set_xlabel(r"stress ratio $\sigma^*$")
    axes[0, 0].set_ylabel("relative breakage $B_r$")
    axes[1, 0].set(ylabel="D50 (mm)", yscale="log")
    for ax in axes.flat:
        ax.grid(alpha=0.3, lw=0.4)
    return figure


draw(170.0)
plt.show()

r"""
Figure 6: a joint distribution before and after crushing
========================================================

Left, two populations of grains mixed completely: grainsize and neighbourhood grainsize are independent. Right,
the same after slow crushing: the zone inside the red curves is empty, and what was in it has left for smaller sizes.
The curves on the sides are the two marginal densities; below, the gradings as the tester sees them.
"""

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_state

sizes = np.exp(np.linspace(-5.0, 0.0, 401))


def finer_than(median: float, spread: float) -> np.ndarray:
    """Share of a lognormal population below each of `sizes`."""
    return np.array([0.5 * math.erfc(-math.log(size / median) / (spread * math.sqrt(2.0))) for size in sizes])


percent = 50.0 * (finer_than(0.6, 0.12) + finer_than(0.06, 0.15))
percent[0], percent[-1] = 0.0, 100.0
start = cm.Grading.from_sieves(sizes, percent, unit="")
load = 10_000.0
result = cm.Simulation(cm.Material(), start, grid=cm.LogGrid(-10.4, 0.1, 421)).run(stress_ratio=load)


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    figure = plt.figure(figsize=figure_size(width, 0.5 * width + 72.0), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=(0.5 * width + 22.0, 50.0))
    upper, lower = parts
    for ax, fabric in zip(upper.subplots(1, 2, sharey=True), (result.start, result.fabric(0)), strict=True):
        plot_state(fabric, ax, material=result.material, stress_ratio=load, limits=(-6.0, 0.0), marginals=True)
        ax.label_outer()
        ax.text(0.02, 1.36, "before" if fabric is result.start else "after", transform=ax.transAxes, va="top")
    mesh = ax.collections[0]
    upper.colorbar(
        mesh, ax=upper.axes[:2], location="bottom", aspect=40, shrink=0.6, label="density of mass", extend="both"
    )
    ax = lower.subplots()
    ax.semilogx(result.edge_size, result.start.cdf(), "k--", label="before")
    ax.semilogx(result.edge_size, result.cdf[0], color="#0072b2", label=rf"after $\sigma^*$ = {load:g}")
    ax.set(xlim=(math.exp(-6.0), 1.0), ylim=(0.0, 1.02))
    ax.set(xlabel="grainsize $s$ / reference size", ylabel="mass fraction finer")
    ax.grid(alpha=0.3, lw=0.4)
    ax.legend()
    return figure


draw(170.0)
plt.show()

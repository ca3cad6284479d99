r"""
Strengths that scatter: how a uniform sand yields
=================================================

All grains of one size have one strength in the paper's model, so that a uniform sand does nothing up to its first crush
and then crushes at once. In a test it yields over a decade of stress. With ``strength_scatter`` each grain, and each
fragment anew, has a strength of its own, from the Weibull law of the modulus that already tells how strength falls with
size.

Left, the share of the grains that has crushed, by the law of three cells (lines) and on the lattice (points). Right,
what that does to the void ratio: the densest packing of each grading under 10 kPa and vibration, by the compressible
packing model of de Larrard (1999, Concrete Mixture Proportioning) with a virtual packing of 2/3 for each size.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size

grading = cm.monodisperse(1.0)
loads = np.geomspace(0.1, 100.0, 31)
looks = {False: ("one strength a size", "#0072b2", "s"), True: ("scattered strengths", "#d55e00", "o")}


results, witnesses = {}, {}
for scatter in looks:
    material = cm.Material(weibull_modulus=3.0, fabric_width=0.2, strength_scatter=scatter)
    results[scatter] = cm.Simulation(material, grading, closure="resolved").run(stress_ratio=loads)
    witnesses[scatter] = cm.Lattice(50_000, material, grading, seed=1).run(stress_ratio=loads[::3])


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    narrow = width < 120.0
    figure = plt.figure(figsize=figure_size(width, 120.0 if narrow else 75.0), layout="constrained")
    left, right = figure.subplots(2, 1, sharex=True) if narrow else figure.subplots(1, 2)
    for scatter, (name, colour, marker) in looks.items():
        result, witness = results[scatter], witnesses[scatter]
        crushed = [1.0 - sum(point.mass for point in points) for points in result.points]
        counted = [1.0 - sum(point.mass for point in points) for points in witness.points]
        left.semilogx(loads, crushed, color=colour, label=name)
        left.semilogx(loads[::3], counted, marker, color=colour, ms=3, mfc="none")
        right.semilogx(loads, result.void_ratio(packing=2.0 / 3.0), color=colour, label=name)
    left.set(ylim=(0.0, 0.7), ylabel="share of the grains crushed")
    right.set(xlabel=r"stress ratio $\sigma^*$", ylabel="void ratio")
    if not narrow:
        left.set_xlabel(r"stress ratio $\sigma^*$")
    for ax in (left, right):
        ax.grid(alpha=0.3, lw=0.4)
    left.legend()
    return figure


draw(170.0)
plt.show()

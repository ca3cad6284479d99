r"""
Older models, and the order of mixing and crushing
==================================================

Half coarse grains (0.7 to 1 mm) and half fine ones (0.07 to 0.1 mm), crushed by five models. Kolmogorov's and
Epstein's random products treat all grains alike; crushing by size alone has one size that bears the load; batch
grinding has a rate that rises with size; breakage mechanics moves the whole curve towards an ultimate one; the fabric
model looks at the neighbours.

Black: the two halves are mixed and then crushed. Colour: each half is crushed by itself, and what comes out is mixed.
For the first three models there is no difference, since they are linear in the grading and a grain's fate is a matter
of its size at most. Breakage mechanics knows no grains: each curve moves towards the ultimate grading of its largest
size, the fine half's share at 0.1 mm even upwards in the mixture, and so the order matters without a reason in the
packing. In the fabric model the fine half cushions the coarse one where both lie together, and only there: the same
grains under the same stress come out differently.
"""

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size

halves = [cm.uniform_size(0.7, 1.0).with_unit("mm"), cm.uniform_size(0.07, 0.1).with_unit("mm")]
both = cm.comparators.mixture([0.5, 0.5], halves)
mixed = cm.Grading.from_sieves(both.size, 100.0 * both.finer, unit="mm")
fragments = cm.WeibullFragments()
material = cm.Material(reference_size=1.0, fabric_width=0.2, fragments=fragments)
load = 20.0

models: dict[str, Callable[[cm.Grading], cm.SizeCurve]] = {
    "random products": lambda start: cm.comparators.independent(start, fragments, mean_crushes=1.0),
    "size alone": lambda start: cm.comparators.size_threshold(start, material, 2.0),
    "batch grinding": lambda start: cm.comparators.batch_grinding(start, fragments, 1.0, 1.5, smallest=1e-4),
    "breakage mechanics": lambda start: cm.comparators.breakage(start, 3.0),
    "fabric model": lambda start: cm.Simulation(material, start).run(stress_ratio=load).curve(),
}
mixed_first = {name: crush(mixed) for name, crush in models.items()}
crushed_first = {
    name: cm.comparators.mixture([0.5, 0.5], [crush(half) for half in halves]) for name, crush in models.items()
}


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    narrow = width < 120.0
    columns = 2 if narrow else 3
    figure = plt.figure(figsize=figure_size(width, 150.0 if narrow else 105.0), layout="constrained")
    axes = figure.subplots(-(-6 // columns), columns, sharex=True, sharey=True)
    for ax, name in zip(axes.flat, models, strict=False):
        ax.semilogx(both.size, 100.0 * both.finer, color="0.7", label="start")
        after, apart = mixed_first[name], crushed_first[name]
        ax.semilogx(after.size, 100.0 * after.finer, "k", label="mixed, then crushed")
        ax.semilogx(apart.size, 100.0 * apart.finer, "--", color="#d55e00", label="crushed, then mixed")
        size = np.geomspace(1e-3, 1.0, 400)
        distance = np.abs(after.finer_than(size) - apart.finer_than(size)).max()
        ax.set_title(f"{name}\n{100.0 * distance:.0f} % apart", fontsize="medium")
        ax.set(xlim=(2e-3, 1.3), ylim=(0.0, 103.0))
        ax.grid(alpha=0.3, lw=0.4)
    legend = axes.flat[-1]
    legend.set_axis_off()
    legend.legend(*axes.flat[0].get_legend_handles_labels(), loc="center")
    for ax in axes.flat[len(models) - columns : len(models)]:
        ax.set_xlabel("grain size (mm)")
        ax.tick_params(labelbottom=True)
    for ax in axes[:, 0]:
        ax.set_ylabel("finer by mass (%)")
    return figure


draw(170.0)
plt.show()

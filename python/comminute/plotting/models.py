"""Curves of several models beside each other. Needs matplotlib."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from comminute.gradings.curves import SizeCurve
from comminute.plotting.everyday import SHOWN
from comminute.plotting.style import Picture, size_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLES = ("--", "-.", ":", (0, (5, 1)), (0, (1, 1)), (0, (3, 1, 1, 1, 1, 1)))


def plot_models(
    quantity: str,
    loads: Sequence[str],
    curves: Sequence[SizeCurve],
    others: Mapping[str, Sequence[SizeCurve]],
    *,
    name: str = "fabric model",
    columns: int = 3,
) -> Figure:
    """Draw a panel for each load, the curve of a result in black and those of other models over it.

    Parameters
    ----------
    quantity : str
        Name of the loads.
    loads : sequence of str
        Texts of the loads.
    curves : sequence of SizeCurve
        Curves of the result.
    others : mapping of str to sequence of SizeCurve
        Curves of each model, one for each load.
    name : str
        Name of the result in the legend.
    columns : int
        Panels beside each other.

    Returns
    -------
    matplotlib.figure.Figure
    """
    across = min(columns, len(loads))
    rows = math.ceil(len(loads) / across)
    figure = Picture(figsize=(2.6 * across + 0.6, 2.4 * rows + 0.6), layout="constrained")
    axes = figure.subplots(rows, across, squeeze=False, sharex=True, sharey=True)
    everything = [*curves, *(curve for of_model in others.values() for curve in of_model)]
    largest = max(float(curve.size[-1]) for curve in everything)
    shown = [float(curve.size[curve.finer >= SHOWN][0]) for curve in everything]
    for k, ax in enumerate(axes.flat):
        if k >= len(loads):
            ax.set_axis_off()
            continue
        ax.plot(curves[k].size, 100.0 * curves[k].finer, "k", lw=1.6, label=name)
        for place, (model, of_model) in enumerate(others.items()):
            curve = of_model[k]
            style = STYLES[place % len(STYLES)]
            ax.plot(curve.size, 100.0 * curve.finer, color=f"C{place}", ls=style, lw=1.2, label=model)
        ax.set_xscale("log")
        ax.set(xlim=(0.7 * min(shown), 1.3 * largest), ylim=(0.0, 102.0), title=f"{quantity} {loads[k]}")
        ax.title.set_fontsize("medium")
    for ax in axes[-1]:
        ax.set_xlabel(size_label("grain size", curves[0].unit))
    for ax in axes[:, 0]:
        ax.set_ylabel("finer by mass (%)")
    axes[0, 0].legend(frameon=False, fontsize="small")
    return figure

"""Sizes over the height of a column and time. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.axis import Axis
from matplotlib.colors import LogNorm, Normalize
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from comminute.plotting.style import Picture, size_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]
WIDE = 4.0  # largest to smallest size from which on sizes go by their logs


def plot_column(time: Floats, z: Floats, size: Floats, name: str, unit: str) -> Figure:
    """Draw a size by height and time, and its profiles at some times beside it.

    Parameters
    ----------
    time : ndarray (T,)
        In seconds.
    z : ndarray (Z,)
        Heights of the rows' middles, in metres of solid.
    size : ndarray (T, Z)
    name, unit : str
        Name of the size and its unit.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = Picture(figsize=(6.6, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(3, 2))
    spread = 0.5 * (z[1] - z[0])
    lowest, highest = float(size.min()), float(size.max())
    by_log = highest > WIDE * lowest
    if time.size > 1:
        middles = 0.5 * (time[1:] + time[:-1])
        edges = np.concatenate([[time[0]], middles, [time[-1]]])
        norm = LogNorm(lowest, highest) if by_log else Normalize(lowest, highest)
        mesh = left.pcolormesh(edges, np.append(z - spread, z[-1] + spread), size.T, cmap="viridis", norm=norm)
        bar = figure.colorbar(mesh, ax=left, label=size_label(name, unit))
        _sizes_along(bar.ax.yaxis, by_log=by_log)
    left.set(xlabel="time (s)", ylabel="height (m of solid)")
    shown = np.unique(np.linspace(0, time.size - 1, min(time.size, 5)).round().astype(int))
    for rank, k in enumerate(shown):
        colour = f"{0.75 * (1.0 - rank / max(shown.size - 1, 1)):.3f}"
        right.plot(size[k], z, color=colour, label=f"{time[k]:.4g} s")
    right.set_xscale("log" if by_log else "linear")
    _sizes_along(right.xaxis, by_log=by_log)
    right.set_xlabel(size_label(name, unit))
    figure.legend(*right.get_legend_handles_labels(), frameon=False, loc="outside right center", fontsize="small")
    return figure


def _sizes_along(axis: Axis, *, by_log: bool) -> None:
    """Mark an axis with few sizes, as plain numbers."""
    axis.set_major_locator(LogLocator(subs=(1.0, 3.0)) if by_log else MaxNLocator(4))
    axis.set_major_formatter(FuncFormatter(lambda at, _: f"{at:g}"))
    axis.set_minor_formatter(NullFormatter())

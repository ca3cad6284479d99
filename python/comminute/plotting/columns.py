"""Sizes over the height of a column and time. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from comminute.plotting.style import Picture, size_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]


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
    if time.size > 1:
        middles = 0.5 * (time[1:] + time[:-1])
        edges = np.concatenate([[time[0]], middles, [time[-1]]])
        norm = LogNorm(float(size.min()), float(size.max())) if size.min() < size.max() else None
        mesh = left.pcolormesh(edges, np.append(z - spread, z[-1] + spread), size.T, cmap="viridis", norm=norm)
        figure.colorbar(mesh, ax=left, label=size_label(name, unit))
    left.set(xlabel="time (s)", ylabel="height (m of solid)")
    shown = np.unique(np.linspace(0, time.size - 1, min(time.size, 5)).round().astype(int))
    for rank, k in enumerate(shown):
        colour = f"{0.75 * (1.0 - rank / max(shown.size - 1, 1)):.3f}"
        right.plot(size[k], z, color=colour, label=f"{time[k]:.4g} s")
    right.set_xscale("log")
    right.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    right.xaxis.set_major_formatter(FuncFormatter(lambda at, _: f"{at:g}"))
    right.xaxis.set_minor_formatter(NullFormatter())
    right.set_xlabel(size_label(name, unit))
    right.legend(frameon=False)
    return figure

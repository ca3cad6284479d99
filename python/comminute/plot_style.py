"""What the plots share: axes that no window shows, colours of loads, labels of sizes. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOAD_COLOURS = mpl.colormaps["viridis"]


def new_axes() -> Axes:
    """One `Axes` on a figure of its own, which no window shows.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> from comminute.plot_style import new_axes
    >>> new_axes().figure.axes == []
    False
    """
    return Figure(figsize=(3.4, 3.2), layout="constrained").add_subplot()


def size_label(name: str, unit: str) -> str:
    """Axis label of sizes in a unit, or relative to the reference size where there is none."""
    return f"{name} ({unit})" if unit else f"{name} / reference"

"""Style shared by the plots: pictures that no window shows, colours of loads, labels of sizes. Needs matplotlib."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOAD_COLOURS = mpl.colormaps["viridis"]


class Picture(Figure):
    """A figure that no window shows, but a notebook does, whether pyplot is there or not."""

    def png(self) -> bytes:
        """Bytes of a picture file, 100 dots to the inch."""
        target = io.BytesIO()
        self.savefig(target, format="png", dpi=100)
        return target.getvalue()

    _repr_png_ = png


def new_axes() -> Axes:
    """One `Axes` on a figure of its own, which no window shows.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> from comminute.plotting.style import new_axes
    >>> new_axes().figure.axes == []
    False
    """
    return Picture(figsize=(3.4, 3.2), layout="constrained").add_subplot()


def size_label(name: str, unit: str) -> str:
    """Axis label of sizes in a unit, or relative to the reference size where there is none."""
    return f"{name} ({unit})" if unit else f"{name} / reference"

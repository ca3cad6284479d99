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


def new_axes(width: float = 3.4, height: float = 3.2) -> Axes:
    """One `Axes` on a figure of its own, which no window shows.

    Parameters
    ----------
    width, height : float
        Size of the figure in inches.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> from comminute.plotting.style import new_axes
    >>> new_axes().figure.axes == []
    False
    """
    return Picture(figsize=(width, height), layout="constrained").add_subplot()


def size_label(name: str, unit: str) -> str:
    """Axis label of sizes in a unit, which is that of the reference size where it has no name."""
    return f"{name} ({unit or 'unit of the reference size'})"


def log_size_label(log_size: str, size: str, unit: str) -> str:
    r"""Axis label of log sizes, both names in TeX: ln of sizes in a unit.

    Examples
    --------
    >>> from comminute.plotting.style import log_size_label
    >>> print(log_size_label(r"\psi", "s", "mm"), "or", log_size_label(r"\psi", "s", ""))
    $\psi$ = ln($s$ / mm) or $\psi$ = ln $s$
    """
    return rf"${log_size}$ = ln(${size}$ / {unit})" if unit else rf"${log_size}$ = ln ${size}$"

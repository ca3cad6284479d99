"""Void ratio against load. Needs matplotlib."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullFormatter, ScalarFormatter

from comminute.plotting.style import Picture
from comminute.runs.remarks import load_labels
from comminute.runs.results import ResultData

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = npt.NDArray[np.float64]
MODELS = {"cpm": "compressible packing model", "lpm": "linear packing model"}


def plot_compression(
    result: ResultData,
    start: float,
    void_ratio: Floats,
    model: str,
    *,
    measured: tuple[Sequence[float], Sequence[float]] | None = None,
    log_void_ratio: bool = False,
    ax: Axes | None = None,
) -> Figure:
    """Draw the void ratio of a result against its load on a log scale.

    Parameters
    ----------
    result : Result
    start : float
        Void ratio at the start.
    void_ratio : ndarray (T,)
        After each load.
    model : str
        Packing model, for the legend.
    measured : (loads, void ratios), optional
        Points to lay over it.
    log_void_ratio : bool
        Whether the void ratio has a log scale too.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    quantity, _ = load_labels(result)
    loads = result.stress_ratio if result.stress is None else result.stress
    held = loads > 0.0
    rising = np.maximum.accumulate(loads[held])
    least = float(rising.min()) if rising.size else 1.0
    lines = {MODELS.get(model, model): (rising, void_ratio[held])}
    points = {} if measured is None else {"measured": measured}
    figure = plot_void_ratios(lines, points, quantity=quantity, log_void_ratio=log_void_ratio, ax=ax)
    figure.axes[0].plot([0.3 * least, least], [start] * 2, "k:", lw=1.0)
    return figure


def plot_void_ratios(
    lines: Mapping[str, tuple[Sequence[float] | Floats, Sequence[float] | Floats]],
    points: Mapping[str, tuple[Sequence[float] | Floats, Sequence[float] | Floats]],
    *,
    quantity: str = "stress",
    log_void_ratio: bool = False,
    ax: Axes | None = None,
) -> Figure:
    """Draw void ratios against stress on a log scale, computed ones as lines and measured ones as points.

    Parameters
    ----------
    lines, points : mapping of str to (loads, void ratios)
        By name; loads of 0 have no place on the axis and are left out.
    quantity : str
        Name of the loads.
    log_void_ratio : bool
        Whether the void ratio has a log scale too.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    if ax is None:
        ax = Picture(figsize=(4.2, 3.2), layout="constrained").add_subplot()
    for k, (name, (loads, ratios)) in enumerate(lines.items()):
        ax.plot(loads, ratios, color="k" if len(lines) == 1 else f"C{k}", label=name)
    for k, (name, (loads, ratios)) in enumerate(points.items()):
        at, found = np.asarray(loads, dtype=np.float64), np.asarray(ratios, dtype=np.float64)
        colour = "C3" if len(points) == 1 else f"C{k}"
        ax.plot(at[at > 0.0], found[at > 0.0], "o", mfc="none", color=colour, label=name)
    ax.set_xscale("log")
    if log_void_ratio:
        ax.set_yscale("log")
        ax.yaxis.set_major_locator(MaxNLocator(5))
        ax.yaxis.set_major_formatter(ScalarFormatter())
        ax.yaxis.set_minor_formatter(NullFormatter())
    ax.set(xlabel=quantity, ylabel="void ratio")
    ax.legend(frameon=False)
    figure = ax.figure
    assert isinstance(figure, Figure)
    return figure

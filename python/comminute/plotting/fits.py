"""A fit: gradings measured and fitted, residuals, intervals. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from comminute.plotting.style import LOAD_COLOURS, Picture, size_label
from comminute.runs.remarks import load_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from comminute._core import Grading
    from comminute.gradings.curves import SizeCurve
    from comminute.runs.results import Floats

COUNT = 160  # sizes of a drawn curve


class Datum(Protocol):
    """A measured grading."""

    @property
    def stress(self) -> float:
        """Load."""

    @property
    def size(self) -> Floats:
        """(M,) sieves."""

    @property
    def finer(self) -> Floats:
        """(M,) mass fraction finer."""

    @property
    def unit(self) -> str:
        """Unit of the sieves."""


class Fitted(Protocol):
    """Outcome of a fit; a `FitResult`."""

    @property
    def data(self) -> Sequence[Datum]:
        """Measurements."""

    @property
    def residuals(self) -> Sequence[Floats]:
        """(M,) model less measurement, for each."""

    @property
    def values(self) -> dict[str, float]:
        """Parameters found."""

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Their intervals."""

    @property
    def starts(self) -> Sequence[Grading]:
        """Starts."""

    def curves(self) -> Sequence[SizeCurve]:
        """Fitted curve of each measurement."""


def plot_fit(found: Fitted) -> Picture:
    """Draw measured points over fitted curves (left), residuals by size and load, and intervals over the values.

    Parameters
    ----------
    found : FitResult

    Returns
    -------
    matplotlib Figure
    """
    figure = Picture(figsize=(7.2, 3.6), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.3, 1.0))
    curves, gaps, ends = (
        figure.add_subplot(grid[:, 0]),
        figure.add_subplot(grid[0, 1]),
        figure.add_subplot(grid[1, 1]),
    )
    sizes = np.concatenate([datum.size for datum in found.data])
    shown = np.geomspace(sizes.min(), sizes.max(), COUNT)
    for start in found.starts:
        curves.semilogx(shown, 100.0 * start.finer(shown), color="0.6", linestyle=":", linewidth=1.0)
    order = np.argsort([datum.stress for datum in found.data], kind="stable")
    fitted = found.curves()
    for rank, k in enumerate(order):
        datum, colour = found.data[k], LOAD_COLOURS(0.9 * rank / max(len(order) - 1, 1))
        curves.semilogx(shown, 100.0 * fitted[k].finer_than(shown), color=colour, linewidth=1.0)
        curves.plot(
            datum.size,
            100.0 * datum.finer,
            "o",
            color=colour,
            markersize=3.0,
            label=load_text(datum.stress),
            clip_on=False,
        )
        gaps.semilogx(datum.size, 100.0 * found.residuals[k], "o-", color=colour, markersize=2.0, linewidth=0.6)
    curves.set(xlabel=size_label("size", found.data[0].unit), ylabel="mass finer (%)", ylim=(0.0, 100.0))
    curves.legend(title="load", fontsize=7, title_fontsize=7, frameon=False)
    gaps.axhline(0.0, color="0.7", linewidth=0.6)
    gaps.set(xlabel=size_label("size", found.data[0].unit), ylabel="residual (%)")
    names = list(found.values)
    for row, name in enumerate(names):
        value, (low, high) = found.values[name], found.intervals[name]
        unit = value if value > 0.0 else 1.0
        ends.plot([low / unit, high / unit], [row, row], color="C0", linewidth=2.0)
        ends.plot([value / unit], [row], "o", color="C0", markersize=3.5)
    if max(high / max(found.values[name], 1e-300) for name, (_, high) in found.intervals.items()) > 3.0:
        ends.set_xscale("log")
    ends.axvline(1.0, color="0.7", linewidth=0.6)
    ends.set_yticks(
        range(len(names)), [f"{name.replace('_', ' ')} = {found.values[name]:.3g}" for name in names], fontsize=7
    )
    ends.set(xlabel="95 % interval over the value", ylim=(len(names) - 0.5, -0.5))
    return figure

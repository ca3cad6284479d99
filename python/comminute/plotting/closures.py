"""Closures against the lattice: curves and distances. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from comminute.plotting.comparison import plot_distances
from comminute.plotting.style import LOAD_COLOURS, Picture, size_label
from comminute.runs.remarks import load_text

if TYPE_CHECKING:
    from comminute.lattice.comparison import Comparison
    from comminute.runs.results import Floats

MOST_CURVES = 3  # loads that are drawn, since each has three curves
SHOWN = 2e-3  # share of the mass that is finer than the left end of the axis


class Closures(Protocol):
    """Curves of both closures and of the lattice; a `ClosureComparison`."""

    @property
    def stress_ratio(self) -> Floats:
        """(T,) loads."""

    @property
    def size(self) -> Floats:
        """(M,) sizes of the curves."""

    @property
    def start(self) -> Floats:
        """(M,) curve at the start."""

    @property
    def paper(self) -> Floats:
        """(T, M) curves of the paper's closure."""

    @property
    def resolved(self) -> Floats:
        """(T, M) curves of the law of three cells."""

    @property
    def lattice(self) -> Floats:
        """(T, M) curves of the lattice."""

    @property
    def unit(self) -> str:
        """Unit of the sizes."""

    @property
    def distances(self) -> dict[str, Comparison]:
        """Distances of both closures to the lattice."""


def plot_closures(found: Closures) -> Picture:
    """Draw the curves of both closures over the lattice's (left) and their distances to it (right).

    Parameters
    ----------
    found : ClosureComparison

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_closures
    >>> found = cm.compare_closures(cm.Material(), cm.monodisperse(1.0), stress_ratio=[1.0, 8.0], cells=5_000)
    >>> [ax.get_ylabel() for ax in plot_closures(found).axes]
    ['mass fraction finer', 'largest CDF distance']
    """
    figure = Picture(figsize=(9.6, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(found.size, found.start, color="k", ls="--", lw=1.0, label="start")
    chosen = np.unique(np.linspace(0, found.stress_ratio.size - 1, MOST_CURVES).round().astype(int))
    for place, k in enumerate(chosen):
        colour = LOAD_COLOURS(0.85 * (1.0 - place / max(chosen.size - 1, 1)))
        name = rf"$\sigma^*$ = {load_text(found.stress_ratio[k])}"
        left.plot(found.size, found.lattice[k], color=colour, lw=3.5, alpha=0.35, label=f"{name}, lattice")
        left.plot(found.size, found.resolved[k], color=colour, lw=1.2, label="resolved")
        left.plot(found.size, found.paper[k], color=colour, ls=":", lw=1.4, label="paper")
    low = int(np.argmax(found.lattice.max(axis=0) > SHOWN))
    left.set(xscale="log", xlim=(found.size[max(low - 1, 1)], 1.1 * found.size[-1]), ylim=(0.0, 1.02))
    left.set(xlabel=size_label("grainsize", found.unit), ylabel="mass fraction finer")
    left.grid(alpha=0.3, lw=0.4)
    left.legend(fontsize="small", loc="upper left")
    plot_distances(found.distances, right)
    return figure

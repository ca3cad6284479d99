"""Marginal densities of a fabric on the sides of its picture. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from comminute._core import Fabric, LogGrid

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes

    from comminute.runs.results import Floats

STEM_COLOUR = "#222222"
AIR = 1.1  # height of the axes over the highest bin


def draw_marginals(ax: Axes, fabric: Fabric, *, colour: Any, width: float, stems: bool) -> None:
    """Draw the densities of grainsize above an axes and of neighbourhood grainsize to its right.

    Parameters
    ----------
    ax : matplotlib Axes
        Axes of the fabric, whose limits both share.
    fabric : Fabric
    colour : matplotlib colour
    width : float
        Width of a density, as a share of the axes'.
    stems : bool
        Whether mass of one exact size stands apart as a stem, whose height means nothing, so that the densities are to
        scale for the rest; else it lies in its bin.
    """
    grid = fabric.grid
    across = ax.inset_axes((0.0, 1.03, 1.0, width), sharex=ax)
    along = ax.inset_axes((1.03, 0.0, width, 1.0), sharey=ax)
    (sizes, sizes_at), (neighbours, neighbours_at) = _grainsize(fabric), _neighbourhood(fabric)
    if not stems:
        sizes, neighbours, sizes_at, neighbours_at = fabric.grainsize(), fabric.neighbourhood(), [], []
    style: dict[str, Any] = {"fill": True, "color": colour}
    across.stairs(sizes / grid.spacing, grid.edges, **style)
    along.stairs(neighbours / grid.spacing, grid.edges, orientation="horizontal", **style)
    across.set_ylim(0.0, _height(sizes / grid.spacing))
    along.set_xlim(0.0, _height(neighbours / grid.spacing))
    stem: dict[str, Any] = {"color": STEM_COLOUR, "lw": 1.0}
    for at in sizes_at:
        across.axvline(at, **stem)
    for at in neighbours_at:
        along.axhline(at, **stem)
    for side in (across, along):
        side.tick_params(labelbottom=False, labelleft=False, left=False, bottom=False)
        side.spines[["top", "right"]].set_visible(False)


def _height(density: Floats) -> float:
    highest = float(density.max())
    return AIR * highest if highest > 0.0 else 1.0


def _grainsize(fabric: Fabric) -> tuple[Floats, list[float]]:
    """Mass by grainsize without that of exact sizes, and those sizes."""
    exact = [(atom.psi, atom.mass) for atom in fabric.atoms]
    exact += [(ridge.at, float(ridge.mass.sum())) for ridge in fabric.ridges if ridge.exact == "grain"]
    return _without(fabric.grid, fabric.grainsize(), exact)


def _neighbourhood(fabric: Fabric) -> tuple[Floats, list[float]]:
    exact = [(atom.psibar, atom.mass) for atom in fabric.atoms]
    exact += [(ridge.at, float(ridge.mass.sum())) for ridge in fabric.ridges if ridge.exact == "neighbour"]
    return _without(fabric.grid, fabric.neighbourhood(), exact)


def _without(grid: LogGrid, pmf: Floats, exact: Iterable[tuple[float, float]]) -> tuple[Floats, list[float]]:
    spread = pmf.copy()
    for at, mass in exact:
        spread[grid.bin_of(at)] -= mass
    spread[spread < np.finfo(float).eps] = 0.0  # what differences of sums leave
    return spread, sorted({at for at, mass in exact if mass > 0.0})

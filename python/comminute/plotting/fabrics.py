"""Pictures of a fabric with its marginals and crush zone, and of a whole result. Needs matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm

from comminute._core import Fabric, Material
from comminute.plotting.everyday import plot_curves
from comminute.plotting.marginals import draw_marginals
from comminute.plotting.paper import zone_edge
from comminute.plotting.style import Picture, log_size_label, new_axes
from comminute.runs.remarks import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from comminute.runs.results import Floats, ResultData

ZONE_COLOUR = "#d62728"
MARGINAL_COLOUR = "#33638d"
POINT_COLOUR = "#222222"
RIDGE_COLOUR = "#e69f00"
POINT_MASS = 0.01  # share of the mass above which a cell is drawn as a point mass
SHOWN_TAIL = 1e-3  # share of the mass, from the finest up, that need not be in the picture


def _visible_range(pmf: Floats, edges: Floats, tail: float) -> tuple[float, float]:
    """Log sizes between which all but `tail` of the mass lies, with a little air."""
    finer = np.cumsum(pmf)
    first = int(np.searchsorted(finer, tail))
    last = int(np.searchsorted(finer, 1.0 - 1e-12))
    low, high = edges[first], edges[min(last + 1, edges.size - 1)]
    air = 0.04 * (high - low)
    return float(low - air), float(high + air)


def plot_fabric(
    fabric: Fabric,
    ax: Axes | None = None,
    *,
    material: Material | None = None,
    stress_ratio: float | None = None,
    unit: str = "",
    decades: float = 5.0,
) -> Axes:
    """Density of the fabric with its marginals, and the edge of the crush zone.

    Parameters
    ----------
    fabric : Fabric
    ax : matplotlib Axes, optional
    material : Material, optional
        Material whose crush zone is drawn, under `stress_ratio`.
    stress_ratio : float, optional
        Load of the crush zone. Left out: the load under which the fabric is at rest.
    unit : str
        Unit of the sizes, for the labels.
    decades : float
        Decades that the colours cover below the largest density.

    Returns
    -------
    matplotlib Axes
    """
    ax = new_axes(5.4, 4.4) if ax is None else ax
    grid = fabric.grid
    density = fabric.probability / grid.spacing**2
    low, high = _visible_range(fabric.grainsize(), grid.edges, SHOWN_TAIL)
    spread = density[density > 0.0]
    top = float(np.quantile(spread, 0.999)) if spread.size else 1.0  # without the few cells of point masses
    image = ax.pcolormesh(
        grid.edges,
        grid.edges,
        np.ma.masked_less(density.T, top * 10.0**-decades),
        norm=LogNorm(top * 10.0**-decades, top),
        cmap="Blues",
        rasterized=True,
    )
    _draw_ridges(ax, fabric)
    _mark_point_masses(ax, fabric)
    load = fabric.settled_at if stress_ratio is None else stress_ratio
    if material is not None and load:  # without a load nothing crushes
        _draw_zone(ax, fabric, material, load)
    if ax.get_legend_handles_labels()[0]:
        ax.legend(fontsize="small", loc="lower right", framealpha=0.85)
    ax.set(
        xlim=(low, high),
        ylim=(low, high),
        xlabel="grainsize " + log_size_label(r"\psi", "s", unit),
        ylabel="neighbourhood grainsize " + log_size_label(r"\bar\psi", r"\bar s", unit),
    )
    ax.set_box_aspect(1)
    draw_marginals(ax, fabric, colour=MARGINAL_COLOUR, width=0.17, stems=True)
    bar = ax.inset_axes((1.24, 0.0, 0.035, 1.0))
    bar.figure.colorbar(image, cax=bar, label="density of mass", extend="max")
    return ax


def _mark_point_masses(ax: Axes, fabric: Fabric) -> None:
    """Circle the atoms, and cells with more mass than `POINT_MASS`; areas go with the mass."""
    centres = fabric.grid.centres
    heavy = [
        (centres[i], centres[j], fabric.probability[i, j])
        for i, j in zip(*np.nonzero(fabric.probability > POINT_MASS), strict=True)
    ]
    points = np.array([*heavy, *(tuple(atom) for atom in fabric.atoms)]).reshape(-1, 3)
    if len(points) == 0:
        return
    psi, psibar, mass = points.T
    ax.scatter(psi, psibar, s=300.0 * mass, facecolors="none", edgecolors=POINT_COLOUR, lw=1.2, label="point mass")


def _draw_ridges(ax: Axes, fabric: Fabric) -> None:
    """Draw the mass that has one exact size, as lines whose strength goes with the mass along them."""
    edges = fabric.grid.edges
    strongest = max((float(ridge.mass.max()) for ridge in fabric.ridges), default=0.0)
    if strongest == 0.0:
        return
    for ridge in fabric.ridges:
        along = np.column_stack([edges[:-1], edges[1:]])
        across = np.full_like(along, ridge.at)
        pair = (across, along) if ridge.exact == "grain" else (along, across)
        faintness = np.clip(1.0 + 0.3 * np.log10(np.maximum(ridge.mass, 1e-300) / strongest), 0.0, 1.0)
        lines = LineCollection(list(np.stack(pair, axis=-1)), colors=RIDGE_COLOUR, alpha=faintness, lw=1.6)
        ax.add_collection(lines, autolim=False)
    ax.plot([], [], color=RIDGE_COLOUR, lw=1.6, label="one size exact")


def _draw_zone(ax: Axes, fabric: Fabric, material: Material, stress_ratio: float) -> None:
    """Draw the edge of the active band, in which the larger grain crushes, on both sides of the diagonal."""
    psi, psibar = zone_edge(material, stress_ratio, fabric.grid.psi_max + 0.5)
    upper = psi >= psibar
    larger, smaller = psi[upper], psibar[upper]
    ax.plot(larger, smaller, color=ZONE_COLOUR, lw=1.0, label=f"crush zone at stress ratio {load_text(stress_ratio)}")
    ax.plot(smaller, larger, color=ZONE_COLOUR, lw=1.0)


def plot_result(result: ResultData, load: int = -1) -> Picture:
    """Grading curves (left) and the fabric after one load with its marginals and crush zone (right).

    Parameters
    ----------
    result : Result
    load : int
        Index of the load whose fabric is drawn.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = Picture(figsize=(10.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    plot_curves(result, left)
    fabric = result.fabric(load)
    at_rest_under = fabric.settled_at
    stress_ratio = float(result.stress_ratio[load]) if at_rest_under is None else at_rest_under
    plot_fabric(fabric, right, material=result.material, stress_ratio=stress_ratio, unit=result.unit)
    ranges = [_visible_range(pmf, result.grid.edges, SHOWN_TAIL) for pmf in result.pmf]
    ranges.append(_visible_range(result.start.grainsize(), result.start.grid.edges, SHOWN_TAIL))
    low, high = min(low for low, _ in ranges), max(high for _, high in ranges)
    right.set(xlim=(low, high), ylim=(low, high))  # the range of all loads, so that their pictures compare
    return figure

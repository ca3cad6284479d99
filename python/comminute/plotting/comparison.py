"""The paper's plots of states and curves, lattice against continuum (Figs. 6 to 9)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure, SubFigure

from comminute._core import Fabric, Material
from comminute.gradings.curves import SizeCurve
from comminute.lattice.comparison import Comparison, compare
from comminute.plotting.marginals import draw_marginals
from comminute.plotting.paper import CONTOURS, DENSITY_COLOURS, RED, figure_size, zone_edge
from comminute.plotting.style import Picture, log_size_label, new_axes, size_label
from comminute.runs.remarks import load_text
from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from comminute.runs.results import Floats, LatticeData, ResultData

MARKERS = "osD^"
DENSITIES = (1e-3, 10.0)
HEAVY = 0.05  # share of the mass above which a cell is circled, since a single cell is hard to see in print
NARROW = 120.0  # mm of width, below which states are stacked in two columns


def plot_state(
    fabric: Fabric,
    ax: Axes | None = None,
    *,
    material: Material | None = None,
    stress_ratio: float | None = None,
    limits: tuple[float, float] | None = None,
    marginals: bool = False,
    unit: str = "",
) -> Axes:
    """Joint density of log grainsize and log neighbourhood grainsize, and the edge of the crush zone (Fig. 6).

    Exact sizes are drawn in their bins, so that a lattice's histogram and a continuum state look alike where
    they are alike. Cells that hold more than a twentieth of the mass are circled, the area as their mass.

    Parameters
    ----------
    fabric : Fabric
    ax : matplotlib Axes, optional
    material : Material, optional
        Material whose crush zone is drawn: the edge inside which one of the two sizes crushes under the load.
    stress_ratio : float, optional
        Load of the crush zone. Left out: the load at which the fabric is at rest.
    limits : (float, float), optional
        Ends of both axes, in log size. Left out: the whole grid.
    marginals : bool
        Whether the densities of both sizes are drawn on the sides.
    unit : str
        Unit of the sizes, for the labels.

    Returns
    -------
    matplotlib Axes
        Axes whose first collection is the mesh, for a colour bar.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_state
    >>> fabric = cm.mixed_fabric(cm.power_law(2.5, 1e-2, 1.0), cm.LogGrid(-6, 0.1, 60))
    >>> density = plot_state(fabric).collections[0].get_array()
    >>> bool(abs(density.max() * fabric.grid.spacing**2 - fabric.probability.max()) < 1e-15)
    True
    """
    ax = new_axes() if ax is None else ax
    grid = fabric.grid
    mass = fabric.binned().probability
    density = np.ma.masked_less(mass.T / grid.spacing**2, DENSITIES[0])
    ax.pcolormesh(grid.edges, grid.edges, density, norm=LogNorm(*DENSITIES), cmap=DENSITY_COLOURS, rasterized=True)
    heavy = np.argwhere(mass > HEAVY)
    if heavy.size:
        psi, psibar = grid.centres[heavy.T]
        area = 120.0 * mass[tuple(heavy.T)]
        ax.scatter(psi, psibar, s=area, facecolors="none", edgecolors="k", lw=0.6, zorder=3)
    load = fabric.settled_at if stress_ratio is None else stress_ratio
    if material is not None and load:
        psi, psibar = zone_edge(material, load, grid.edges[-1] + 1.0)
        above = psi >= psibar  # the larger of the two crushes: half of each edge is the edge of the pair's zone
        ax.plot(psi[above], psibar[above], color=RED, lw=0.7)
        ax.plot(psibar[above], psi[above], color=RED, lw=0.7)
    ends = limits or (grid.edges[0], grid.edges[-1])
    ax.set(
        xlim=ends,
        ylim=ends,
        xlabel=log_size_label(r"\psi", "s", unit),
        ylabel=log_size_label(r"\bar\psi", r"\bar s", unit),
    )
    ax.set_box_aspect(1)
    if marginals:
        draw_marginals(ax, fabric, colour=DENSITY_COLOURS(0.7), width=0.2, stems=False)
    return ax


def plot_evolution(
    lattice: ResultData,
    continuum: ResultData,
    axes: Any = None,
    *,
    resolved: ResultData | None = None,
    loads: Sequence[int] | None = None,
    limits: tuple[float, float] | None = None,
    bar: Literal["right", "bottom"] = "right",
) -> Any:
    r"""States of the lattice above and of the continuum below, side by side over the loads (Figs. 7a to 9a).

    Parameters
    ----------
    lattice, continuum : Result
        Runs under the same loads whose fabrics were kept.
    axes : ndarray (2, K) or (3, K) of matplotlib Axes, optional
        Axes for the lattice, below them for the continuum, and then for the resolved closure, where it is given.
    resolved : ResolvedResult, optional
        Run by the resolved closure under the same loads, for a third row.
    loads : sequence of int, optional
        Indices of the K loads. Left out: all.
    limits : (float, float), optional
        Ends of all axes, in log size.
    bar : {"right", "bottom"}
        Side of the colour bar.

    Returns
    -------
    ndarray (2, K) or (3, K) of matplotlib Axes

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_evolution
    >>> continuum = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[2, 8])
    >>> lattice = cm.Lattice(10_000, cm.Material(), cm.gap_graded(1.0, 0.1))
    >>> axes = plot_evolution(lattice.run(stress_ratio=[2, 8], grid=continuum.grid), continuum)
    >>> axes.shape, axes[0, 0].get_title()
    ((2, 2), 'lattice\n$\\sigma^*$ = 2')
    """
    chosen = list(range(lattice.stress_ratio.size) if loads is None else loads)
    rows = _rows(lattice, continuum, resolved)
    if axes is None:
        size = figure_size(20.0 + 40.0 * len(chosen), 45.0 * len(rows))
        axes = Picture(figsize=size, layout="constrained").subplots(
            len(rows), len(chosen), sharex=True, sharey=True, squeeze=False
        )
    for row, (name, result) in enumerate(rows.items()):
        for k, ax in zip(chosen, axes[row], strict=True):
            load = float(result.stress_ratio[k])
            state = result.fabric(k)
            plot_state(state, ax, material=result.material, stress_ratio=load, limits=limits, unit=result.unit)
            ax.set_title(f"{name}\n" + rf"$\sigma^*$ = {load_text(load)}")
            ax.label_outer()
    axes[0, 0].figure.colorbar(
        axes[0, 0].collections[0], ax=list(axes.flat), location=bar, label="density of mass", extend="both", aspect=35
    )
    return axes


def _rows(lattice: ResultData, continuum: ResultData, resolved: ResultData | None) -> dict[str, ResultData]:
    """Name each run as its row is named."""
    rows = {"lattice": lattice, "continuum": continuum}
    return rows if resolved is None else rows | {"resolved": resolved}


def _draw_curve(ax: Axes, curve: SizeCurve, **style: Any) -> None:
    ax.plot(curve.size, curve.finer, **style)


def plot_cdf_families(result: ResultData, ax: Axes | None = None, *, behind: ResultData | None = None) -> Axes:
    """Mass finer against log size, a curve for each load and the start dashed (Figs. 7b, 7c to 9b, 9c).

    Parameters
    ----------
    result : Result
        Result of the continuum or of a lattice.
    ax : matplotlib Axes, optional
    behind : Result, optional
        A second family, drawn dotted in black, to see where the two part.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_cdf_families
    >>> result = cm.Simulation(cm.Material(), cm.power_law(2.5, 1e-3, 1.0)).run(stress_ratio=[2, 8])
    >>> [line.get_label() for line in plot_cdf_families(result).lines]
    ['start', '2', '8']
    """
    ax = new_axes() if ax is None else ax
    _draw_curve(ax, result.start_curve, color="k", ls="--", lw=0.9, label="start")
    colours = mpl.colormaps["viridis"](np.linspace(0.92, 0.0, result.stress_ratio.size))
    for k, load in enumerate(result.stress_ratio):
        _draw_curve(ax, result.curve(k), color=colours[k], label=load_text(load))
        if behind is not None:
            _draw_curve(ax, behind.curve(k), color="k", ls=":", lw=0.7, label="_behind")
    low = np.searchsorted(result.cdf[-1], 2e-3)
    largest = result.edge_size[np.searchsorted(result.cdf[0], 1.0 - 1e-9, side="left").clip(max=result.psi.size - 1)]
    ax.set(xscale="log", xlim=(result.edge_size[low], largest * 1.1), ylim=(0.0, 1.02))
    ax.set(xlabel=size_label("grainsize $s$", result.unit), ylabel="mass fraction finer")
    ax.grid(alpha=0.3, lw=0.4)
    ax.legend(title=r"stress ratio $\sigma^*$", loc="upper left")
    return ax


def plot_comparison(
    lattice: LatticeData,
    continuum: ResultData,
    figure: Figure | SubFigure | None = None,
    *,
    resolved: ResultData | None = None,
    loads: Sequence[int] | None = None,
    limits: tuple[float, float] | None = None,
) -> Figure | SubFigure:
    r"""States and curves of lattice and continuum, and how far the curves are apart (Figs. 7 to 9).

    Parameters
    ----------
    lattice : LatticeResult
    continuum : Result
        Result on the same grid and under the same loads.
    figure : matplotlib Figure, optional
        Figure to draw on; narrower than 120 mm, the states stand in columns, lattice left and continuum right.
    resolved : ResolvedResult, optional
        Run by the resolved closure under the same loads, for a third row of states and a third family of curves. Its
        distance is read at the bin edges that it shares with the lattice, so ask for some of these as its `sizes`.
    loads : sequence of int, optional
        Indices of the loads whose states are drawn. Left out: all.
    limits : (float, float), optional
        Ends of the axes of the states, in log size.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_comparison
    >>> continuum = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[2, 8])
    >>> lattice = cm.Lattice(10_000, cm.Material(), cm.gap_graded(1.0, 0.1))
    >>> figure = plot_comparison(lattice.run(stress_ratio=[2, 8], grid=continuum.grid), continuum)
    >>> [part.axes[0].get_title() for part in figure.subfigs]
    ['lattice\n$\\sigma^*$ = 2', 'lattice']
    """
    count = lattice.stress_ratio.size if loads is None else len(loads)
    rows = _rows(lattice, continuum, resolved)
    if figure is None:
        figure = Picture(figsize=figure_size(170.0, 75.0 + 45.0 * len(rows)), layout="constrained")
    narrow = figure.bbox.width / figure.get_dpi() * 25.4 < NARROW
    parts: Any = figure.subfigures(2, 1, height_ratios=(1.8 if narrow else 0.625 * len(rows), 1.0))
    states, curves = parts
    shape = (count, len(rows)) if narrow else (len(rows), count)
    axes = states.subplots(*shape, sharex=True, sharey=True, squeeze=False)
    plot_evolution(
        lattice,
        continuum,
        axes.T if narrow else axes,
        resolved=resolved,
        loads=loads,
        limits=limits,
        bar="bottom" if narrow else "right",
    )
    left, *others = curves.subplots(1, len(rows), sharex=True, sharey=True)
    plot_cdf_families(lattice, left).set_title("lattice")
    if narrow and resolved is not None:  # three panels leave no room for a legend in one of them, nor for three labels
        legend = left.get_legend()
        names = [text.get_text() for text in legend.get_texts()]
        curves.legend(
            legend.get_lines(), names, title=legend.get_title().get_text(), loc="outside lower center", ncols=3
        )
        legend.remove()
        left.set_xlabel(f"$s$ ({lattice.unit})" if lattice.unit else "$s$")
    for ax, (name, run) in zip(others, list(rows.items())[1:], strict=True):
        plot_cdf_families(run, ax, behind=lattice).set_title(name)
        ax.get_legend().remove()
        ax.label_outer()
        distance = compare(run, lattice).distance if run is continuum else _distance_at_shared_edges(run, lattice)
        far = int(np.argmax(distance))
        said = (
            f"dotted: lattice\n{distance[far]:.2g} apart\n" + rf"at $\sigma^*$ = {load_text(lattice.stress_ratio[far])}"
        )
        ax.text(0.04, 0.95, said, transform=ax.transAxes, va="top", fontsize="small")
        if narrow and resolved is not None:
            ax.set_xlabel(left.get_xlabel())
    return figure


def _distance_at_shared_edges(run: ResultData, lattice: LatticeData) -> Floats:
    """(T,) largest difference of the curves at sizes at which both runs know how much is finer."""
    ours, theirs = np.nonzero(np.isclose(run.edge_size[:, None], lattice.edge_size[None, :], rtol=1e-9, atol=0.0))
    if ours.size == 0:
        rule = "ask for some of the lattice's edge_size as sizes of the Simulation"
        raise parameter_error("resolved", subject="its bins", finding="share no edge with the lattice's", rule=rule)
    return np.asarray(np.abs(run.cdf[:, ours] - lattice.cdf[:, theirs]).max(axis=1))


def plot_distances(comparisons: dict[str, Comparison], ax: Axes | None = None) -> Axes:
    """CDF distance of continuum and lattice over the load, with two standard errors, one line per start.

    Parameters
    ----------
    comparisons : dict of str to Comparison
        Comparisons by name of the start.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_distances
    >>> continuum = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[2, 8])
    >>> lattice = cm.Lattice(10_000, cm.Material(), cm.gap_graded(1.0, 0.1), replicas=3)
    >>> found = cm.compare(continuum, lattice.run(stress_ratio=[2, 8], grid=continuum.grid))
    >>> plot_distances({"gap-graded": found}).get_ylabel()
    'largest CDF distance'
    """
    ax = new_axes() if ax is None else ax
    for k, (name, found) in enumerate(comparisons.items()):
        colour, style = CONTOURS[k % len(CONTOURS)]
        marker = MARKERS[k % len(MARKERS)]
        look: dict[str, Any] = {"color": colour, "ls": style, "marker": marker, "ms": 3, "capsize": 2}
        ax.errorbar(found.stress_ratio, found.distance, 2.0 * found.standard_error, label=name, **look)
    ax.set(xscale="log", xlabel=r"stress ratio $\sigma^*$", ylabel="largest CDF distance")
    ax.set_ylim(bottom=0.0)
    ax.grid(alpha=0.3, lw=0.4)
    ax.legend()
    return ax

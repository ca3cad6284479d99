"""The paper's plots of when a grain crushes and where its fragments go (Figs. 3 to 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.colors import ListedColormap, LogNorm

from comminute._core import LogGrid, Material, Zone, cell_kernel, crush_zones, logspace_load
from comminute.plotting.style import log_size_label, new_axes, size_label
from comminute.runs.remarks import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from comminute.runs.results import Floats
    from comminute.util.choices import Scheme

# Okabe and Ito's palette, which readers with any colour vision can tell apart; line styles differ as well.
BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"
CONTOURS = [(BLUE, "-"), (ORANGE, "--"), (GREEN, "-."), (RED, ":")]
ZONE_FILLS = {Zone.REST: "#ffffff", Zone.NEIGHBOUR: "#f6c9a8", Zone.GRAIN: "#a6cfe8", Zone.BOTH: "#c9bfd3"}
ZONE_NAMES = {Zone.REST: "00", Zone.NEIGHBOUR: "01", Zone.GRAIN: "10", Zone.BOTH: "11"}
DENSITY_COLOURS = ListedColormap(mpl.colormaps["Blues"](np.linspace(0.18, 1.0, 256)), "density")

# Settings (matplotlib rcParams) for figures that are drawn at their printed size.
PRINT_STYLE: dict[Any, float] = {
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.title_fontsize": 6.5,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "savefig.dpi": 300,
}


def figure_size(width: float, height: float) -> tuple[float, float]:
    """Width and height in inches, as matplotlib takes them, of a figure given in millimetres.

    Parameters
    ----------
    width, height : float
        Size in mm; a column of a journal is about 85 mm wide, a page 170 mm.

    Returns
    -------
    (float, float)

    Examples
    --------
    >>> from comminute.plotting.paper import figure_size
    >>> figure_size(254, 127)
    (10.0, 5.0)
    """
    return width / 25.4, height / 25.4


def zone_edge(material: Material, stress_ratio: float, psi_max: float, *, points: int = 2001) -> tuple[Floats, Floats]:
    """Curve g(psi, psibar) = g*, on whose inner side a grain of log size psi crushes (Eq. 15).

    Parameters
    ----------
    material : Material
    stress_ratio : float
        Load, > 0.
    psi_max : float
        Log size at which the curve ends.
    points : int
        Number of points along the curve; the middle one is the tip, where both sizes are equal.

    Returns
    -------
    psi, psibar : ndarray (points,)
        Curve from the end with the larger neighbourhood to the one with the smaller; empty where the load
        crushes nothing up to psi_max.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting.paper import zone_edge
    >>> material = cm.Material()
    >>> psi, psibar = zone_edge(material, 8.0, 0.0)
    >>> bool(abs(cm.stress_function(material, psi, psibar) - cm.logspace_load(material, 8.0)).max() < 1e-15)
    True
    """
    tip = math.log(material.reference_size) - material.weibull_modulus / 3.0 * math.log(stress_ratio)
    if tip > psi_max:
        return np.empty(0), np.empty(0)
    if math.isinf(material.k):  # without fabric the size alone decides
        return np.full(points, tip), np.linspace(psi_max, 2.0 * tip - psi_max, points)
    # (psi - psibar)^2 - k psi = g*, solved for psi by the difference: smooth through the tip, unlike a root in psi
    load = float(logspace_load(material, stress_ratio))
    widest = math.sqrt(max(load + material.k * psi_max, 0.0))
    difference = np.linspace(-widest, widest, points)
    psi = (difference**2 - load) / material.k
    return psi, psi - difference


def plot_stress_contours(
    material: Material,
    stress_ratio: float | Sequence[float],
    ax: Axes | None = None,
    *,
    log_sizes: bool = False,
    limits: tuple[float, float] | None = None,
    unit: str = "",
) -> Axes:
    """Contours of the stress function: which grains crush first at which load (Fig. 3).

    Parameters
    ----------
    material : Material
    stress_ratio : float or sequence
        Load of each contour; a grain crushes at that load on the inner side, where its neighbours are as large as it.
    ax : matplotlib Axes, optional
    log_sizes : bool
        Whether the axes are log sizes instead of sizes.
    limits : (float, float), optional
        Ends of both axes. Left out: up to the reference size.
    unit : str
        Unit of the sizes, for the labels.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_stress_contours
    >>> ax = plot_stress_contours(cm.Material(), [2, 8, 10_000], log_sizes=True)
    >>> [line.get_label() for line in ax.lines[1:]]
    ['2', '8', '10000']
    """
    ax = new_axes() if ax is None else ax
    largest = material.reference_size
    if limits is None:
        limits = (math.log(largest) - 6.0, math.log(largest)) if log_sizes else (0.0, largest)
    ends = limits if log_sizes else (-math.inf, math.log(limits[1]))
    ax.plot(limits, limits, color="0.6", lw=0.6, zorder=1)
    loads = [stress_ratio] if isinstance(stress_ratio, int | float) else stress_ratio
    for k, load in enumerate(loads):
        psi, psibar = zone_edge(material, float(load), ends[1] + 0.5)
        colour, style = CONTOURS[k % len(CONTOURS)]
        x, y = (psi, psibar) if log_sizes else (np.exp(psi), np.exp(psibar))
        ax.plot(x, y, color=colour, ls=style, label=load_text(load))
    names = [("grainsize", r"\psi", "s"), ("neighbourhood grainsize", r"\bar\psi", r"\bar s")]
    labels = [
        f"{name} {log_size_label(log, size, unit)}"
        if log_sizes
        else size_label(f"{name} ${size}$", unit).replace(" (unit", "\n(unit")  # too long for one line
        for name, log, size in names
    ]
    ax.set(xlim=limits, ylim=limits, xlabel=labels[0], ylabel=labels[1])
    ax.set_box_aspect(1)
    ax.legend(title=r"stress ratio $\sigma^*$", loc="upper left", handlelength=2.4)
    return ax


def plot_zones(grid: LogGrid, material: Material, stress_ratio: float, ax: Axes | None = None) -> Axes:
    """Map of the four crush zones with their edges (Fig. 4).

    Parameters
    ----------
    grid : LogGrid
        Grid whose cells are coloured by `crush_zones`, centre by centre.
    material : Material
    stress_ratio : float
        Load.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_zones
    >>> ax = plot_zones(cm.LogGrid(-4, 1, 100), cm.Material(fabric_width=1.2), 8.0)
    >>> sorted(text.get_text() for text in ax.texts)
    ['$A_{00}$', '$A_{01}$', '$A_{10}$', '$A_{11}$']
    """
    ax = new_axes() if ax is None else ax
    zones = crush_zones(grid, material, stress_ratio)
    fills = ListedColormap([ZONE_FILLS[zone] for zone in Zone])
    ax.pcolormesh(grid.edges, grid.edges, zones.T, cmap=fills, vmin=-0.5, vmax=3.5, rasterized=True)
    psi, psibar = zone_edge(material, stress_ratio, grid.edges[-1] + 2.0)
    ax.plot(psi, psibar, color=BLUE, label="grain crushes inside")
    ax.plot(psibar, psi, color=RED, ls="--", label="neighbour crushes inside")
    for zone, name in ZONE_NAMES.items():
        place = _roomiest(zones == zone)
        if place is not None:
            x, y = grid.centres[list(place)]
            ax.text(x, y, f"$A_{{{name}}}$", ha="center", va="center", fontsize="large")
    ends = (grid.edges[0], grid.edges[-1])
    ax.set(xlim=ends, ylim=ends, xlabel=r"log grainsize $\psi$", ylabel=r"log neighbourhood grainsize $\bar\psi$")
    ax.set_box_aspect(1)
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), handlelength=2.4, frameon=False)  # above, clear of the zones
    return ax


def _roomiest(inside: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> tuple[int, int] | None:
    """Cell of a zone that is farthest from all other cells and the border, where a label fits best."""
    stride = max(inside.shape[0] // 48, 1)  # a coarse look is enough for a label
    coarse = np.pad(inside[stride // 2 :: stride, stride // 2 :: stride], 1)
    own, other = np.argwhere(coarse), np.argwhere(~coarse)
    if own.size == 0:
        return None
    distance = ((own[:, None, :] - other[None, :, :]) ** 2).sum(axis=2).min(axis=1)
    i, j = (own[int(np.argmax(distance))] - 1) * stride + stride // 2
    return int(i), int(j)


def plot_fragment_kernel(
    grid: LogGrid,
    material: Material,
    stress_ratio: float,
    i: int,
    j: int,
    ax: Axes | None = None,
    *,
    kind: Literal["exact", "slow", "fast"] = "exact",
    limits: tuple[float, float] | None = None,
    decades: float = 2.0,
    scheme: Scheme = "conservative",
) -> Axes:
    """Places that the mass of one cell goes to in one step (Fig. 5, which has the paper's scheme).

    Parameters
    ----------
    grid : LogGrid
    material : Material
    stress_ratio : float
        Load.
    i, j : int
        Cell of psi and psibar from which the fragments come, marked with a cross.
    ax : matplotlib Axes, optional
    kind : {"exact", "slow", "fast"}
        Kernel: Eq. 59, 63 or 68.
    limits : (float, float), optional
        Ends of both axes. Left out: the whole grid, with the fines bin that gathers all that is finer.
    decades : float
        Decades that the colours cover below the cell that receives most.
    scheme : {"conservative", "paper"}
        Fragments on the grid, as in `cell_kernel`.

    Returns
    -------
    matplotlib Axes
        Axes whose first collection is the mesh, for a colour bar.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.plotting import plot_fragment_kernel
    >>> ax = plot_fragment_kernel(cm.LogGrid(-4, 1, 40), cm.Material(fabric_width=1.2), 8.0, 33, 14)
    >>> ax.get_title()
    'from zone 10'
    """
    ax = new_axes() if ax is None else ax
    kernel = cell_kernel(grid, material, stress_ratio, i, j, kind, scheme=scheme)
    share = np.ma.masked_less(kernel.T / kernel.max(), 10.0**-decades)
    ax.pcolormesh(
        grid.edges, grid.edges, share, norm=LogNorm(10.0**-decades, 1.0), cmap=DENSITY_COLOURS, rasterized=True
    )
    psi, psibar = zone_edge(material, stress_ratio, grid.edges[-1] + 2.0)
    ax.plot(psi, psibar, color=BLUE, lw=0.7)
    ax.plot(psibar, psi, color=RED, ls="--", lw=0.7)
    ax.plot(grid.centres[i], grid.centres[j], "kx", ms=5.0, mew=1.2)
    zone = Zone(crush_zones(grid, material, stress_ratio)[i, j])
    ends = limits or (grid.edges[0], grid.edges[-1])
    ax.set(xlim=ends, ylim=ends, xlabel=r"$\psi$", ylabel=r"$\bar\psi$", title=f"from zone {ZONE_NAMES[zone]}")
    ax.set_box_aspect(1)
    return ax

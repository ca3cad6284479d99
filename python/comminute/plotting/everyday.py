"""Grading curves on the axes of each trade, and indices against stress. Needs matplotlib."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FixedLocator, FuncFormatter, LogLocator, NullFormatter

from comminute._core import Grading
from comminute.gradings.breakage import EINAV_DIMENSION
from comminute.gradings.curves import SizeCurve
from comminute.gradings.indices import phi as phi_of
from comminute.gradings.named import ALIASES, LABELS, named_index
from comminute.plotting.style import LOAD_COLOURS, new_axes, size_label
from comminute.runs.remarks import load_labels
from comminute.runs.results import Floats, ResultData
from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from matplotlib.axes import Axes

AxesKind = Literal["semilog", "loglog", "rosin-rammler"]
GUIDE_COLOUR = "#888888"
PROBABILITIES = (0.1, 1, 5, 10, 20, 36.8, 63.2, 90, 99.9)
LABEL_WIDTH = 0.45  # inches that the label of a size may take
LEGEND_LOADS = 10
SHOWN = 1e-3  # share of the mass below which the size axis may end


def plot_curves(
    gradings: ResultData | Grading | SizeCurve | Mapping[str, Grading | SizeCurve],
    ax: Axes | None = None,
    *,
    axes: AxesKind = "semilog",
    coarse_left: bool = False,
    phi: bool = False,
    guide: bool = True,
) -> Axes:
    """Per cent finer against size: a result's start and loads, one grading, or several by name.

    Parameters
    ----------
    gradings : Result, Grading, SizeCurve, or mapping of str to the latter two
        Gradings in one unit.
    ax : matplotlib Axes, optional
    axes : {"semilog", "loglog", "rosin-rammler"}
        Per cent finer plain, on a log scale, or as ln(-ln(1 - F)), on which a Rosin-Rammler law is a
        straight line.
    coarse_left : bool
        Whether sizes fall rightwards.
    phi : bool
        Whether sizes are drawn as -log2(d / mm), on a linear scale, with the coarse ones left.
    guide : bool
        Whether log-log axes have a line with the slope of fractal dimension 2.6.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    ParameterError
        For two units, axes it does not know, or phi of sizes without a unit.
    """
    if axes not in ("semilog", "loglog", "rosin-rammler"):
        raise parameter_error("axes", f"'{axes}'", "it must be one of 'semilog', 'loglog', 'rosin-rammler'")
    curves = _curves(gradings)
    units = {curve.unit for curve, _ in curves.values()}
    if len(units) > 1:
        finding = f"are in {', '.join(sorted(units))}"
        raise parameter_error("gradings", subject="the gradings", finding=finding, remedy="use_one_unit")
    ax = new_axes() if ax is None else ax
    unit = units.pop()
    for name, (curve, own_style) in curves.items():

        def draw(size: Floats, finer: Floats, **style: Any) -> Line2D:
            x = phi_of(size, unit) if phi else size
            y = 100.0 * finer if axes != "rosin-rammler" else _weibull_scale(finer)
            inside = np.isfinite(y) & (finer > 0.0 if axes == "loglog" else True)
            (line,) = ax.plot(x[inside], y[inside], **style)
            return line

        line = draw(curve.size, curve.finer, **{"label": name} | own_style)
        draw(*_tail(curve), **own_style | {"color": line.get_color(), "marker": "", "ls": ":", "label": ""})
    low, high = _size_range([curve for curve, _ in curves.values()])
    _size_axis(ax, low, high, unit, phi=phi, coarse_left=coarse_left)
    _share_axis(ax, axes)
    if axes == "loglog" and guide:
        _draw_guide(ax, low, high, unit, phi=phi)
    ax.grid(alpha=0.3, lw=0.5)
    if len(curves) > 1 or (axes == "loglog" and guide):
        title = load_labels(gradings)[0] if isinstance(gradings, ResultData) else ""
        falling = phi or coarse_left
        place = ("lower " if axes == "loglog" else "upper ") + ("right" if falling != (axes == "loglog") else "left")
        options: dict[str, Any] = {"title": title, "fontsize": "small", "loc": place}
        legend = ax.legend(**options)
        legend.get_title().set_fontsize("small")
    return ax


def _curves(gradings: Any) -> dict[str, tuple[SizeCurve, dict[str, Any]]]:
    """Curves by name, each with its line style."""
    if isinstance(gradings, ResultData):
        count = gradings.stress_ratio.size
        found = {"start": (gradings.start_curve, {"color": "k", "ls": "--", "lw": 1.2, "zorder": 3})}
        every = math.ceil(count / LEGEND_LOADS)
        for k, name in enumerate(load_labels(gradings)[1]):
            colour = LOAD_COLOURS(0.92 * (1 - k / max(count - 1, 1)))
            style = {"color": colour, "lw": 1.4}
            if (count - 1 - k) % every:
                style["label"] = ""  # so many names would hide the curves; the colours go evenly from first to last
            found[name] = (gradings.curve(k), style)
        return found
    named = gradings if isinstance(gradings, dict) else {"": gradings}
    marks = {name: "o" if isinstance(g, Grading) and "sieves" in repr(g) else "" for name, g in named.items()}
    return {
        name: (SizeCurve.of(grading), {"lw": 1.4, "marker": marks[name], "ms": 4}) for name, grading in named.items()
    }


def _tail(curve: SizeCurve) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Points of the assumed tail below the finest point; none where the curve ends."""
    if not (curve.finer[0] > 0.0 and curve.tail_slope > 0.0):
        return np.array([]), np.array([])
    size = curve.size[0] * np.geomspace(1e-3, 1.0, 40)
    return size, curve.finer_than(size)


def _weibull_scale(finer: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(-np.log1p(-np.minimum(finer, 1.0))))


def _size_range(curves: list[SizeCurve]) -> tuple[float, float]:
    """Sizes between which all but a thousandth of the mass of each curve lies, with a little air."""
    highs = [float(curve.size[-1]) for curve in curves]
    lows = []
    for curve in curves:
        shown = curve.size[curve.finer > SHOWN]
        lows.append(float(shown[0]) if curve.finer[0] <= SHOWN else float(curve.size[0]) / 3.0)
    low, high = min(lows), max(highs)
    air = max((high / low) ** 0.04, 1.05)
    return low / air, high * air


def _size_axis(ax: Axes, low: float, high: float, unit: str, *, phi: bool, coarse_left: bool) -> None:
    if phi:
        ends = phi_of(np.array([high, low]), unit)
        ax.set(xlim=tuple(ends), xlabel=r"grainsize ($\varphi$ = $-$log$_2$ d / mm)")
        return
    ax.set(xscale="log", xlim=(high, low) if coarse_left else (low, high), xlabel=size_label("grainsize", unit))
    _log_ticks(ax, low, high)


def _log_ticks(ax: Axes, low: float, high: float) -> None:
    """Label as many of 1, 2, 5 and the decades of a logarithmic abscissa as there is room for."""
    room = ax.get_window_extent().width / ax.get_figure(root=True).dpi / LABEL_WIDTH  # type: ignore[union-attr]
    decades = math.log10(high / low)
    if 3.0 * decades < room:
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    if decades < room and high < 1e5:  # else powers of ten are shorter
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def _share_axis(ax: Axes, axes: AxesKind) -> None:
    if axes == "loglog":
        ax.set(yscale="log", ylim=(0.1, 130), ylabel="per cent finer by mass")
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    elif axes == "rosin-rammler":
        at = _weibull_scale(np.divide(PROBABILITIES, 100.0))
        ax.yaxis.set_major_locator(FixedLocator(list(at)))
        ax.yaxis.set_major_formatter(FixedFormatter([f"{p:g}" for p in PROBABILITIES]))
        ax.set(ylim=(at[0], at[-1]), ylabel="per cent finer (Rosin-Rammler scale)")
    else:
        ax.set(ylim=(0, 102), ylabel="per cent finer by mass")


def _draw_guide(ax: Axes, low: float, high: float, unit: str, *, phi: bool) -> None:
    """Line of slope 3 - 2.6 through 100 % at the coarse end."""
    size = np.array([low, high])
    finer = 100.0 * (size / high) ** (3.0 - EINAV_DIMENSION)
    x = phi_of(size, unit) if phi else size
    ax.plot(x, finer, color=GUIDE_COLOUR, ls=":", lw=1.2, label=rf"$\alpha$ = {EINAV_DIMENSION:g}")


def plot_index(
    result: ResultData, index: str | Callable[[SizeCurve], float] = "D50", ax: Axes | None = None, **options: Any
) -> Axes:
    """Draw an index after each load against stress, or stress ratio where no stress is known.

    Parameters
    ----------
    result : Result
    index : str or callable
        A size such as "D50", "Cu", "Cc", "B" (Einav), "Br" (Hardin), "crushes", "fines", or a function of a
        `SizeCurve`.
    ax : matplotlib Axes, optional
    **options
        Options of the line, as matplotlib takes them.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    ParameterError
        For an index it does not know, or one that a curve does not have.
    """
    ax = new_axes() if ax is None else ax
    label, values = _index_values(result, index)
    loads = result.stress if result.stress is not None else result.stress_ratio
    style: dict[str, Any] = {"marker": "o", "ms": 4, "lw": 1.4, "color": "#33638d"} | options
    ax.plot(loads, values, **style)
    scale = "log" if loads.min() > 0.0 and loads.max() > 10.0 * loads.min() else "linear"
    ax.set(xscale=scale, xlabel=_load_label(result), ylabel=label)
    if scale == "log":
        _log_ticks(ax, float(loads.min()), float(loads.max()))
    if label.startswith(("D", "Cu")) and values.min() > 0.0 and values.max() > 10.0 * values.min():
        ax.set_yscale("log")
    ax.grid(alpha=0.3, lw=0.5)
    return ax


def _load_label(result: ResultData) -> str:
    quantity, _ = load_labels(result)
    return "stress (unit of the first crush stress)" if quantity == "stress" else quantity


def _index_values(result: ResultData, index: str | Callable[[SizeCurve], float]) -> tuple[str, np.ndarray[Any, Any]]:
    if callable(index):
        label, make = getattr(index, "__name__", "index"), index
    elif index in ("crushes", "fines"):
        names = {"crushes": "mean number of crushes", "fines": "share in the fines bin"}
        return names[index], np.asarray(getattr(result, index))
    else:
        make = named_index(index, result.start_curve)
        label = LABELS.get(ALIASES.get(index, index)) or size_label(index.upper(), result.unit)
    return label, np.array([make(result.curve(k)) for k in range(result.stress_ratio.size)])

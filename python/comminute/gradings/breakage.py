"""Breakage between two gradings, and the fractal dimension of one.

Every function takes a `Grading` or a `SizeCurve` (`result.curve(k)`); all measures are by mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from comminute._core import _breakage_potential, _mean_log
from comminute.gradings.curves import SizeCurve, mean_power
from comminute.gradings.indices import Curve
from comminute.gradings.sieves import millimetres
from comminute.util.errors import parameter_error

HARDIN_SILT = 0.074  # [mm] size below which grains break no further in Hardin's sense
EINAV_DIMENSION = 2.6  # default fractal dimension of the ultimate grading


def relative_breakage(before: Curve, after: Curve) -> float:
    """Hardin's relative breakage B_r = (B_p0 - B_p) / B_p0.

    B_p is the integral of b_p dF, where b_p = log10(D / 0.074 mm) above 0.074 mm and 0 below. It is exact
    for curves that are linear in ln D between points.

    Parameters
    ----------
    before, after : Grading or SizeCurve
        Gradings whose sizes have a unit, since 0.074 mm is a size; the two units may differ.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        For sizes without a unit, and if all of `before` is below 0.074 mm.

    Notes
    -----
    B. O. Hardin, J. Geotech. Eng. 111 (1985) 1177.

    Examples
    --------
    >>> import comminute as cm
    >>> coarse, fine = (cm.Grading.from_sieves([2 * d, d], [100, 0]) for d in (7.4, 0.74))
    >>> round(1 / cm.relative_breakage(coarse, fine), 6)  # one decade of 2 + log10(2)/2
    2.150515
    """
    potential = [breakage_potential(curve) for curve in (before, after)]
    if not potential[0] > 0.0:
        raise parameter_error(
            "before",
            subject="all grains",
            finding="are below 0.074 mm before: B_p0 is 0 and the relative breakage has no meaning",
        )
    return (potential[0] - potential[1]) / potential[0]


def breakage_potential(curve: Curve) -> float:
    """Hardin's breakage potential B_p, the integral of b_p dF; see `relative_breakage`.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.breakage_potential(cm.monodisperse(7.4).with_unit("mm")), 12)
    2.0
    """
    points = SizeCurve.of(curve)
    return _breakage_potential(points.numbers, silt_size(points.unit))


def silt_size(unit: str) -> float:
    """Size below which grains break no further in Hardin's sense, in a unit.

    Raises
    ------
    ParameterError
        For sizes without a unit.
    """
    return HARDIN_SILT / millimetres(unit, "Hardin's breakage potential")


@dataclass(frozen=True)
class Breakage:
    """Einav's breakage index and grading index, with the ultimate grading they refer to."""

    index: float
    grading_index: float
    fractal_dimension: float
    smallest: float
    largest: float


def breakage_index(
    before: Curve,
    after: Curve,
    *,
    fractal_dimension: float = EINAV_DIMENSION,
    smallest: float = 0.0,
    largest: float | None = None,
) -> Breakage:
    """Einav's breakage index B and grading index theta against a power-law ultimate grading.

    B is the integral of (F - F_0) d ln d over that of (F_u - F_0) d ln d, and theta = 1 - <d**2>_u / <d**2>_0,
    with F_u = (d**(3-a) - d_m**(3-a)) / (d_M**(3-a) - d_m**(3-a)), a the fractal dimension. Both integrals run over
    all sizes. The model of this library has no ultimate grading: B may exceed 1.

    Parameters
    ----------
    before, after : Grading or SizeCurve
        Gradings with sizes in one unit.
    fractal_dimension : float
        Fractal dimension of the ultimate grading, below 3.
    smallest : float
        Smallest size d_m of the ultimate grading. With 0, the default, B depends on no grid and no finest sieve.
    largest : float, optional
        Largest size d_M of the ultimate grading; left out, it is the largest size of `before`.

    Returns
    -------
    Breakage
        Indices with the ultimate grading they refer to: d_m is its `smallest`, d_M its `largest`.

    Raises
    ------
    ParameterError
        For gradings in different units, sizes out of order, and a `before` that is no coarser than the ultimate
        grading.

    Notes
    -----
    I. Einav, J. Mech. Phys. Solids 55 (2007) 1274.

    Examples
    --------
    >>> import comminute as cm
    >>> start, ultimate = cm.monodisperse(1.0), cm.power_law(2.6, 0.0, 1.0)
    >>> cm.breakage_index(start, start).index, round(cm.breakage_index(start, ultimate).index, 6)
    (0.0, 1.0)
    """
    first, last = SizeCurve.of(before), SizeCurve.of(after)
    if first.unit != last.unit:
        finding = f"is in '{first.unit}' and after in '{last.unit}'"
        raise parameter_error("before", first.unit, finding=finding, remedy="use_one_unit")
    top = float(first.size[-1]) if largest is None else largest
    if not (0.0 <= smallest < top and math.isfinite(top)):
        finding = f"is {smallest:g} and largest is {top:g}"
        raise parameter_error("smallest", smallest, "it must hold 0 <= smallest < largest", finding=finding)
    power = 3.0 - fractal_dimension
    if not power > 0.0:
        raise parameter_error("fractal_dimension", fractal_dimension, "it must be less than 3")
    # integration by parts makes the integral of F d ln d up to ln(d_M) the mean of ln(d_M / d)
    start, end = mean_log(first), mean_log(last)
    ratio, ultimate = smallest / top, ultimate_mean_log(top, fractal_dimension, smallest)
    if not start > ultimate:
        raise parameter_error(
            "before",
            start,
            "the index needs a start that is coarser (a smaller fractal_dimension or a larger `largest`?)",
            finding=f"has a mean ln(size) of {start:g}, the ultimate grading one of {ultimate:g}",
        )
    square = power / (power + 2.0) * top**2 * (1.0 - ratio ** (power + 2.0)) / (1.0 - ratio**power)
    return Breakage(
        index=(start - end) / (start - ultimate),
        grading_index=1.0 - square / mean_square(first),
        fractal_dimension=fractal_dimension,
        smallest=smallest,
        largest=top,
    )


def ultimate_mean_log(largest: float, fractal_dimension: float = EINAV_DIMENSION, smallest: float = 0.0) -> float:
    """Mean of ln(size) by mass of the power law that `breakage_index` refers to.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.gradings.breakage import mean_log, ultimate_mean_log
    >>> round(ultimate_mean_log(1.0) - mean_log(cm.power_law(2.6, 0.0, 1.0)), 6)
    0.0
    """
    power, ratio = 3.0 - fractal_dimension, smallest / largest
    span = math.log(ratio) if ratio > 0.0 else 0.0
    return float(math.log(largest) - 1.0 / power - ratio**power * span / (1.0 - ratio**power))


def mean_log(curve: Curve) -> float:
    """Mean of ln(size) by mass.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.gradings.breakage import mean_log
    >>> round(mean_log(cm.gap_graded(100.0, 1.0)) / 2.302585092994, 9)
    1.0
    """
    points = SizeCurve.of(curve)
    mean = _mean_log(points.numbers)
    if math.isnan(mean):
        raise parameter_error(
            subject=f"{100 * points.finer[0]:.4g} %",
            finding=f"are finer than the finest size, {points.size[0]:.4g}, on a curve that is flat above it: "
            "no mean size can be read from it",
        )
    return mean


def mean_square(curve: Curve) -> float:
    """Mean of size**2 by mass, in the square of the curve's unit.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.gradings.breakage import mean_square
    >>> round(mean_square(cm.gap_graded(3.0, 1.0)), 12)
    5.0
    """
    points = SizeCurve.of(curve)
    tail = points.finer[0] * points.size[0] ** 2 * points.tail_slope / (points.tail_slope + 2.0)
    return float(np.sum(np.diff(points.finer) * mean_power(points.size, 2.0)) + tail)


@dataclass(frozen=True)
class FractalFit:
    """Fractal dimension with the window it was fitted in, the number of points and R squared."""

    dimension: float
    r_squared: float
    smallest: float
    largest: float
    points: int


def fractal_dimension(curve: Curve, smallest: float, largest: float) -> FractalFit:
    """Fractal dimension a = 3 - m, m the least-squares slope of ln F against ln d in a window of sizes.

    Parameters
    ----------
    curve : Grading or SizeCurve
    smallest, largest : float
        Ends of the window; the points of the curve between them are fitted.

    Returns
    -------
    FractalFit

    Raises
    ------
    ParameterError
        If the window holds fewer than three points with F > 0.

    Notes
    -----
    S. W. Tyler, S. W. Wheatcraft, Soil Sci. Soc. Am. J. 56 (1992) 362 (by mass).

    Examples
    --------
    >>> import comminute as cm
    >>> fit = cm.fractal_dimension(cm.power_law(2.5, 0.0, 1.0), 0.01, 0.1)
    >>> round(fit.dimension, 9), round(fit.r_squared, 9)
    (2.5, 1.0)
    """
    points = SizeCurve.of(curve)
    inside = (points.size >= smallest) & (points.size <= largest) & (points.finer > 0.0)
    count = np.unique(points.size[inside]).size
    if count < 3:
        raise parameter_error(
            "smallest",
            smallest,
            "it must hold at least 3",
            subject=f"the window {smallest:g} to {largest:g}",
            finding=f"holds {count} points of the curve",
        )
    x, y = np.log(points.size[inside]), np.log(points.finer[inside])
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y / (x @ x))
    total = float(y @ y)
    left = float(np.sum((y - slope * x) ** 2))
    return FractalFit(
        3.0 - slope, 1.0 - left / total if total > 0.0 else 1.0, float(smallest), float(largest), int(inside.sum())
    )

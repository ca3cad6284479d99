"""Indices of a grading curve in soil mechanics, sedimentology and milling.

Every function takes a `Grading` or a `SizeCurve` (`result.curve(k)`); all indices are by mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from comminute._core import Grading
from comminute.gradings.curves import Floats, SizeCurve
from comminute.gradings.sieves import millimetres
from comminute.util.choices import require_word
from comminute.util.errors import parameter_error

Curve = Grading | SizeCurve


def uniformity(curve: Curve, *, extrapolate: bool = False) -> float:
    """Coefficient of uniformity C_u = D60 / D10.

    Parameters
    ----------
    curve : Grading or SizeCurve
    extrapolate : bool
        Follow the tail below the finest sieve for D10.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        If D10 lies below the finest sieve.

    Notes
    -----
    ISO 14688-2; ASTM D2487.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.uniformity(cm.fuller(16.0)), 6)
    36.0
    """
    d10, d60 = _sizes(curve, (10.0, 60.0), extrapolate)
    return d60 / d10


def curvature(curve: Curve, *, extrapolate: bool = False) -> float:
    """Coefficient of curvature C_c = D30**2 / (D10 D60).

    Parameters
    ----------
    curve : Grading or SizeCurve
    extrapolate : bool
        Follow the tail below the finest sieve.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        If D10 or D30 lies below the finest sieve.

    Notes
    -----
    ISO 14688-2; ASTM D2487.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.curvature(cm.fuller(16.0)), 6)
    2.25
    """
    d10, d30, d60 = _sizes(curve, (10.0, 30.0, 60.0), extrapolate)
    return d30**2 / (d10 * d60)


@dataclass(frozen=True)
class FolkWard:
    """Graphic measures of Folk & Ward; `mean` in phi or in the unit of the curve, by `scale`."""

    mean: float
    sorting: float
    skewness: float
    kurtosis: float
    scale: str


def folk_ward(curve: Curve, *, scale: Literal["phi", "metric"] = "phi", extrapolate: bool = False) -> FolkWard:
    """Graphic mean, sorting, skewness and kurtosis.

    phi_x is the size in phi that x per cent of the mass are *coarser* than (phi_16 = -log2(D84 / mm)):

        mean      (phi_16 + phi_50 + phi_84) / 3
        sorting   (phi_84 - phi_16) / 4 + (phi_95 - phi_5) / 6.6
        skewness  (phi_16 + phi_84 - 2 phi_50) / (2 (phi_84 - phi_16)) + the same with phi_5, phi_95
        kurtosis  (phi_95 - phi_5) / (2.44 (phi_75 - phi_25))

    Parameters
    ----------
    curve : Grading or SizeCurve
    scale : {"phi", "metric"}
        "metric" takes -ln D in place of phi, which makes the mean a geometric mean in the unit of the curve and
        the sorting a ratio. A tail of fines has positive skewness on either scale.
    extrapolate : bool
        Follow the tail below the finest sieve for D5 and D16.

    Returns
    -------
    FolkWard

    Raises
    ------
    ParameterError
        If D5 lies below the finest sieve, if all percentiles fall on one size, or for phi of sizes without
        a known unit.

    Notes
    -----
    R. L. Folk, W. C. Ward, J. Sediment. Petrol. 27 (1957) 3; the metric form after S. J. Blott,
    K. Pye, GRADISTAT, Earth Surf. Process. Landforms 26 (2001) 1237.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.folk_ward(cm.Grading.from_sieves([4.0, 1.0], [100, 0], unit="mm")).mean, 9)
    -1.0
    """
    require_word("scale", scale, Literal["phi", "metric"])
    points = SizeCurve.of(curve)
    coarser = (5, 16, 25, 50, 75, 84, 95)
    sizes = np.array(_sizes(curve, tuple(100.0 - x for x in coarser), extrapolate))
    fineness = phi(sizes, points.unit) if scale == "phi" else -np.log(sizes)
    p5, p16, p25, p50, p75, p84, p95 = (float(x) for x in fineness)
    if not (p84 > p16 and p75 > p25):
        raise parameter_error("sorting", f"0: D25 and D75 are both {sizes[3]:g}", "skewness and kurtosis need a spread")
    mean = (p16 + p50 + p84) / 3.0
    sorting = (p84 - p16) / 4.0 + (p95 - p5) / 6.6
    skewness = (p16 + p84 - 2.0 * p50) / (2.0 * (p84 - p16)) + (p5 + p95 - 2.0 * p50) / (2.0 * (p95 - p5))
    kurtosis = (p95 - p5) / (2.44 * (p75 - p25))
    if scale == "metric":
        mean, sorting = math.exp(-mean), math.exp(sorting)
    return FolkWard(mean, sorting, skewness, kurtosis, scale)


def phi(size: float | Floats, unit: str = "mm") -> Floats:
    """Sizes on the phi scale, -log2(size / 1 mm).

    Raises
    ------
    ParameterError
        For a unit that is not known, and for sizes without a unit, which have no phi.

    Notes
    -----
    W. C. Krumbein, J. Sediment. Petrol. 4 (1934) 65.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.phi([4.0, 0.25])
    array([-2.,  2.])
    """
    return -np.log2(np.asarray(size, dtype=np.float64) * millimetres(unit, "phi"))


@dataclass(frozen=True)
class Milling:
    """Effect of a mill: 80 % passing sizes, reduction ratio, and per cent finer than a tenth of the parent size."""

    f80: float
    p80: float
    reduction_ratio: float
    t10: float
    parent: float


def milling(feed: Curve, product: Curve, *, parent: float | None = None) -> Milling:
    """F80, P80, reduction ratio F80 / P80, and t10.

    Parameters
    ----------
    feed, product : Grading or SizeCurve
        Gradings before and after the mill, with sizes in one unit.
    parent : float, optional
        Parent size, a tenth of which is the size of t10. Left out, it is D50 of the feed, which for a narrow
        fraction is the geometric mean of its two sieves.

    Returns
    -------
    Milling

    Raises
    ------
    ParameterError
        For gradings in different units, and where an 80 % passing size lies below the finest sieve.

    Notes
    -----
    F. C. Bond, Trans. AIME 193 (1952) 484; t10 after S. S. Narayanan, W. J. Whiten, Trans. Inst. Min.
    Metall. C 97 (1988) 115.

    Examples
    --------
    >>> import comminute as cm
    >>> done = cm.milling(cm.uniform_size(0.0, 10.0), cm.uniform_size(0.0, 2.0))
    >>> round(done.reduction_ratio, 6), round(done.t10, 6)
    (5.0, 25.0)
    """
    before, after = SizeCurve.of(feed), SizeCurve.of(product)
    if before.unit != after.unit:
        finding = f"is in '{before.unit}' and product in '{after.unit}'"
        raise parameter_error("feed", before.unit, finding=finding, remedy="use_one_unit")
    (f80,), (p80,) = _sizes(feed, (80.0,), False), _sizes(product, (80.0,), False)
    size = _sizes(feed, (50.0,), False)[0] if parent is None else parent
    return Milling(f80, p80, f80 / p80, 100.0 * fines_share(product, 0.1 * size), size)


def fines_share(curve: Curve, size: float) -> float:
    """Share of the mass that is finer than a size (0.063 mm in ISO 14688, 0.075 mm in ASTM D2487).

    Parameters
    ----------
    curve : Grading or SizeCurve
    size : float
        Size > 0, in the unit of the curve.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        Unless size > 0.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.fines_share(cm.fuller(16.0), 4.0)
    0.5
    """
    return float(curve.finer(size)) if isinstance(curve, Grading) else float(SizeCurve.of(curve).finer_than(size))


def _sizes(curve: Curve, percents: tuple[float, ...], extrapolate: bool) -> tuple[float, ...]:
    return tuple(float(curve.percentile(percent, extrapolate=extrapolate)) for percent in percents)

"""A Weibull modulus from crushing tests on single grains: where a fit may start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]


class StrengthSlope(NamedTuple):
    """Weibull modulus from single grains.

    Attributes
    ----------
    weibull_modulus : float
    standard_error : float
        NaN where two numbers alone decide.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.strength_slope([32.0, 4.0], [1.0, 8.0]).weibull_modulus.__round__(9)
    3.0
    """

    weibull_modulus: float
    standard_error: float


@suggests_keywords
def strength_slope(strength: npt.ArrayLike, size: npt.ArrayLike | None = None) -> StrengthSlope:
    """Weibull modulus from the strengths of single grains, their scatter or their fall with size.

    Strengths of grains of one size scatter as P[survives] = exp(-(strength / level)**w): the slope of
    ln(-ln(survival)) against ln(strength), with survivals (n + 1 - rank) / (n + 1), is w. Strengths of several sizes
    fall as size**(-3 / w), the weakest link in a volume, and their slope gives w too. The error of a slope by scatter
    is taken as that of maximum likelihood, .78 w / sqrt(n), since ranked strengths are not independent.

    The level of the strengths does *not* give first_crush_stress, since a grain in a packing is loaded at many
    contacts: that is found by `fit`.

    Parameters
    ----------
    strength : array_like (M,)
        Strengths F / d**2 > 0, of single grains of one size; or, with sizes, those at 37 % survival of each size.
    size : array_like (M,), optional
        Sizes, at least two different ones.

    Returns
    -------
    StrengthSlope

    Raises
    ------
    ParameterError
        For fewer than three strengths of one size or two sizes, for numbers that are not positive, and for strengths
        that do not fall with size or do not scatter.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.strength_slope([40.0, 20.0, 10.0], [1.0, 2.0, 4.0]).weibull_modulus.__round__(6)  # strength as 1 / size
    3.0
    >>> scattered = [11.0, 16.0, 19.0, 22.0, 26.0, 30.0, 37.0]
    >>> round(cm.strength_slope(scattered).weibull_modulus, 1)
    2.3
    """
    strengths = _positive("strength", strength)
    if size is not None:
        sizes = _positive("size", size)
        if sizes.shape != strengths.shape or np.unique(sizes).size < 2:
            rule = "give one for each strength, at least two different ones"
            raise parameter_error("size", sizes.size, rule, finding=f"has {sizes.size} values")
        slope, error = _slope(np.log(sizes), np.log(strengths))
        if not slope < 0.0:
            rule = "strength must fall with size, by size**(-3 / w)"
            raise parameter_error("strength", slope, rule, finding=f"goes as size to the power {slope:.3g}")
        return StrengthSlope(-3.0 / slope, 3.0 * error / slope**2)
    if strengths.size < 3 or np.ptp(strengths) == 0.0:
        rule = "give at least three that differ"
        raise parameter_error("strength", strengths.size, rule, finding=f"has {strengths.size} values")
    rank = np.arange(1, strengths.size + 1)
    survival = (strengths.size + 1 - rank) / (strengths.size + 1)
    modulus, _ = _slope(np.log(np.sort(strengths)), np.log(-np.log(survival)))
    return StrengthSlope(modulus, 0.78 * modulus / float(np.sqrt(strengths.size)))


def _positive(name: str, values: npt.ArrayLike) -> Floats:
    found = np.atleast_1d(np.asarray(values, dtype=np.float64))
    for index in np.flatnonzero(~((found > 0.0) & np.isfinite(found)))[:1]:
        raise parameter_error(f"{name}[{index}]", float(found[index]), "it must be greater than 0 and finite")
    return found


def _slope(x: Floats, y: Floats) -> tuple[float, float]:
    """Slope of a line by least squares, and its standard error."""
    away = x - x.mean()
    slope = float(away @ y / (away @ away))
    if x.size < 3:
        return slope, float("nan")
    rest = y - y.mean() - slope * away
    return slope, float(np.sqrt(rest @ rest / (x.size - 2) / (away @ away)))

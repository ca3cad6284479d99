"""Breakage mechanics, and the compression line of fractal crushing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, power_law
from comminute.comparators.mixing import mixture
from comminute.gradings.breakage import EINAV_DIMENSION, breakage_index
from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
Many = Sequence[float] | Floats


@overload
def breakage(
    start: Grading | SizeCurve,
    stress_ratio: float,
    *,
    ultimate_dimension: float = ...,
    smallest: float = ...,
    largest: float | None = ...,
) -> SizeCurve: ...
@overload
def breakage(
    start: Grading | SizeCurve,
    stress_ratio: Many,
    *,
    ultimate_dimension: float = ...,
    smallest: float = ...,
    largest: float | None = ...,
) -> list[SizeCurve]: ...
def breakage(
    start: Grading | SizeCurve,
    stress_ratio: float | Many,
    *,
    ultimate_dimension: float = EINAV_DIMENSION,
    smallest: float = 0.0,
    largest: float | None = None,
) -> SizeCurve | list[SizeCurve]:
    """Grading of breakage mechanics, F = (1 - B) F_0 + B F_u, under a load.

    For pure breakage of linear elastic grains under isotropic pressure, p / p_c = (1 - theta B) / (1 - B), so that
    B = (r - 1) / (r - theta) at the ratio r = p / p_c of at least 1.

    Parameters
    ----------
    start : Grading or SizeCurve
    stress_ratio : float or sequence of float
        Largest load so far over the one at which crushing begins, that of this start.
    ultimate_dimension : float
        Fractal dimension of the ultimate grading, a power law.
    smallest, largest : float
        Its sizes; `largest` left out is that of the start.

    Returns
    -------
    SizeCurve, or a list of them for several loads

    Raises
    ------
    ParameterError
        For a load outside its range, or a start that is no coarser than the ultimate grading.

    Notes
    -----
    I. Einav, J. Mech. Phys. Solids 55 (2007) 1274 and 1298; theta = 1 - <d**2>_u / <d**2>_0.

    Examples
    --------
    >>> import comminute as cm
    >>> start = cm.monodisperse(1.0)
    >>> curve = cm.comparators.breakage(start, 10.0)
    >>> found = cm.breakage_index(start, curve)
    >>> round(found.index, 6), round(9.0 / (10.0 - found.grading_index), 6)
    (0.981818, 0.981818)
    """
    curve = SizeCurve.of(start)
    theta = breakage_index(curve, curve, fractal_dimension=ultimate_dimension, smallest=smallest, largest=largest)
    ultimate = power_law(ultimate_dimension, smallest, theta.largest).with_unit(curve.unit)
    loads = np.atleast_1d(np.asarray(stress_ratio, dtype=np.float64))
    curves = []
    for load in loads:
        if not 0.0 <= load < np.inf:
            raise parameter_error("stress_ratio", float(load), "it must be a finite number of at least 0")
        index = max(float(load) - 1.0, 0.0) / (max(float(load), 1.0) - theta.grading_index)
        curves.append(mixture([1.0 - index, index], [curve, ultimate]))
    return curves if np.ndim(stress_ratio) else curves[0]


def normal_compression(
    stress: float | Sequence[float] | Floats, yield_stress: float, yield_void_ratio: float, weibull_modulus: float
) -> Floats:
    """Void ratio on the compression line of fractal crushing, e = e_y (stress / yield_stress)**(-w / 6).

    The slope is 1 / (2 b) in log e against log stress, b the exponent by which strength falls with size, 3 / w here. A
    line to lay beside a computed curve; below the yield stress there is no crushing, and e is e_y.

    Parameters
    ----------
    stress : float or sequence of float
    yield_stress, yield_void_ratio : float
        Point at which crushing begins.
    weibull_modulus : float
        w, Weibull modulus of grain strength.

    Returns
    -------
    ndarray

    Raises
    ------
    ParameterError
        For a number that is not greater than 0.

    Notes
    -----
    G. R. McDowell, J. P. de Bono, Geotechnique Lett. 3 (2013) 166.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.comparators.normal_compression([1.0, 10.0, 160.0], 10.0, 0.6, 3.0)
    array([0.6 , 0.6 , 0.15])
    """
    numbers = {"yield_stress": yield_stress, "yield_void_ratio": yield_void_ratio, "weibull_modulus": weibull_modulus}
    for name, value in numbers.items():
        if not 0.0 < value < np.inf:
            raise parameter_error(name, value, "it must be greater than 0 and finite")
    ratio = np.maximum(np.asarray(stress, dtype=np.float64) / yield_stress, 1.0)
    return np.asarray(yield_void_ratio * ratio ** (-weibull_modulus / 6.0))

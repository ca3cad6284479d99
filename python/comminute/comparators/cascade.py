"""Turcotte's cascade."""

from __future__ import annotations

import numpy as np

from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error


def cascade(share: float, levels: int, *, largest: float = 1.0, ratio: float = 2.0, unit: str = "") -> SizeCurve:
    """Grading of a cascade in which the same share of each size breaks into the next finer one.

    The mass at size largest * ratio**-i is (1 - f) f**i, so that the mass no larger is f**i: a power law of fractal
    dimension 3 + ln(f) / ln(ratio).

    Parameters
    ----------
    share : float
        f, share of the mass of each size that breaks on, in [0, 1].
    levels : int
        Number of times that some may break; the finest size keeps all that reaches it.
    largest : float
        Size of the grains at the beginning.
    ratio : float
        Ratio of one size to the next, greater than 1.
    unit : str
        Unit of the sizes.

    Returns
    -------
    SizeCurve

    Raises
    ------
    ParameterError
        For a number outside its range.

    Notes
    -----
    D. L. Turcotte, J. Geophys. Res. 91 (1986) 1921.

    Examples
    --------
    >>> import comminute as cm
    >>> curve = cm.comparators.cascade(0.75, 20)
    >>> curve.finer_than([1.0, 0.5, 0.25])
    array([1.    , 0.75  , 0.5625])
    """
    if not 0.0 <= share <= 1.0:
        raise parameter_error("share", share, "it must be between 0 and 1")
    if levels < 1:
        raise parameter_error("levels", levels, "it must be at least 1")
    if not (largest > 0.0 and np.isfinite(largest)):
        raise parameter_error("largest", largest, "it must be greater than 0 and finite")
    if not (ratio > 1.0 and np.isfinite(ratio)):
        raise parameter_error("ratio", ratio, "it must be greater than 1 and finite")
    size = largest * ratio ** -np.arange(levels, -1.0, -1.0)
    finer = share ** np.arange(levels, -1.0, -1.0)
    below = np.append(0.0, finer[:-1])
    return SizeCurve(np.repeat(size, 2), np.column_stack([below, finer]).ravel(), unit)

"""Mixtures of gradings."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


def mixture(shares: Sequence[float], gradings: Sequence[Grading | SizeCurve]) -> SizeCurve:
    """Grading of a mixture, F = sum of the shares times F of each.

    Parameters
    ----------
    shares : sequence of float
        Share of the mass of each, 0 or more, in all 1.
    gradings : sequence of Grading or SizeCurve
        Gradings in one unit.

    Returns
    -------
    SizeCurve
        Curve with the points and the jumps of all.

    Raises
    ------
    ParameterError
        For shares that do not sum to 1, as many as there are no gradings, or two units.

    Examples
    --------
    >>> import comminute as cm
    >>> both = cm.comparators.mixture([0.25, 0.75], [cm.monodisperse(1.0), cm.monodisperse(0.1)])
    >>> both == cm.SizeCurve.of(cm.gap_graded(1.0, 0.1, 0.25))
    True
    """
    curves = [SizeCurve.of(grading) for grading in gradings]
    if len(shares) != len(curves) or not curves:
        finding, rule = f"has {len(shares)} values", f"it must have one for each of the {len(curves)} gradings"
        raise parameter_error("shares", len(shares), rule, finding=finding)
    if any(not share >= 0.0 for share in shares) or not abs(math.fsum(shares) - 1.0) <= 1e-9:
        finding = f"is {[float(share) for share in shares]}"
        raise parameter_error("shares", math.fsum(shares), "they must be 0 or more and sum to 1", finding=finding)
    units = {curve.unit for curve in curves}
    if len(units) > 1:
        finding = f"are in {', '.join(sorted(units))}"
        raise parameter_error("gradings", subject="the gradings", finding=finding, remedy="use_one_unit")
    parts = [(share, curve) for share, curve in zip(shares, curves, strict=True) if share > 0.0]
    if len(parts) == 1:
        return parts[0][1]
    size = np.unique(np.concatenate([curve.size for _, curve in parts]))
    after = _sum([share * curve.finer_than(size) for share, curve in parts])
    before = _sum([share * _before(curve, size) for share, curve in parts])
    jump = after > before
    points = np.repeat(size, 1 + jump)
    finer = np.empty(points.size)
    last = np.cumsum(1 + jump) - 1
    finer[last] = after
    finer[last[jump] - 1] = before[jump]
    finer = np.maximum.accumulate(finer)
    finer[-1] = 1.0
    weight = [share * float(curve.finer_than(size[0])) for share, curve in parts]
    slopes = [curve.tail_slope for _, curve in parts]
    tail = float(np.average(slopes, weights=weight)) if finer[0] > 0.0 and any(weight) else 0.0
    if points.size == 1:
        points, finer = np.repeat(points, 2), np.array([0.0, 1.0])
    return SizeCurve(points, finer, units.pop(), tail)


def _sum(terms: list[Floats]) -> Floats:
    return np.asarray(np.sum(terms, axis=0))


def _before(curve: SizeCurve, size: Floats) -> Floats:
    """Mass finer than each size, without what has exactly that size."""
    found = curve.finer_than(size)
    jumps = np.flatnonzero(np.diff(curve.size) == 0.0)
    for k in jumps[::-1]:  # of several points at one size the first
        found[size == curve.size[k]] = curve.finer[k]
    return found

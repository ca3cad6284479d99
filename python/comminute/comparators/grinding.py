"""Batch grinding, the population balance of mineral processing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import overload

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.packing.classes import classes_of
from comminute.runs.recipe import Law
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
Many = Sequence[float] | Floats
DECADES = 3.0  # below the finest size of the start, to which the classes go where no end is given
STEP = 32.0  # mean breakages of the fastest class in one step, so that its Poisson weights keep their digits
MOST = 1e5  # mean breakages of the fastest class in all
ENOUGH = 1e-18  # Poisson weight that is left out


@overload
def batch_grinding(
    start: Grading | SizeCurve,
    fragments: Law,
    selection_exponent: float,
    time: float,
    *,
    rate: float = ...,
    smallest: float | None = ...,
    classes: int = ...,
) -> SizeCurve: ...
@overload
def batch_grinding(
    start: Grading | SizeCurve,
    fragments: Law,
    selection_exponent: float,
    time: Many,
    *,
    rate: float = ...,
    smallest: float | None = ...,
    classes: int = ...,
) -> list[SizeCurve]: ...
def batch_grinding(
    start: Grading | SizeCurve,
    fragments: Law,
    selection_exponent: float,
    time: float | Many,
    *,
    rate: float = 1.0,
    smallest: float | None = None,
    classes: int = 300,
) -> SizeCurve | list[SizeCurve]:
    """Grading after a time in a batch mill, where grains break at a rate k x**a of their size alone.

    dm_i/dt = -S_i m_i + sum over coarser j of b_ij S_j m_j, with S = k x**a and b the fragments' law. Classes decay by
    sums of positive terms alone, so that mass is kept to rounding and equal rates are nothing special.

    Parameters
    ----------
    start : Grading or SizeCurve
    fragments : WeibullFragments, PowerLawFragments, LogNormalFragments or TabulatedFragments
        Law of the size of a fragment relative to its grain, by mass.
    selection_exponent : float
        a >= 0: with 0 the rate is the same for all (Kolmogorov's case), above it log-normality is left.
    time : float or sequence of float
        Time or times, >= 0.
    rate : float
        k > 0, breakages in a unit of time of a grain of size 1.
    smallest : float, optional
        Size below which grains are no longer followed, but counted. Left out, three decades below the start's finest.
    classes : int
        Number of classes, evenly spaced in ln(size).

    Returns
    -------
    SizeCurve, or a list of them for several times

    Raises
    ------
    ParameterError
        For a number outside its range, or for more than 10**5 breakages of the coarsest grains.

    Notes
    -----
    K. J. Reid, Chem. Eng. Sci. 20 (1965) 953; L. G. Austin, Powder Technol. 5 (1971) 1. Where the fragments are a power
    law of the exponent a too, 1 - F(x, t) = (1 - F_0(x)) exp(-k x**a t) for any start, and here at every class's edge.

    Examples
    --------
    >>> import comminute as cm
    >>> curve = cm.comparators.batch_grinding(cm.monodisperse(1.0), cm.PowerLawFragments(1.0), 1.0, 2.0)
    >>> bool(abs(1.0 - curve.finer[:-1] - np.exp(-2.0 * curve.size[:-1])).max() < 1e-14)
    True
    """
    for name, value, least in (("selection_exponent", selection_exponent, 0.0), ("rate", rate, np.nextafter(0.0, 1.0))):
        if not least <= value < math.inf:
            rule = f"it must be {'at least' if least == 0.0 else 'greater than'} 0 and finite"
            raise parameter_error(name, value, rule)
    if classes < 2:
        raise parameter_error("classes", classes, "it must be at least 2")
    curve = SizeCurve.of(start)
    finest = float(curve.size[0]) * 10.0**-DECADES if smallest is None else smallest
    if not 0.0 < finest < curve.size[-1]:
        raise parameter_error("smallest", finest, f"it must be between 0 and the largest size, {curve.size[-1]:g}")
    times = np.atleast_1d(np.asarray(time, dtype=np.float64))
    fastest = rate * float(curve.size[-1]) ** selection_exponent
    for one in times:
        if not 0.0 <= one < math.inf:
            raise parameter_error("time", float(one), "it must be a finite number of at least 0")
        if one * fastest > MOST:
            raise parameter_error("time", float(one), f"the coarsest grains may break {MOST:g} times on average")
    mill = _Mill(curve, fragments, selection_exponent, rate, finest, classes)
    curves = [mill.after(float(one)) for one in times]
    return curves if np.ndim(time) else curves[0]


class _Mill:
    """Classes of a mill: even ones from fine to coarse, then exact sizes; the share finer than all is counted."""

    def __init__(
        self, curve: SizeCurve, fragments: Law, exponent: float, rate: float, finest: float, classes: int
    ) -> None:
        self._unit = curve.unit
        parts = classes_of(curve, 1)
        self._exact = parts.exact_size
        edges = np.exp(np.linspace(math.log(finest), math.log(curve.size[-1]), classes + 1))
        edges[[0, -1]] = finest, curve.size[-1]
        self._edges = edges
        passed = np.array([parts.exact_share[parts.exact_size <= edge].sum() for edge in edges])
        smooth = curve.finer_than(edges) - passed
        self._start = np.concatenate([np.maximum(np.diff(smooth), 0.0), parts.exact_share])
        size = np.concatenate([np.sqrt(edges[1:] * edges[:-1]), self._exact])
        speed = rate * size**exponent
        # share of the fragments of each class that is finer than each edge; none is coarser than its grain
        finer = fragments.cdf(np.minimum(np.log(edges[:, None] / size[None, :]), 0.0))
        finer[edges[:, None] >= size[None, :]] = 1.0
        into = np.diff(finer, axis=0)
        own = np.arange(classes)
        into[own, own] = 1.0 - finer[own, own]  # of a class's own fragments those above its lower edge
        self._fastest = float(speed.max())
        step = np.zeros((size.size, size.size))
        step[:classes] = into * (speed / self._fastest)
        step[np.arange(size.size), np.arange(size.size)] += 1.0 - speed / self._fastest
        self._step = step

    def after(self, time: float) -> SizeCurve:
        """Give the curve after a time."""
        mass = self._start
        count = max(math.ceil(self._fastest * time / STEP), 1)
        for _ in range(count):
            mass = self._stepped(mass, self._fastest * time / count)
        even = self._edges.size - 1
        below = 1.0 - math.fsum(mass.tolist())
        finer = below + np.append(0.0, np.cumsum(mass[:even]))
        order = np.argsort(self._exact)
        size, shares = self._edges, mass[even:][order]
        for at, share in zip(self._exact[order], shares, strict=True):
            place = int(np.searchsorted(size, at, side="left"))
            level = float(SizeCurve(size, finer).finer_than(at)) if place < size.size else float(finer[-1])
            if place < size.size and size[place] == at:
                level = float(finer[place])
                size, finer = np.insert(size, place, at), np.insert(finer, place, level)
            else:
                size, finer = np.insert(size, place, [at, at]), np.insert(finer, place, [level, level])
            finer[place + 1 :] += share
        finer = np.minimum(finer, 1.0)  # which sums pass by rounding
        finer[-1] = 1.0
        slope = float(np.log(finer[1] / finer[0]) / np.log(size[1] / size[0])) if finer[0] > 0.0 else 0.0
        return SizeCurve(size, np.maximum.accumulate(finer), self._unit, slope)

    def _stepped(self, mass: Floats, breakages: float) -> Floats:
        """Mass after so many mean breakages of the fastest class: a Poisson sum, all of its terms positive."""
        weight = math.exp(-breakages)
        total, term, sum_of_weights, k = weight * mass, mass, weight, 0
        while k < breakages or weight > ENOUGH:
            k += 1
            weight *= breakages / k
            term = self._step @ term
            total = total + weight * term
            sum_of_weights += weight
        return np.asarray(total / sum_of_weights)

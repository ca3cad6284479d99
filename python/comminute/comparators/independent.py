"""Crushing without regard to size or neighbours: Kolmogorov's and Epstein's random products."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, fragment_pmf
from comminute.comparators.mixing import mixture
from comminute.gradings.curves import SizeCurve
from comminute.packing.classes import classes_of
from comminute.runs.recipe import Law
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
LEFT = 1e-9  # share of the mass that may be finer than the grid
MOST_CELLS = 2**20


def independent(
    start: Grading | SizeCurve,
    fragments: Law,
    *,
    crushes: int | None = None,
    mean_crushes: float | None = None,
    spacing: float = 0.01,
) -> SizeCurve:
    """Grading after each grain has crushed a number of times, whatever its size: ln d falls by a random sum.

    Parameters
    ----------
    start : Grading or SizeCurve
    fragments : WeibullFragments, PowerLawFragments, LogNormalFragments or TabulatedFragments
        Law of the size of a fragment relative to its grain, by mass.
    crushes : int
        Number of crushes, the same for all grains (Kolmogorov 1941, Epstein 1947); or
    mean_crushes : float
        mean of a number that is Poisson distributed, for crushes at random times.
    spacing : float
        Width of the cells in ln(size); errors go with its square.

    Returns
    -------
    SizeCurve

    Raises
    ------
    ParameterError
        Unless one of both numbers is given, 0 or more; for a spacing that is not greater than 0, or too fine for the
        depth of the curve.

    Notes
    -----
    The density of ln d is that of the start convolved with t times that of ln X, or with exp(tau (phi - 1)) in Fourier
    space, phi being the transform of the latter. Many crushes lead to the log-normal law.

    Examples
    --------
    >>> import comminute as cm
    >>> once = cm.comparators.independent(cm.monodisperse(1.0), cm.PowerLawFragments(1.0), crushes=1)
    >>> round(once.percentile(50), 4)
    0.5
    >>> some = cm.comparators.independent(cm.monodisperse(1.0), cm.PowerLawFragments(1.0), mean_crushes=0.5)
    >>> float(round(1.0 - some.finer[some.size == 1.0][0], 6))  # exp(-0.5), unbroken
    0.606531
    """
    if (crushes is None) == (mean_crushes is None):
        finding = "crushes or mean_crushes"
        raise parameter_error("crushes", subject="give one of", finding=finding)
    number = float(crushes if crushes is not None else mean_crushes or 0.0)
    if not 0.0 <= number < math.inf or (crushes is not None and crushes != int(crushes)):
        name, rule = ("crushes", "a whole number") if crushes is not None else ("mean_crushes", "a number")
        raise parameter_error(name, number, f"it must be {rule} of at least 0")
    if not 0.0 < spacing < math.inf:
        raise parameter_error("spacing", spacing, "it must be greater than 0 and finite")
    curve = SizeCurve.of(start)
    unbroken = float(number == 0.0) if crushes is not None else math.exp(-number)
    if unbroken == 1.0:
        return curve
    cells = _cells(curve, spacing)
    mass = _after(cells, fragments, number, spacing, fixed=crushes is not None)
    if unbroken > 0.0:  # the rest of the cells' own mass is that of grains whose fragments stayed in their cell
        mass[: cells.size] -= unbroken * cells
        mass /= 1.0 - unbroken
    edges = curve.size[-1] * np.exp(spacing * (0.5 - np.arange(mass.size + 1)))
    edges[0] = curve.size[-1]  # no fragment is larger than the largest grain
    finer = np.append(1.0, 1.0 - np.cumsum(mass))
    kept = int(np.argmax(finer <= LEFT)) or finer.size
    size, share = edges[:kept][::-1], np.maximum.accumulate(np.maximum(finer[:kept][::-1], 0.0))
    slope = float(np.log(share[1] / share[0])) / spacing if share[0] > 0.0 else 0.0
    broken = SizeCurve(size, share, curve.unit, slope)
    return mixture([unbroken, 1.0 - unbroken], [curve, broken]) if unbroken > 0.0 else broken


def _cells(curve: SizeCurve, spacing: float) -> Floats:
    """Mass of a curve in cells from its largest grain, the centre of the first, down; means of ln(size) are kept."""
    span = math.log(curve.size[-1] / curve.size[0])
    parts = classes_of(curve, max(math.ceil(4.0 * span / spacing), 1))
    place = np.log(curve.size[-1] / parts.all_sizes) / spacing
    below = np.floor(place).astype(np.int64)
    cells = np.zeros(int(below.max()) + 2)
    np.add.at(cells, below, parts.all_shares * (1.0 - (place - below)))
    np.add.at(cells, below + 1, parts.all_shares * (place - below))
    return cells


def _after(cells: Floats, fragments: Law, number: float, spacing: float, *, fixed: bool) -> Floats:
    """Mass in cells after the crushes, on as many cells as hold all but a trifle of it."""
    count = 1 << max(math.ceil(math.log2(cells.size + 8.0 / spacing)), 8)
    while True:
        one = fragment_pmf(fragments, spacing, count)
        transform = np.fft.rfft(one, 2 * count)
        spread = transform**number if fixed else np.exp(number * (transform - 1.0))
        mass = np.fft.irfft(spread * np.fft.rfft(cells, 2 * count), 2 * count)[:count]
        if 1.0 - float(mass.sum()) <= LEFT:
            return np.maximum(mass, 0.0)
        if 2 * count > MOST_CELLS:
            rule = f"the curve would need more than {MOST_CELLS} cells: take wider ones or fewer crushes"
            raise parameter_error("spacing", spacing, rule)
        count *= 2

"""Surface area with a cut-off, compaction work, and work indices for reports; no energy balance.

A crush of the paper's fragments, and of every law whose exponent at small sizes is 1 or less, makes infinite new
surface, so that a surface energy of a run has no meaning and none is offered. Nor is what crushing dissipates, or what
the grains store.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.util.choices import require_word
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
SPHERE = 6.0  # surface over volume, times the size, of a sphere or a cube
WALKER = {"kick": 1.0, "bond": 1.5, "rittinger": 2.0}
MICROMETRE = 100.0  # of Bond's index: the work from endless size to 80 % finer than so many micrometres
ReductionLaw = Literal["kick", "bond", "rittinger"]

__all__ = ["compaction_work", "reduction_work", "specific_surface"]


def specific_surface(grading: Grading | SizeCurve, smallest: float | None = None, *, shape: float = SPHERE) -> float:
    """Surface of the grains per volume of solid, of those no smaller than a size; or what it is at the least.

    Parameters
    ----------
    grading : Grading or SizeCurve
    smallest : float, optional
        Size below which grains are left out; the surface of a power law of dimension 2 or more has no end, so the
        number is one of this size. Left out, a lower bound: what is finer than the finest known size counts as if it
        had that size.
    shape : float
        Surface over volume, times the size: 6 for spheres and cubes.

    Returns
    -------
    float
        In the inverse of the curve's unit; over the density of the grains it is the surface per mass.

    Raises
    ------
    ParameterError
        For sizes or shapes that are not greater than 0.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.energy.specific_surface(cm.monodisperse(0.5))
    12.0
    >>> round(cm.energy.specific_surface(cm.log_uniform(0.1, 1.0)), 4)  # 6 * (1/.1 - 1/1) / ln(10)
    23.4519
    """
    curve = SizeCurve.of(grading)
    if not 0.0 < shape < math.inf:
        raise parameter_error("shape", shape, "it must be greater than 0 and finite")
    if smallest is not None and not 0.0 < smallest < math.inf:
        raise parameter_error("smallest", smallest, "it must be greater than 0 and finite")
    size, finer = curve.size, curve.finer
    total = 0.0
    if smallest is None:
        total = float(finer[0] / size[0])
    elif smallest < size[0]:
        slope = curve.tail_slope
        if slope > 0.0:  # F = finer[0] (d / size[0])**slope from the cut-off up
            ratio = smallest / float(size[0])
            fall = -math.log(ratio) if slope == 1.0 else (1.0 - ratio ** (slope - 1.0)) / (slope - 1.0)
            total = float(finer[0]) * slope * fall / float(size[0])
    else:
        kept = size > smallest
        finer = np.append(curve.finer_than(smallest), finer[kept])
        size = np.append(smallest, size[kept])
    low, high = size[:-1], size[1:]
    span = np.log(high / low)
    mean = np.divide(1.0 / low - 1.0 / high, span, out=1.0 / low, where=span > 1e-8)
    return shape * (total + float(np.sum(np.diff(finer) * mean)))


def reduction_work(feed: float, product: float, index: float, law: ReductionLaw = "bond") -> float:
    """Work of size reduction by the laws of Kick, Bond or Rittinger, for reports: it is no property of a run.

    Walker's dW = -C dx / x**n with n = 1, 3/2 and 2.

    Parameters
    ----------
    feed, product : float
        F80 and P80, sizes that 80 % of the feed and of the product are finer than; of Bond's law in micrometres.
    index : float
        Of Bond's law the work index W_i, in kWh per tonne: the work from grains without end in size to P80 = 100
        micrometres. Of the others the constant C.
    law : {"kick", "bond", "rittinger"}

    Returns
    -------
    float
        C ln(F / P); 10 W_i (P**-1/2 - F**-1/2); or C (1/P - 1/F).

    Raises
    ------
    ParameterError
        For sizes that do not fall, or an index that is not greater than 0.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.energy.reduction_work(float("inf"), 100.0, index=12.0)
    12.0
    """
    require_word("law", law, ReductionLaw)
    if not 0.0 < product < math.inf:
        raise parameter_error("product", product, "it must be greater than 0 and finite")
    if not feed >= product:
        raise parameter_error("feed", feed, f"it must be no smaller than the product, {product:g}")
    if not 0.0 < index < math.inf:
        raise parameter_error("index", index, "it must be greater than 0 and finite")
    if law == "kick":
        return index * math.log(feed / product)
    if law == "bond":
        return float(index * math.sqrt(MICROMETRE) * (product**-0.5 - feed**-0.5))
    return index * (1.0 / product - 1.0 / feed)


def compaction_work(
    stress: Sequence[float] | Floats, void_ratio: Sequence[float] | Floats, grain_density: float
) -> float:
    """Work of a vertical stress in one-dimensional compression, per mass of grains.

    The integral of stress (-de) over the grains' density: what a press must supply at the least beyond elasticity where
    the void ratios hold. Side walls that do not move do no work.

    Parameters
    ----------
    stress : sequence of float
        Vertical stresses in MPa, rising.
    void_ratio : sequence of float
        Void ratio at each; straight lines between them.
    grain_density : float
        Density of the grains, in kg/m3.

    Returns
    -------
    float
        In kJ/kg; over 3.6 it is kWh/t.

    Raises
    ------
    ParameterError
        For lists of different lengths or less than two, stresses that fall, or a density that is not greater than 0.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.energy.compaction_work([0.0, 50.0], [0.75, 0.5], grain_density=2500.0)
    2.5
    """
    loads, ratios = np.asarray(stress, dtype=np.float64), np.asarray(void_ratio, dtype=np.float64)
    if loads.ndim != 1 or loads.shape != ratios.shape or loads.size < 2:
        finding = f"has {ratios.size} values for {loads.size} stresses"
        raise parameter_error("void_ratio", finding=finding, rule="it must have one for each of two or more")
    if np.any(np.diff(loads) < 0.0) or loads[0] < 0.0:
        raise parameter_error("stress", float(loads[int(np.argmin(np.diff(loads)))]), "it must not fall, from 0 on")
    if not 0.0 < grain_density < math.inf:
        raise parameter_error("grain_density", grain_density, "it must be greater than 0 and finite")
    work = float(np.sum(0.5 * (loads[1:] + loads[:-1]) * -np.diff(ratios)))  # MPa, which is MJ/m3 of solid
    return 1e3 * work / grain_density

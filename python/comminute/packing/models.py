"""Solid fraction and void ratio of a grading, by whichever model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.packing.classes import SizeClasses, classes_of
from comminute.packing.compressible import compressible_fraction, linear_fraction
from comminute.packing.linear_mixture import MOST_CLASSES, mixing_fraction
from comminute.packing.rods import rods_fraction
from comminute.util.choices import require_word
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
Model = Literal["cpm", "lpm", "linear-mixture", "rods"]
Packing = float | Mapping[float, float]
PACKING = 2.0 / 3.0  # a mere default: grains of one size then have a void ratio of 2/3
COMPACTION = 9.0  # vibrated under 10 kPa
RODS = 100_000
BISECTIONS = 60


class PackingOptions(TypedDict, total=False):
    """Options of `solid_fraction`, which has their defaults and meanings."""

    packing: Packing
    compaction: float
    classes: int | None
    rods: int


def solid_fraction(
    grading: Grading | SizeCurve | SizeClasses,
    model: Model = "cpm",
    *,
    packing: Packing = PACKING,
    compaction: float = COMPACTION,
    classes: int | None = None,
    rods: int = RODS,
) -> float:
    """Share of the volume that the grains of a mixed packing fill.

    Parameters
    ----------
    grading : Grading or SizeCurve
    model : {"cpm", "lpm", "linear-mixture", "rods"}
        Compressible packing model (de Larrard), its linear limit, the linear-mixture model (Yu & Standish), or rods on
        a line (Farr & Groot), a witness for frictionless spheres. They differ by .02 to .06 where two sizes lie
        densest, so say which one a number is of.
    packing : float or mapping of size to float
        Packing of grains of one size, in (0, 1): the virtual one for "cpm" and "lpm", which only endless compaction
        reaches; their solid fraction for "linear-mixture". A mapping is linear in ln(size) between its sizes and
        constant beyond. The default is a mere default: `calibrate` finds it from one measured void ratio.
    compaction : float
        K of "cpm": 4.1 poured, 4.5 rodded, 4.75 vibrated, 9 vibrated under 10 kPa.
    classes : int, optional
        Number of classes of a curve; see `classes_of`.
    rods : int
        Number of rods.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        For a packing or compaction outside its range; for rods also for a tail that has no mean section.

    Notes
    -----
    The stated errors of the compressible model are 0.8 % for rounded and 1.8 % for crushed grains.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.packing.solid_fraction(cm.monodisperse(1.0)), 12)  # K / (K + 1) of the virtual packing
    0.6
    >>> round(cm.packing.solid_fraction(cm.fuller(16.0)), 3)
    0.85
    """
    require_word("model", model, Model)
    divided = _divided(grading, model, classes)
    if model == "rods":
        return _by_rods(grading, divided, rods)
    if not 0.0 < compaction < math.inf:
        raise parameter_error("compaction", compaction, "it must be greater than 0 and finite")
    if model == "linear-mixture":
        held = divided.all_shares > 0.0
        size, share = divided.all_sizes[held], divided.all_shares[held]
        return mixing_fraction(size, share, _packings(packing, size))
    of_classes = _packings(packing, divided.all_sizes)
    if model == "lpm":
        return linear_fraction(divided, of_classes)
    return compressible_fraction(divided, of_classes, compaction)


def void_ratio(
    grading: Grading | SizeCurve | SizeClasses, model: Model = "cpm", **options: Unpack[PackingOptions]
) -> float:
    """Volume of the voids over that of the grains, e = 1 / Phi - 1; see `solid_fraction` for arguments and errors.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.packing.void_ratio(cm.monodisperse(1.0)), 12)
    0.666666666667
    """
    return 1.0 / solid_fraction(grading, model, **options) - 1.0


def calibrate(
    grading: Grading | SizeCurve | SizeClasses,
    void_ratio: float,
    model: Model = "cpm",
    **options: Unpack[PackingOptions],
) -> float:
    """Packing of one size that gives a grading a measured void ratio.

    Parameters
    ----------
    grading : Grading or SizeCurve
        Grading of the specimen.
    void_ratio : float
        Its void ratio, in a state of the compaction that all others will be compared in.
    model : {"cpm", "lpm", "linear-mixture"}
    **options
        `compaction` and `classes`, as for `solid_fraction`.

    Returns
    -------
    float
        `packing` for the other functions.

    Raises
    ------
    ParameterError
        For a void ratio that no packing in (0, 1) gives, for rods, which have nothing to be calibrated, and for a
        packing, which is what is looked for.

    Examples
    --------
    >>> import comminute as cm
    >>> beta = cm.packing.calibrate(cm.fuller(16.0), 0.25)
    >>> round(cm.packing.void_ratio(cm.fuller(16.0), packing=beta), 9)
    0.25
    """
    if model == "rods":
        raise parameter_error("model", "'rods'", 'they have no free number: take "cpm", "lpm" or "linear-mixture"')
    if "packing" in options:
        raise parameter_error("packing", str(options["packing"]), "it is what is looked for: leave it out")
    if not 0.0 < void_ratio < math.inf:
        raise parameter_error("void_ratio", float(void_ratio), "it must be greater than 0 and finite")
    divided = _divided(grading, model, options.get("classes"))

    def fraction(packing: float) -> float:
        return solid_fraction(divided, model, **options | {"packing": packing})

    wanted, low, high = 1.0 / (1.0 + void_ratio), 1e-6, 1.0 - 1e-9
    if not fraction(low) < wanted < fraction(high):
        least = 1.0 / fraction(high) - 1.0
        finding = f"is {void_ratio:g}, and this grading has {least:.3g} at the least by the model {model}"
        rule = "check that it belongs to this grading, and is no porosity"
        raise parameter_error("void_ratio", float(void_ratio), rule, finding=finding)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fraction(middle) < wanted else (low, middle)
    return 0.5 * (low + high)


def separated_void_ratio(
    grading: Grading | SizeCurve | SizeClasses, model: Model = "cpm", **options: Unpack[PackingOptions]
) -> float:
    """Void ratio of the same grains with each size in a place of its own, the largest that a grading can have.

    Examples
    --------
    >>> import comminute as cm
    >>> mixed, apart = cm.packing.void_ratio(cm.fuller(16.0)), cm.packing.separated_void_ratio(cm.fuller(16.0))
    >>> mixed < apart, round(apart, 6)
    (True, 0.666667)
    """
    if not isinstance(options.get("packing"), Mapping):  # then all sizes lie alike
        return 1.0 / solid_fraction(_of_one_size(1.0), model, **options) - 1.0
    divided = classes_of(grading, options.get("classes"))
    held = divided.all_shares > 0.0
    solid = [solid_fraction(_of_one_size(float(size)), model, **options) for size in divided.all_sizes[held]]
    return float((divided.all_shares[held] / solid).sum() - 1.0)


def fines_effect(grading: Grading | SizeCurve, model: Model = "cpm", **options: Unpack[PackingOptions]) -> float:
    """Change of the void ratio where what is finer than the finest known size is half as large as it is taken to be.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.packing.fines_effect(cm.gap_graded(1.0, 0.1))  # all sizes are known
    0.0
    >>> abs(cm.packing.fines_effect(cm.power_law(2.5, 0.0, 1.0))) < 1e-3
    True
    """
    divided = _divided(grading, model, options.get("classes"))
    if divided.fines_share == 0.0:
        return 0.0
    finer = divided.with_fines_at(0.5 * divided.fines_size)
    return void_ratio(finer, model, **options) - void_ratio(divided, model, **options)


def narrow_spheres(grading: Grading | SizeCurve) -> float:
    """Random close packing of spheres of nearly one size, .634 + .0658 d + .0857 S d**2.

    d and S are the relative standard deviation and the skewness of the sizes by number. The formula is quoted from
    K. W. Desmond, E. R. Weeks, Phys. Rev. E 90 (2014) 022204, and was not checked against it.

    Raises
    ------
    ParameterError
        For a grading that runs on to ever finer grains, which has no mean size by number.

    Examples
    --------
    >>> import comminute as cm
    >>> round(cm.packing.narrow_spheres(cm.monodisperse(1.0)), 4)
    0.634
    """
    curve = SizeCurve.of(grading)
    if curve.finer[0] > 0.0:
        finding, rule = "has no mean size by number", "cut it off below, or take another model"
        subject = "a grading that runs on to ever finer grains"
        raise parameter_error("grading", float(curve.finer[0]), rule, subject=subject, finding=finding)
    divided = classes_of(curve)
    held = divided.all_shares > 0.0
    size = divided.all_sizes[held]
    number = divided.all_shares[held] / size**3
    number /= number.sum()
    mean = float(number @ size)
    deviation = size / mean - 1.0
    spread = math.sqrt(float(number @ deviation**2))
    skewness = float(number @ deviation**3) / spread**3 if spread > 0.0 else 0.0
    return 0.634 + 0.0658 * spread + 0.0857 * skewness * spread**2


def _of_one_size(size: float) -> SizeClasses:
    """Classes of grains of one size."""
    none = np.zeros(0)
    return SizeClasses(none, none, 0.0, np.array([size]), np.ones(1))


def _divided(grading: Grading | SizeCurve | SizeClasses, model: Model, classes: int | None) -> SizeClasses:
    """Classes of a grading, no more than a model can take."""
    divided = classes_of(grading, classes)
    if model == "linear-mixture" and classes is None and divided.all_sizes.size > MOST_CLASSES:
        return classes_of(grading, max(MOST_CLASSES - divided.exact_size.size - 1, 2))
    return divided


def _by_rods(grading: Grading | SizeCurve | SizeClasses, divided: SizeClasses, rods: int) -> float:
    """Solid fraction by rods, where a line meets finitely many grains."""
    if rods < 2:
        raise parameter_error("rods", rods, "it must be at least 2")
    if divided.fines_share > 0.0 and not isinstance(grading, SizeClasses):
        slope = SizeCurve.of(grading).tail_slope
        if slope <= 1.0:
            rule = "rods need a tail of dimension below 2, or a smallest size"
            finding = f"has fractal dimension {3.0 - slope:.3g}: a line meets infinitely many of its grains"
            raise parameter_error("grading", 3.0 - slope, rule, subject="the tail", finding=finding)
    held = divided.all_shares > 0.0
    return rods_fraction(divided.all_sizes[held], divided.all_shares[held], rods)


def _packings(packing: Packing, sizes: Floats) -> Floats:
    """(N,) packing of each size."""
    given = dict(packing) if isinstance(packing, Mapping) else {1.0: packing}
    if not given:
        raise parameter_error("packing", "an empty mapping", "it must give a packing for some size")
    for size, value in given.items():
        if not 0.0 < size < math.inf:
            raise parameter_error("packing", float(size), "its sizes must be greater than 0 and finite")
        if not 0.0 < value < 1.0:
            raise parameter_error("packing", float(value), "it must be between 0 and 1, neither included")
    at = sorted(given)
    return np.interp(np.log(sizes), np.log(at), [given[size] for size in at])

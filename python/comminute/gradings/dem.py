"""Gradings for particle codes: what YADE, LIGGGHTS and MercuryDPM read to make grains of given sizes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.gradings.sieves import convert, unit_of
from comminute.util.choices import require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
DemCode = Literal["yade", "liggghts", "mercury-dpm"]
SPREAD = 1e-4  # share of the mass above which a step of a curve over JUMP is an exact size
JUMP = 1e-6  # relative width over which an exact size is spread, where a code wants rising sizes


class DemGrading(NamedTuple):
    """Grading cut off below and brought to metres.

    Attributes
    ----------
    size : ndarray (M,)
        Diameters [m], rising.
    finer : ndarray (M,)
        Mass fraction finer of what is left, from 0 to 1.
    lost : float
        Mass fraction finer than the smallest, which is left out.
    """

    size: Floats
    finer: Floats
    lost: float


@suggests_keywords
def dem_text(
    grading: Grading | SizeCurve,
    code: DemCode,
    *,
    smallest: float | None = None,
    classes: int = 12,
    density: float = 2650.0,
    seed: int = 100003,
) -> str:
    """Text that a particle code reads to make grains of this grading, by mass; sizes in metres.

    A code cannot have grains of all sizes: those below `smallest` are left out, and the text says how much mass that
    is.

    Parameters
    ----------
    grading : Grading or SizeCurve
        With a unit.
    code : {"yade", "liggghts", "mercury-dpm"}
        YADE: the lists psdSizes (diameters) and psdCumm for `SpherePack.makeCloud` with distributeMass=True.
        LIGGGHTS: templates of one radius each, and a fix particledistribution/discrete/massbased of them.
        MercuryDPM: a file of radii and cumulated volume without headings, for `PSD::setPSDFromCSV` with
        CUMULATIVE_VOLUME_DISTRIBUTION.
    smallest : float, optional
        Smallest grain, in the unit of the grading; needed where the curve has a tail below its finest point.
    classes : int
        Classes of sizes between the smallest and the largest, even in ln d; at least 1.
    density : float
        Density of the grains [kg/m3], which LIGGGHTS's templates have.
    seed : int
        LIGGGHTS wants prime numbers above 10 000: each template takes the next prime from here on.

    Returns
    -------
    str

    Raises
    ------
    ParameterError
        For a grading without a unit, a word or number outside its range, or a tail that is not cut.

    Examples
    --------
    >>> import comminute as cm
    >>> sand = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 60, 0], unit="mm")
    >>> print(cm.dem_text(sand, "yade", classes=2))
    # YADE: makeCloud(..., psdSizes=psdSizes, psdCumm=psdCumm, distributeMass=True); diameters in m
    psdSizes = [0.0005, 0.001, 0.002]
    psdCumm = [0.0, 0.6, 1.0]
    <BLANKLINE>
    """
    require_word("code", code, DemCode)
    if classes < 1:
        raise parameter_error("classes", classes, "it must be at least 1")
    if not 0.0 < density < math.inf:
        raise parameter_error("density", density, "it must be greater than 0 and finite")
    cut = dem_grading(grading, smallest=smallest, classes=classes)
    left_out = f"{100.0 * cut.lost:.3g} % of the mass, finer than {cut.size[0]:.4g} m, is left out\n"
    writers: dict[str, Callable[[], tuple[str, str]]] = {
        "yade": lambda: ("# ", _yade(cut)),
        "liggghts": lambda: ("# ", _liggghts(cut, density, seed)),
        "mercury-dpm": lambda: ("", _mercury(cut)),  # its file has no room for a comment
    }
    mark, text = writers[code]()
    return (mark + left_out if mark and cut.lost > 0.0 else "") + text


def dem_grading(grading: Grading | SizeCurve, *, smallest: float | None, classes: int) -> DemGrading:
    """Cut a grading off below, and read it at sizes even in ln d; exact sizes keep their mass."""
    curve = SizeCurve.of(grading)
    if not unit_of(curve.unit):
        raise parameter_error(
            "unit", f"'{curve.unit}'", subject="the grading", finding="has no unit", remedy="name_unit"
        )
    largest = float(curve.size[np.searchsorted(curve.finer, 1.0 - 1e-12)])
    if smallest is None:
        if curve.finer[0] > 0.0:
            rule = "name the smallest grain that the code shall have"
            finding = f"is not given, and {100.0 * curve.finer[0]:.3g} % lie below {curve.size[0]:.4g} {curve.unit}"
            raise parameter_error("smallest", "None", rule, finding=finding)
        smallest = float(curve.size[0])
    if not 0.0 < smallest <= largest:
        raise parameter_error("smallest", smallest, f"it must be greater than 0 and at most the largest, {largest:g}")
    exact = curve.size[1:][np.diff(curve.size) == 0.0]
    exact = exact[exact > smallest]
    points = np.geomspace(smallest, largest, classes + 1) if smallest < largest else np.array([largest])
    points[-1] = largest
    size = np.unique(np.concatenate([points, exact, exact * (1.0 - JUMP)]))
    finer, lost = np.asarray(curve.finer_than(size)), float(curve.finer_than(smallest * (1.0 - JUMP)))
    if finer[0] - lost > SPREAD:  # grains of exactly the smallest size
        size, finer = np.append(smallest * (1.0 - JUMP), size), np.append(lost, finer)
    finer[0], finer[-1] = lost, 1.0
    metres = np.array([convert(float(one), curve.unit, "m") for one in size])
    return DemGrading(metres, (finer - lost) / (1.0 - lost), lost)


def _listed(values: Floats) -> str:
    return "[" + ", ".join(f"{value:.9g}" if value % 1.0 else f"{value:.1f}" for value in values) + "]"


def _yade(cut: DemGrading) -> str:
    return (
        "# YADE: makeCloud(..., psdSizes=psdSizes, psdCumm=psdCumm, distributeMass=True); diameters in m\n"
        f"psdSizes = {_listed(cut.size)}\npsdCumm = {_listed(cut.finer)}\n"
    )


def _liggghts(cut: DemGrading, density: float, seed: int) -> str:
    """Write a template for each class that holds mass, of the geometric mean of its ends."""
    mass = np.diff(cut.finer)
    radius = 0.5 * np.sqrt(cut.size[:-1] * cut.size[1:])
    kept = np.flatnonzero(mass > 0.0)
    lines = ["# LIGGGHTS: radii in m, weights by mass"]
    prime, pairs = max(seed, 10_001) - 1, []
    for number, k in enumerate(kept, 1):
        prime = _next_prime(prime)
        lines.append(
            f"fix pts{number} all particletemplate/sphere {prime} atom_type 1 density constant {density:g} "
            f"radius constant {radius[k]:.9g}"
        )
        pairs.append(f"pts{number} {mass[k]:.9g}")
    prime = _next_prime(prime)
    lines.append(
        f"fix pdd all particledistribution/discrete/massbased {prime} {kept.size} &\n  " + " &\n  ".join(pairs)
    )
    return "\n".join(lines) + "\n"


def _mercury(cut: DemGrading) -> str:
    return "".join(f"{0.5 * size:.9g},{finer:.9g}\n" for size, finer in zip(cut.size, cut.finer, strict=True))


def _next_prime(number: int) -> int:
    while True:
        number += 1
        if all(number % divisor for divisor in range(2, math.isqrt(number) + 1)):
            return number

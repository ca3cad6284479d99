"""Gradings as classes of sizes, which packing models take."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
SPACING = 0.02  # of the classes of a curve, in ln(size)
MOST_CLASSES = 2000
ROUNDING = 1e-12  # of the shares of a curve


@dataclass(frozen=True, eq=False)
class SizeClasses:
    """Shares of the solid volume by size; of grains of one density those of the mass.

    Attributes
    ----------
    size : ndarray (N,)
        Sizes of classes whose logs are evenly spaced, fine to coarse.
    share : ndarray (N,)
        Share of each; some may be 0.
    spacing : float
        Distance of their logs.
    exact_size, exact_share : ndarray (Q,)
        Classes of grains of exactly one size.
    fines_size, fines_share : float
        Mean size, in the log, and share of what is finer than the finest known size; a class of its own.
    """

    size: Floats
    share: Floats
    spacing: float
    exact_size: Floats
    exact_share: Floats
    fines_size: float = 0.0
    fines_share: float = 0.0

    @property
    def all_sizes(self) -> Floats:
        """(N + Q + 1,) sizes of all classes that hold grains or may do so."""
        fines = [self.fines_size] if self.fines_share > 0.0 else []
        return np.concatenate([self.size, self.exact_size, fines])

    @property
    def all_shares(self) -> Floats:
        """(N + Q + 1,) their shares."""
        fines = [self.fines_share] if self.fines_share > 0.0 else []
        return np.concatenate([self.share, self.exact_share, fines])

    def with_fines_at(self, size: float) -> SizeClasses:
        """Give the same classes with another size of the fines."""
        return replace(self, fines_size=size)


def classes_of(grading: Grading | SizeCurve | SizeClasses, classes: int | None = None) -> SizeClasses:
    """Divide a grading into classes.

    Exact sizes are classes of their own. The share below the finest point of a curve is one class at the mean size of
    its tail.

    Parameters
    ----------
    grading : Grading or SizeCurve
    classes : int, optional
        Number of classes over the range of the curve; left out, so many that they are about 0.02 wide in ln(size).

    Returns
    -------
    SizeClasses

    Raises
    ------
    ParameterError
        For less than one class.

    Examples
    --------
    >>> import comminute as cm
    >>> found = cm.packing.classes_of(cm.log_uniform(0.01, 1.0), classes=4)
    >>> found.size.round(3), found.share
    (array([0.018, 0.056, 0.178, 0.562]), array([0.25, 0.25, 0.25, 0.25]))
    """
    if isinstance(grading, SizeClasses):
        return grading
    if classes is not None and classes < 1:
        raise parameter_error("classes", classes, "it must be at least 1")
    curve = SizeCurve.of(grading)
    size, finer = curve.size, curve.finer
    jumps = np.flatnonzero(np.diff(size) == 0.0)
    exact_size, exact_share = size[jumps], finer[jumps + 1] - finer[jumps]
    kept = exact_share > 0.0
    exact_size, exact_share = exact_size[kept], exact_share[kept]
    span = math.log(size[-1] / size[0])
    none = np.zeros(0)
    fines = {"fines_share": float(finer[0]), "fines_size": _tail_size(curve)} if finer[0] > 0.0 else {}
    if not span > 0.0:
        return SizeClasses(none, none, 0.0, exact_size, exact_share, **fines)
    count = classes or min(max(math.ceil(span / SPACING - ROUNDING), 1), MOST_CLASSES)
    edges = np.exp(math.log(size[0]) + span / count * np.arange(count + 1))
    edges[[0, -1]] = size[[0, -1]]
    # exact sizes are taken out of the curve, whose other mass is spread between its points
    smooth = SizeCurve(size, finer - _below(size, exact_size, exact_share), curve.unit)
    at_edges = np.concatenate([smooth.finer[:1], smooth.finer_than(edges[1:-1]), smooth.finer[-1:]])
    share = np.diff(at_edges)
    share[share <= ROUNDING] = 0.0  # where the curve is flat but for rounding there are no grains
    return SizeClasses(np.sqrt(edges[1:] * edges[:-1]), share, span / count, exact_size, exact_share, **fines)


def _below(size: Floats, exact_size: Floats, exact_share: Floats) -> Floats:
    """Mass of exact sizes that the curve has passed at each of its points, of two at one size the second alone."""
    passed = np.zeros(size.size)
    for at, share in zip(exact_size, exact_share, strict=True):
        passed[int(np.searchsorted(size, at, side="left")) + 1 :] += share
    return passed


def _tail_size(curve: SizeCurve) -> float:
    """Mean size, in the log, of a power-law tail; the finest size of the curve where there is none."""
    finest = float(curve.size[0])
    return finest * math.exp(-1.0 / curve.tail_slope) if curve.tail_slope > 0.0 else finest

"""Distance between the grading curves of two runs, with what the noise of lattices makes of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from comminute.runs.results import LatticeData, ResolvedData, ResultData
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]

CURVES = 100_000  # drawn to find how far apart noise alone takes two curves
PLACES = 64  # at which each of them is looked at


@dataclass(frozen=True, eq=False)
class Comparison:
    """Distances between two sets of grading curves, load by load; see `compare`.

    Attributes
    ----------
    stress_ratio : ndarray (T,)
        Loads.
    distance : ndarray (T,)
        Largest difference of the two CDFs over the bin edges.
    standard_error : ndarray (T,)
        Standard error of that difference, of both sides together; NaN where a lattice has a single replica.
    size : ndarray (T,)
        Size at that edge.
    each_error : ndarray (2, T)
        Standard error of either side's CDF at that edge: 0 for the continuum, NaN for a lattice of a single replica.
    p_value : ndarray (T,)
        Probability that noise alone takes two curves of one law so far apart; NaN where the noise is not known.
    """

    stress_ratio: Floats
    distance: Floats
    standard_error: Floats
    size: Floats
    each_error: Floats
    p_value: Floats

    @classmethod
    def of(
        cls,
        stress_ratio: Floats,
        size: Floats,
        curves: tuple[Floats, Floats],
        errors: tuple[Floats, Floats],
        replicas: tuple[int, int],
    ) -> Comparison:
        """Compare two sets of curves.

        Parameters
        ----------
        stress_ratio : ndarray (T,)
            Loads.
        size : ndarray (M,)
            Sizes that the curves are given at.
        curves : (ndarray (T, M), ndarray (T, M))
            Mass fraction finer than each size, of either side.
        errors : (ndarray (T, M), ndarray (T, M))
            Standard error of the mean over the replicas of either side: 0 where it is exact, NaN where it is not known.
        replicas : (int, int)
            Replicas from which the errors were estimated.

        Returns
        -------
        Comparison

        Examples
        --------
        >>> import numpy as np
        >>> import comminute as cm
        >>> load, size, exact = np.array([2.0]), np.array([0.5, 1.0]), np.array([[0.30, 1.0]])
        >>> sampled, error = np.array([[0.32, 1.0]]), np.array([[0.01, 0.0]])
        >>> found = cm.Comparison.of(load, size, (exact, sampled), (0.0 * error, error), (1, 4))
        >>> round(float(found.distance[0]), 3), round(float(found.p_value[0]), 1)
        (0.02, 0.5)
        """
        difference = np.abs(curves[0] - curves[1])
        worst = np.argmax(difference, axis=1)
        loads = np.arange(worst.size)
        distance = difference[loads, worst]
        each_error = np.array([error[loads, worst] for error in errors])
        return cls(
            stress_ratio=stress_ratio,
            distance=distance,
            standard_error=np.sqrt((each_error**2).sum(axis=0)),
            size=size[worst],
            each_error=each_error,
            p_value=np.array([_p_value(d, e, replicas) for d, e in zip(distance.tolist(), each_error.T, strict=True)]),
        )

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        if not isinstance(other, Comparison):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]


def compare(result: ResultData | LatticeData, other: ResultData | LatticeData) -> Comparison:
    """CDF distance of two runs under the same loads, with its statistical error.

    The place of a distance is chosen for being the largest, and its error is estimated from few replicas, so a distance
    of two standard errors is no finding: between equal laws, two lattices of four replicas exceed it in a third of all
    runs. `p_value` takes account of both: of the choice by the largest deviation of a Brownian bridge, which the CDF of
    a sample is about its law, and of the few replicas by the scatter of their variance (degrees of freedom of Welch
    and Satterthwaite).

    Parameters
    ----------
    result, other : Result or LatticeResult
        Results on one grid, as from `lattice.run(..., grid=result.grid)`, in either order.

    Returns
    -------
    Comparison

    Raises
    ------
    ParameterError
        For other loads, or another grid.

    Examples
    --------
    >>> import comminute as cm
    >>> continuum = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[2, 8])
    >>> lattice = cm.Lattice(20_000, cm.Material(), cm.gap_graded(1.0, 0.1), replicas=5)
    >>> found = cm.compare(continuum, lattice.run(stress_ratio=[2, 8], grid=continuum.grid))
    >>> bool((found.distance < 0.03).all())
    True
    >>> bool((found.p_value < 0.01).all())  # the continuum keeps two sizes of a neighbourhood, the lattice all
    True
    """
    if not np.array_equal(result.stress_ratio, other.stress_ratio):
        raise parameter_error(
            "other",
            subject="the loads",
            finding=f"differ: {result.stress_ratio} and {other.stress_ratio}",
            rule="compare runs of one load path",
        )
    if result.grid != other.grid:
        raise parameter_error(
            "other",
            subject="the grids",
            finding=f"differ: {result.grid} and {other.grid}",
            rule="compare_closures compares curves at their own sizes"
            if isinstance(result, ResolvedData) or isinstance(other, ResolvedData)
            else "give the lattice's run grid=result.grid",
        )
    errors, replicas = zip(*(_noise(side) for side in (result, other)), strict=True)
    return Comparison.of(result.stress_ratio, result.edge_size, (result.cdf, other.cdf), errors, replicas)


def _noise(side: ResultData | LatticeData) -> tuple[Floats, int]:
    if isinstance(side, LatticeData):
        return side.cdf_error, side.replicas
    return np.zeros_like(side.cdf), 1


def _p_value(distance: float, errors: Floats, replicas: tuple[int, int]) -> float:
    variances = errors**2
    if np.isnan(variances).any():
        return float("nan")
    if variances.sum() == 0.0:
        return 1.0 if distance == 0.0 else 0.0
    scatter = sum(v**2 / (count - 1) for v, count in zip(variances, replicas, strict=True) if v > 0.0)
    freedom = float(variances.sum() ** 2 / scatter)
    random = np.random.default_rng(1)
    noise = _largest_deviations() / np.sqrt(random.chisquare(freedom, CURVES) / freedom)
    as_far = int(np.count_nonzero(noise >= distance / np.sqrt(variances.sum())))
    return (1 + as_far) / (1 + CURVES)


@cache
def _largest_deviations() -> Floats:
    """Deviation of Brownian bridges, in their standard deviations there, where it is largest."""
    random = np.random.default_rng(0)
    share = np.arange(1, PLACES) / PLACES
    walk = random.standard_normal((CURVES, PLACES)).cumsum(axis=1) / np.sqrt(PLACES)
    bridge = np.abs(walk[:, :-1] - share * walk[:, -1:])
    place = bridge.argmax(axis=1)
    deviations: Floats = bridge[np.arange(CURVES), place] / np.sqrt(share * (1.0 - share))[place]
    return deviations

"""Results of a lattice run, with their statistical errors, and how those of the continuum compare."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from comminute._core import ParameterError
from comminute.result import Result
from comminute.util.equality import same_values

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LatticeResult(Result):
    """What a load path did to a lattice: a `Result` whose numbers are means over replicas.

    Attributes
    ----------
    cells, replicas, seed : int
        Size of a ring, number of rings, and the seed of their random numbers.
    cdf_error : ndarray (T, N)
        Standard error of `cdf` from the scatter of the replicas; NaN with a single one.
    crushes_error : ndarray (T,)
        Standard error of `crushes`.

    Examples
    --------
    >>> import comminute as cm
    >>> lattice = cm.Lattice(10_000, cm.Material(), cm.gap_graded(1.0, 0.1), replicas=4)
    >>> result = lattice.run(stress_ratio=[1, 100])
    >>> result.cdf.shape == result.cdf_error.shape
    True
    """

    cells: int
    replicas: int
    seed: int
    cdf_error: Floats
    crushes_error: Floats

    def __repr__(self) -> str:
        loads = f"{self.stress_ratio.size} loads up to {self.stress_ratio.max():g}"
        rings = f"{self.replicas} x {self.cells} cells, {self.crushes[-1]:.3g} crushes a cell"
        return f"<LatticeResult: {loads}, {self.grid.bins} bins, engine {self.engine}, {rings}>"


def mean_and_error(samples: Floats) -> tuple[Floats, Floats]:
    """Mean over the first axis, and its standard error (NaN for a single sample)."""
    count = samples.shape[0]
    mean = np.mean(samples, axis=0)
    if count == 1:
        return mean, np.full_like(mean, math.nan)
    return mean, np.asarray(np.std(samples, axis=0, ddof=1) / math.sqrt(count), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Comparison:
    """How far two sets of grading curves are apart, load by load; see `compare`.

    Attributes
    ----------
    stress_ratio : ndarray (T,)
        Loads.
    distance : ndarray (T,)
        Largest difference of the two CDFs at bin edges.
    standard_error : ndarray (T,)
        Of the lattice's CDF where the difference is largest; NaN with a single replica.
    size : ndarray (T,)
        Where it is largest.
    """

    stress_ratio: Floats
    distance: Floats
    standard_error: Floats
    size: Floats

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        if not isinstance(other, Comparison):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]


def compare(result: Result, lattice_result: LatticeResult) -> Comparison:
    """CDF distance of a run to a lattice under the same loads, with its statistical error.

    Parameters
    ----------
    result : Result
        Of the continuum, or of another lattice.
    lattice_result : LatticeResult
        On the same grid: `lattice.run(..., grid=result.grid)`.

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
    """
    if not np.array_equal(result.stress_ratio, lattice_result.stress_ratio):
        raise ParameterError(
            f"the loads differ: {result.stress_ratio} and {lattice_result.stress_ratio}; compare runs of one load path"
        )
    if result.grid != lattice_result.grid:
        raise ParameterError(
            f"the grids differ: {result.grid} and {lattice_result.grid}; give the lattice's run grid=result.grid"
        )
    difference = np.abs(result.cdf - lattice_result.cdf)
    worst = np.argmax(difference, axis=1)
    loads = np.arange(worst.size)
    return Comparison(
        stress_ratio=result.stress_ratio,
        distance=difference[loads, worst],
        standard_error=lattice_result.cdf_error[loads, worst],
        size=result.edge_size[worst],
    )

"""Distance between the grading curves of continuum and lattice, or of two lattices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from comminute._core import ParameterError
from comminute.runs.results import LatticeData, ResultData
from comminute.util.equality import same_values

Floats = npt.NDArray[np.float64]


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
        Standard error of the lattice's CDF at that edge; NaN with a single replica.
    size : ndarray (T,)
        Size at that edge.
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


def compare(result: ResultData, lattice_result: LatticeData) -> Comparison:
    """CDF distance of a run to a lattice under the same loads, with its statistical error.

    Parameters
    ----------
    result : Result
        Result of the continuum, or of another lattice.
    lattice_result : LatticeResult
        Result on the same grid, from `lattice.run(..., grid=result.grid)`.

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

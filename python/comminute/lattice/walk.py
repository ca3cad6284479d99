"""A lattice along a load path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from comminute._core import LogGrid
from comminute.lattice.rings import Rings
from comminute.lattice.statistics import mean_and_error
from comminute.runs.load_path import Load, LoadPath
from comminute.runs.outcomes import Outcome, rows
from comminute.runs.path_run import PathRun
from comminute.runs.results import LatticeData

Floats = npt.NDArray[np.float64]
R = TypeVar("R", bound=LatticeData)


@dataclass(slots=True, kw_only=True)
class LatticeOutcome(Outcome):
    """State of a lattice after one load: means over the replicas.

    Attributes
    ----------
    cdf_error : ndarray (N,)
        Standard error of the mass fraction finer than each upper bin edge.
    crushed_error : float
        Standard error of the mean number of crushes.
    """

    cdf_error: Floats
    crushed_error: float


class LatticeWalker:
    """Rings on their way along a load path, looked at through a grid."""

    def __init__(self, rings: Rings, grid: LogGrid) -> None:
        self._rings = rings
        self._grid = grid

    def load(self, load: Load, *, with_fabric: bool) -> LatticeOutcome:
        """Load the rings and bin their cells; see `Walker`. A lattice knows no loading rate."""
        self._rings.load_to(load.stress_ratio)
        sizes = self._rings.grainsizes(self._grid)
        grainsize = np.mean(sizes, axis=0)
        crushed, crushed_error = self._rings._mean_crushes()
        return LatticeOutcome(
            grainsize=grainsize,
            crushed=crushed,
            mass_error=float(grainsize.sum() - 1.0),
            points=self._rings.points,
            fabric=self._rings.fabric(self._grid) if with_fabric else None,
            cdf_error=mean_and_error(np.cumsum(sizes, axis=1))[1],
            crushed_error=crushed_error,
        )

    def remix(self) -> None:
        """Shuffle the cells of every ring."""
        self._rings.remix()


def lattice_run(
    make: Callable[..., R], rings: Rings, path: LoadPath, grid: LogGrid, *, wanted: frozenset[int], unit: str
) -> PathRun[LatticeOutcome, R]:
    """Run of a lattice along a load path, on from the state in which it is.

    Parameters
    ----------
    make : callable
        Class of the result, which takes the fields of `LatticeData` by name.
    rings : Rings
        Lattice; the run changes its state.
    path : LoadPath
    grid : LogGrid
        Bins of the result.
    wanted : frozenset of int
        Indices of the loads whose fabric is kept.
    unit : str
        Unit of the sizes; empty where they are relative.

    Returns
    -------
    PathRun

    Raises
    ------
    ParameterError
        If a cell is larger than the grid's last edge.
    """
    start, start_points = rings.fabric(grid), rings.points

    def result_of(outcomes: Sequence[LatticeOutcome]) -> R:
        return make(
            material=rings.material,
            grid=grid,
            start=start,
            unit=unit,
            engine=type(rings).__name__,
            scheme="no bins",
            cells=rings.cells,
            replicas=rings.replicas,
            seed=rings.seed,
            start_points=start_points,
            cdf_error=np.array([outcome.cdf_error for outcome in outcomes]),
            crushes_error=np.array([outcome.crushed_error for outcome in outcomes]),
            **rows(path, outcomes),
        )

    return PathRun(LatticeWalker(rings, grid), path, result_of, wanted=wanted)

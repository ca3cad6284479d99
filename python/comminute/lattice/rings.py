"""The state of a stochastic lattice: many rings at once, loaded and looked at."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from comminute._core import Fabric, LogGrid, Material, PointMass
from comminute._core import Lattice as CoreLattice
from comminute._core import TimeSteppedLattice as CoreTimeSteppedLattice
from comminute.lattice.statistics import mean_and_error
from comminute.util.choices import Mean

Floats = npt.NDArray[np.float64]


class Rings:
    """State of a lattice: independent rings of cells; `Lattice` and `TimeSteppedLattice` are made from it."""

    _core: CoreLattice | CoreTimeSteppedLattice

    def load_to(self, stress_ratio: float) -> int:
        """Load every ring; nothing happens where a larger load has been reached before.

        Ctrl-C stops it with a state that is valid but between loads: the next call, whatever its load,
        first finishes this one.

        Parameters
        ----------
        stress_ratio : float
            Load, >= 0.

        Returns
        -------
        int
            Number of crushes, of all replicas together.

        Raises
        ------
        ParameterError
            For a load that is negative, NaN, or so large that it crushes grains finer than e^-700 of the
            reference size.
        """
        return self._core.load_to(stress_ratio)

    def remix(self) -> None:
        """Shuffle the cells of every ring; forgets the load, since grains meet new neighbours."""
        self._core.remix()

    @property
    def points(self) -> tuple[PointMass, ...]:
        """Mass of the cells that have never crushed, by size, mean over replicas, fine to coarse.

        Empty where the start has more than 16 sizes. In a packing of a few sizes these are the jumps of its cdf.
        """
        return tuple(self._core.points)

    @property
    def psi(self) -> Floats:
        """(replicas, cells) log sizes around the rings; a copy."""
        return self._core.psi

    @property
    def strength(self) -> Floats:
        """(replicas, cells) factor of each cell's critical load; a copy. 1 unless strengths scatter."""
        return np.exp(self._core.log_strength)

    @property
    def crushes(self) -> npt.NDArray[np.uint32]:
        """(replicas, cells) number of times each cell has crushed since the start; a copy."""
        return self._core.crushes

    def _mean_crushes(self) -> tuple[float, float]:
        """Mean number of crushes a cell has been through, and its standard error (NaN with a single replica)."""
        mean, error = mean_and_error(self._core.mean_crushes)
        return float(mean), float(error)

    @property
    def settled_at(self) -> float | None:
        """Largest load under which every ring is at rest; None: never loaded, or interrupted."""
        return self._core.settled_at

    @property
    def cells(self) -> int:
        """Cells of a ring."""
        return self._core.cells

    @property
    def replicas(self) -> int:
        """Number of rings."""
        return self._core.replicas

    @property
    def material(self) -> Material:
        """Material of the grains."""
        return self._core.material

    @property
    def seed(self) -> int:
        """Seed of the random number generator."""
        return self._core.seed

    @property
    def mean(self) -> Mean:
        """Mean by which two neighbours make a neighbourhood grainsize, "arithmetic" or "geometric"."""
        return self._core.mean

    @property
    def threads(self) -> int:
        """Largest number of rings that are worked on at a time; changes no bit of the results."""
        return self._core.threads

    def grainsizes(self, grid: LogGrid) -> Floats:
        """(replicas, N) mass by bin; grains finer than the grid go to the fines bin.

        Raises
        ------
        ParameterError
            If a cell is larger than the grid's last edge.
        """
        return self._core.grainsizes(grid)

    def cdf(self, grid: LogGrid) -> Floats:
        """(N,) mass fraction finer than the upper edge of each bin, mean over replicas."""
        return np.cumsum(np.mean(self.grainsizes(grid), axis=0))

    def cdf_error(self, grid: LogGrid) -> Floats:
        """(N,) standard error of `cdf` from the scatter of the replicas; NaN with a single one."""
        return mean_and_error(np.cumsum(self.grainsizes(grid), axis=1))[1]

    def fabric(self, grid: LogGrid) -> Fabric:
        """Joint histogram of psi and psibar over all replicas, on the continuum's grid.

        Raises
        ------
        ParameterError
            If a cell is larger than the grid's last edge.
        """
        return self._core.fabric(grid)

    def __eq__(self, other: object) -> bool:
        """Equal state and equal future."""
        return type(self) is type(other) and isinstance(other, Rings) and self._core == other._core

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        state = "never loaded" if self.settled_at is None else f"at rest under {self.settled_at:g}"
        return f"<{type(self).__name__}: {self.replicas} x {self.cells} cells, seed {self.seed}, {state}>"

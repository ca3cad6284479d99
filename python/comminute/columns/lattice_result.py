"""Gradings of a column of lattice rows by height and time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from comminute._core import Fabric, Lattice, LogGrid, Material
from comminute.columns.profiles import Profiles
from comminute.util.choices import Mean
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class ColumnLatticeResult(Profiles):
    """Gradings of a column by height and time: T times, Z rows, M cells a row.

    Attributes
    ----------
    z : ndarray (Z,)
        Heights of the rows' middles, in metres of solid, bottom first.
    time : ndarray (T,)
        Times, in seconds.
    stress_ratio : ndarray (T, Z)
        Loads.
    psi : ndarray (T, Z, M)
        ln(size) of the cells around each ring, each of the same mass.
    crushes : ndarray (T, Z)
        Mean number of crushes a grain of a row has been through, wherever it was then.
    grid : LogGrid
        Bins of `pmf`.
    unit : str
        Unit of the sizes.
    exchanges : ndarray (T,)
        Exchanges since the time before; more than one a step where a probability would have passed its limit.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize.
    reference_size : float
        Reference size of the material.

    Examples
    --------
    >>> import comminute as cm
    >>> column = cm.ColumnLattice(cm.Material(), cm.monodisperse(1.0), height=0.02, cells=4, cells_per_row=1000)
    >>> result = column.run(time=[0.0, 1.0], stress_ratio=[8.0, 4.0, 2.0, 1.0], mixing=1e-6)
    >>> result.percentile(50).shape, bool(result.crushes[0, 0] > result.crushes[0, 3])
    ((2, 4), True)
    """

    z: Floats
    time: Floats
    stress_ratio: Floats
    psi: Floats
    crushes: Floats
    grid: LogGrid
    unit: str
    exchanges: npt.NDArray[np.int64]
    mean: str
    reference_size: float

    @property
    def edge_size(self) -> Floats:
        """(N,) sizes at the upper edges of the bins."""
        return self.grid.edge_sizes[1:]

    @property
    def cdf(self) -> Floats:
        """(T, Z, N) mass fraction finer than `edge_size`."""
        return self.cdf_at(self.edge_size)

    @property
    def pmf(self) -> Floats:
        """(T, Z, N) mass by bin; what is finer than the grid is in the first."""
        return np.diff(self.cdf, axis=2, prepend=0.0)

    @property
    def mean_size(self) -> Floats:
        """(T, Z) mean size by mass."""
        return np.asarray(np.exp(self.psi).mean(axis=2))

    def cdf_at(self, sizes: Sequence[float] | Floats) -> Floats:
        """(T, Z, len(sizes)) mass fraction of grains no larger than sizes, from the cells' own sizes."""
        at = np.log(np.asarray(sizes, dtype=np.float64)) + 1e-12
        times, rows, cells = self.psi.shape
        found = np.empty((times, rows, at.size))
        for k in range(times):
            for i in range(rows):
                found[k, i] = np.searchsorted(np.sort(self.psi[k, i]), at, side="right") / cells
        return found

    def percentile(self, percent: float) -> Floats:
        """(T, Z) size D_x that `percent` of the mass is no larger than.

        Raises
        ------
        ParameterError
            For a percentage outside [0, 100].
        """
        if not 0.0 <= percent <= 100.0:
            raise parameter_error("percent", float(percent), "it must be between 0 and 100")
        cells = self.psi.shape[2]
        place = min(max(math.ceil(percent / 100.0 * cells) - 1, 0), cells - 1)
        return np.asarray(np.exp(np.partition(self.psi, place, axis=2)[:, :, place]))

    def fabric(self, k: int, row: int) -> Fabric:
        """Joint histogram of a row's grains and neighbourhoods at time k, on `grid`.

        Raises
        ------
        IndexError
            If there is no such time or row.
        """
        material = Material(reference_size=self.reference_size)
        mean: Mean = "geometric" if self.mean == "geometric" else "arithmetic"
        return Lattice(np.exp(self.psi[k, row]), material, mean=mean).fabric(self.grid)

    def __eq__(self, other: object) -> bool:
        """Equal in every cell."""
        if not isinstance(other, ColumnLatticeResult):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        times, rows, cells = self.psi.shape
        return f"<ColumnLatticeResult: {times} times to {self.time[-1]:g} s, {rows} rows of {cells} cells>"

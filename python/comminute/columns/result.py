"""Gradings of a column by height and time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from comminute._core import Fabric, LogGrid, PointMass, ResolvedGrid
from comminute.columns.profiles import Profiles
from comminute.gradings.curves import SizeCurve
from comminute.util.choices import Mean
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
NO_MASS = 1e-15  # at an exact size, which is rounding


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ColumnResult(Profiles):
    """Gradings of a column by height and time: T times, Z rows, N bins, M nodes (bins and exact sizes).

    Attributes
    ----------
    z : ndarray (Z,)
        Heights of the rows' middles, in metres of solid, bottom first.
    time : ndarray (T,)
        Times, in seconds.
    stress_ratio : ndarray (T, Z)
        Loads.
    mass : ndarray (T, Z, M)
        Mass of the nodes of `grid`.
    crushes : ndarray (T, Z)
        Mean number of crushes a grain of a row has been through, wherever it was then.
    pending : ndarray (T, Z)
        Active mass that has not crushed yet.
    inflow : ndarray (T, M)
        Solid of each node that has come in through the ends since the time before, less what has left, in metres.
    grid : ResolvedGrid
    unit : str
        Unit of the sizes.
    exchanges : ndarray (T,)
        Exchanges since the time before.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize.
    fabric_grid : LogGrid
        Bins of the fabrics.
    fabrics : dict of int to ndarray (Z, B, B)
        Joint laws of grains and neighbourhoods, by time.

    Examples
    --------
    >>> import comminute as cm
    >>> column = cm.Column(cm.Material(), cm.monodisperse(1.0), height=4e-3, cells=4, neighbour_length=1e-3)
    >>> result = column.run(time=[0.0, 1.0], stress_ratio=[8.0, 4.0, 2.0, 1.0], mixing=1e-8)
    >>> result.percentile(50).shape, result.mass_error.max() < 1e-13
    ((2, 4), np.True_)
    """

    z: Floats
    time: Floats
    stress_ratio: Floats
    mass: Floats
    crushes: Floats
    pending: Floats
    inflow: Floats
    grid: ResolvedGrid
    unit: str
    exchanges: npt.NDArray[np.int64]
    mean: Mean
    fabric_grid: LogGrid
    fabrics: Mapping[int, Floats] = field(default_factory=dict)

    @property
    def edge_size(self) -> Floats:
        """(N,) sizes at the upper edges of the bins."""
        return self.grid.edge_sizes[1:]

    @property
    def pmf(self) -> Floats:
        """(T, Z, N) mass by bin, that of an exact size in the bin below it."""
        starts = np.flatnonzero(~self.grid.exact)
        return np.asarray(np.add.reduceat(self.mass, starts, axis=2))

    @property
    def cdf(self) -> Floats:
        """(T, Z, N) mass fraction no larger than `edge_size`."""
        return np.asarray(np.cumsum(self.pmf, axis=2))

    @property
    def fines(self) -> Floats:
        """(T, Z) share of the mass in the fines bin."""
        return np.asarray(self.mass[:, :, 0])

    @property
    def mean_size(self) -> Floats:
        """(T, Z) mean size by mass."""
        width, size = self.grid.upper - self.grid.lower, np.exp(self.grid.upper)
        whole = np.where(width > 0.0, width, 1.0)
        return np.asarray(self.mass @ np.where(width > 0.0, -np.expm1(-width) / whole * size, size))

    @property
    def mass_error(self) -> Floats:
        """(T, Z) difference of a row's mass to 1."""
        return np.asarray(np.abs(self.mass.sum(axis=2) - 1.0))

    def curve(self, k: int = -1, row: int = 0) -> SizeCurve:
        """Grading curve of a row at time k, with its jumps where sizes are exact."""
        mass = self.mass[k, row]
        exact = [
            PointMass(float(self.grid.upper[node]), float(mass[node]), float(np.exp(self.grid.upper[node])))
            for node in np.flatnonzero(self.grid.exact)
            if mass[node] > NO_MASS
        ]
        held = np.flatnonzero(mass > NO_MASS)
        largest = float(np.exp(self.grid.upper[held[-1]]))
        return SizeCurve.on_grid(self.grid, np.minimum(self.cdf[k, row], 1.0), self.unit, exact, largest)

    def cdf_at(self, sizes: Sequence[float] | Floats) -> Floats:
        """(T, Z, len(sizes)) mass fraction of grains no larger than sizes, even in ln(size) within a bin."""
        at = np.log(np.asarray(sizes, dtype=np.float64)) + 1e-12
        lower, upper = self.grid.lower, self.grid.upper
        width = np.where(upper > lower, upper - lower, 1.0)
        below = np.clip((at[:, None] - lower) / width, 0.0, 1.0)
        return np.asarray(self.mass @ np.where(upper > lower, below, at[:, None] >= lower).T)

    def percentile(self, percent: float, *, extrapolate: bool = False) -> Floats:
        """(T, Z) size D_x that `percent` of the mass is finer than.

        Parameters
        ----------
        percent : float
            In [0, 100].
        extrapolate : bool
            Whether to continue a curve that ends in the fines bin as a power law.

        Raises
        ------
        ParameterError
            For a percentage outside [0, 100], or a D_x in the fines bin.
        """
        times, rows = self.crushes.shape
        return np.array(
            [
                [self.curve(k, row).percentile(percent, extrapolate=extrapolate) for row in range(rows)]
                for k in range(times)
            ]
        )

    def fabric(self, k: int, row: int) -> Fabric:
        """Joint law of a row's grains and neighbourhoods at time k, on `fabric_grid`.

        Raises
        ------
        IndexError
            If there is no such time or row.
        ParameterError
            For a time whose fabrics are not kept.
        """
        k = range(self.time.size)[k]
        if k not in self.fabrics:
            kept = ", ".join(map(str, self.fabrics)) or "none"
            raise parameter_error("k", k, f"the fabrics kept are those of the times {kept}; run with fabrics='all'")
        joint = np.maximum(self.fabrics[k][row], 0.0)
        load = float(self.stress_ratio[k, row])
        return Fabric(self.fabric_grid, joint / joint.sum(), settled_at=load or None, mean=self.mean)

    def __eq__(self, other: object) -> bool:
        """Equal in every bit."""
        if not isinstance(other, ColumnResult):
            return NotImplemented
        return same_values(_values(self), _values(other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        times, rows = self.crushes.shape
        return f"<ColumnResult: {times} times to {self.time[-1]:g} s, {rows} rows of {self.grid.nodes} nodes>"


def _values(result: ColumnResult) -> list[object]:
    """Everything that two results are compared by; fabrics by time."""
    fields = {name: value for name, value in vars(result).items() if name != "fabrics"}
    return [*fields.values(), *result.fabrics, *result.fabrics.values()]

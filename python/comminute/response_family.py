"""Response tables over a second variable: a parameter of the initial grading, or the loading rate."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal, Self

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, defaults, fitting_grid
from comminute._core import ResponseFamily as CoreFamily
from comminute.files.response_storage import read_family, save_family
from comminute.gradings.curves import SizeCurve
from comminute.response import ResponseTable, look_up, require_inside
from comminute.util.choices import Mean, Scheme, require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
Numbers = float | Sequence[float] | Floats
By = Literal["stress_ratio", "variable"]
OUTSIDE = 5  # of the core's statuses


class ResponseFamily:
    """Response tables over a second variable: a parameter of the initial grading, or the loading rate.

    A table stands at each node of the variable. Between two nodes everything is linear in the variable: a grading
    there is the mixture of its two neighbours, and sizes such as D50 are linear in their logarithm. Families are
    immutable, and threads share them.

    Parameters
    ----------
    material : Material
    start : callable, or Grading
        Gives the grading at a value of the variable; all must have one largest grain, so that their first crush lies
        at one load. A grading, where the variable is the loading rate.
    values : sequence of float
        Values of the variable, two or more, rising. A table is made at each.
    variable : str
        Name of the variable; "loading_rate" is the share of the fast kernel (Eq. 67), for which `start` is one grading.
    grid : LogGrid, optional
        Grid of all tables; left out, the finest that `fitting_grid` gives for the first and the last start.
    largest : float
        Largest stress ratio, > 0.
    refine : bool
        Make tables between the values too, by halving, wherever the family is off by more than the tolerance.
    tolerance : float
        Error of the mass finer than the edge of any bin, between the nodes. Each table keeps to a fifth of it.
    quantities : sequence of str
        Indices to be looked up; see `ResponseTable`.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize.
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`.

    Raises
    ------
    ParameterError
        For a value outside its range, starts whose largest grains or exact sizes differ, or a tolerance that takes too
        many tables. Sizes that are all scaled alike need no family: by one table their loads scale as the size to the
        power -3/w.

    Examples
    --------
    >>> import comminute as cm
    >>> sand = lambda dimension: cm.power_law(dimension, 0.01, 1.0)
    >>> family = cm.ResponseFamily(cm.Material(), sand, [2.2, 2.6], variable="fractal dimension", largest=100.0)
    >>> coarse, fine = family.value("d50", 30.0, [2.2, 2.6])
    >>> bool(fine < coarse), bool(family.derivative("d50", 30.0, 2.4, by="variable") < 0.0)
    (True, True)
    """

    _core: CoreFamily
    unit: str
    variable: str

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Callable[[float], Grading] | Grading,
        values: Sequence[float],
        *,
        variable: str = "value",
        grid: LogGrid | None = None,
        largest: float = 1e4,
        refine: bool = True,
        tolerance: float = defaults["ResponseFamily"]["tolerance"],
        quantities: Sequence[str] = ("d50", "breakage"),
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        by_rate = variable == "loading_rate"
        if by_rate != isinstance(start, Grading):
            rule = "it must be a Grading for the loading rate, and a function of the variable for anything else"
            raise parameter_error("start", type(start).__name__, rule)
        nodes = [float(value) for value in values]
        if len(nodes) < 2:
            raise parameter_error("values", str(nodes), "there must be two or more")
        if not tolerance > 0.0:
            raise parameter_error("tolerance", tolerance, "it must be greater than 0")

        def grading(value: float) -> Grading:
            return start if isinstance(start, Grading) else start(value)

        ends = [grading(nodes[0]), grading(nodes[-1])]
        on = grid or _common([fitting_grid(end, material, largest) for end in ends])

        def table(value: float) -> ResponseTable:
            rate = value if by_rate else 0.0
            return ResponseTable(
                material,
                grading(value),
                on,
                largest,
                tolerance=0.2 * tolerance,
                quantities=quantities,
                loading_rate=rate,
                mean=mean,
                scheme=scheme,
            )

        if refine:
            self._core = CoreFamily.refined(nodes, lambda value: table(value).core, tolerance)
        else:
            self._core = CoreFamily(nodes, [table(value).core for value in nodes])
        self.unit, self.variable = ends[0].unit, variable

    @property
    def grid(self) -> LogGrid:
        """Bins of the gradings."""
        return self._core.tables[0].grid

    @property
    def values(self) -> Floats:
        """(M,) nodes of the variable, rising."""
        return self._core.values

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the indices that are looked up; sizes such as "d50", "crushes" and "fines" always are."""
        return tuple(self._core.tables[0].scalars)

    @property
    def nbytes(self) -> int:
        """Bytes of memory."""
        return self._core.memory

    def table(self, node: int) -> ResponseTable:
        """Table of a node, by its index."""
        return ResponseTable.of_core(self._core.tables[node], self.unit)

    def value(self, name: str, stress_ratio: Numbers, value: Numbers) -> Floats:
        """Look a number up under loads at values of the variable.

        Parameters
        ----------
        name : str
            A size such as "d50", "crushes", "fines", or one of `quantities`.
        stress_ratio : float or array_like
            Largest loads so far, >= 0 and no larger than the tables'.
        value : float or array_like
            Values of the variable; the two are broadcast.

        Returns
        -------
        ndarray
            Of the broadcast shape.

        Raises
        ------
        ParameterError
            For a name, a load or a value that the family does not know, or a size in the fines bin.
        """
        return self._look_up(name, stress_ratio, value)[0]

    def derivative(self, name: str, stress_ratio: Numbers, value: Numbers, *, by: By = "stress_ratio") -> Floats:
        """Look the derivative of a number by the stress ratio up, or by the variable.

        Parameters and errors are those of `value`.
        """
        require_word("by", by, By)
        return self._look_up(name, stress_ratio, value)[1 if by == "stress_ratio" else 2]

    def cdf(self, stress_ratio: float, value: float) -> Floats:
        """(N,) mass finer than the upper edge of each bin, `grid.edge_sizes[1:]`.

        Raises
        ------
        ParameterError
            For a load or a value that the family does not know.
        """
        cdf, status, _ = self._core.grading(stress_ratio, value)
        self._require(np.array([status]), "cdf", np.array([stress_ratio]), np.array([value]))
        return cdf

    def pmf(self, stress_ratio: float, value: float) -> Floats:
        """(N,) mass by bin of `grid`, exact sizes in their bins; errors as of `cdf`."""
        return np.diff(self.cdf(stress_ratio, value), prepend=0.0)

    def curve(self, stress_ratio: float, value: float) -> SizeCurve:
        """Grading curve, with its jumps where sizes are exact; errors as of `cdf`."""
        rising = np.maximum.accumulate(self.cdf(stress_ratio, value))
        points = self._core.grading(stress_ratio, value)[2]
        return SizeCurve.on_grid(self.grid, rising, self.unit, points, self._core.tables[0].largest)

    def __bytes__(self) -> bytes:
        """Version, nodes, tables and a checksum, for `from_bytes` here and in C++ hosts; names are not among them."""
        return self._core.to_bytes()

    @classmethod
    def from_bytes(cls, content: bytes, variable: str = "value", unit: str = "") -> Self:
        """Family of what `bytes` of a family gave.

        Raises
        ------
        ParameterError
            For bytes that are no family, of another version, damaged or cut short.
        """
        family = cls.__new__(cls)
        family._core, family.variable, family.unit = CoreFamily.from_bytes(content), variable, unit
        return family

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a NetCDF file (.nc), complete or not at all: nodes, gradings, and the family to the bit.

        Raises
        ------
        ParameterError
            For a path with another ending.
        ImportError
            Naming the extra to install.
        """
        target = Path(path)
        if target.suffix != ".nc":
            raise parameter_error("path", f"'{target}'", "it must end in .nc")
        loads = self._core.tables[0].stress_ratios
        gradings = np.array([[self.cdf(load, value) for load in loads] for value in self.values])
        return save_family(self._core, gradings, self.variable, self.unit, target)

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file that `save` wrote.

        Raises
        ------
        ParameterError
            For a file that is missing, damaged, or holds no family.
        ImportError
            Naming the extra to install.
        """
        return cls.from_bytes(*read_family(Path(path)))

    def _look_up(self, name: str, stress_ratio: Numbers, value: Numbers) -> tuple[Floats, Floats, Floats]:
        loads, values = np.broadcast_arrays(np.asarray(stress_ratio, float), np.asarray(value, float))
        flat, at = loads.reshape(-1), values.reshape(-1)
        *found, status = look_up(self._core, name, self.quantities, flat, at)
        self._require(status, name, flat, at)
        first, second, third = (numbers.reshape(loads.shape) for numbers in found)
        return first, second, third

    def _require(self, status: npt.NDArray[np.uint8], name: str, loads: Floats, values: Floats) -> None:
        outside = np.flatnonzero(status == OUTSIDE)
        if outside.size:
            low, high = self.values[[0, -1]]
            rule = f"the family goes from {low:g} to {high:g}"
            raise parameter_error(self.variable, float(values[outside[0]]), rule)
        require_inside(status, name, float(self._core.tables[0].stress_ratios[-1]), stress_ratio=loads)

    def __reduce__(self) -> tuple[object, tuple[bytes, str, str]]:
        """Pickle by the bytes and the names."""
        return type(self).from_bytes, (bytes(self), self.variable, self.unit)

    def __eq__(self, other: object) -> bool:
        """Equal in every number, the variable and the unit."""
        if not isinstance(other, ResponseFamily):
            return False
        return self._core == other._core and (self.variable, self.unit) == (other.variable, other.unit)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        nodes = f"{self.values.size} tables, {self.variable} {self.values[0]:g} to {self.values[-1]:g}"
        return f"<ResponseFamily: {nodes}, {self.grid.bins} bins, {self.nbytes / 1e6:.2g} MB>"


def _common(grids: Sequence[LogGrid]) -> LogGrid:
    """Give a grid that reaches as far down and up, and is as fine, as any of these."""
    if all(grid == grids[0] for grid in grids):
        return grids[0]
    low, high = min(grid.psi_min for grid in grids), max(grid.psi_max for grid in grids)
    spacing = min(grid.spacing for grid in grids)
    bins = int(np.ceil((high - low) / spacing)) + 1
    return LogGrid(high - (bins - 1) * spacing, high, bins)

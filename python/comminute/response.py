"""Response tables: the settled grading of one packing against the load, for material points and for reading off."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Fabric,
    Grading,
    LogGrid,
    Material,
    defaults,
    needed_spacing,
)
from comminute._core import ResponseTable as CoreTable
from comminute.files.response_storage import read_table, save_table
from comminute.gradings.curves import SizeCurve
from comminute.gradings.named import named_index, percent_of
from comminute.runs.remarks import ResolutionWarning, fines_warnings, spacing_warnings
from comminute.starts import fabric_of
from comminute.util.choices import Mean, Scheme, require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
ABOVE, BAD_LOAD, IN_FINES = 1, 2, 3  # of the core's statuses; 0 is inside


class Readable(Protocol):
    """The core of a table, or of a family of them, whose look-ups take one place more."""

    def crushes(self, *where: Any) -> Any:
        """Look up the mean number of crushes a cell has been through."""
        ...

    def finer(self, bin: int, *where: Any) -> Any:
        """Look up the mass finer than the upper edge of a bin."""
        ...

    def scalar(self, name: str, *where: Any) -> Any:
        """Look up a scalar."""
        ...

    def percentile(self, percent: float, *where: Any) -> Any:
        """Look up a size by the percentage that is finer."""
        ...


def look_up(core: Readable, name: str, quantities: Sequence[str], *where: Floats) -> Any:
    """Look a number up by its name: values, derivatives, statuses.

    Raises
    ------
    ParameterError
        For a name that is no size and none of the quantities.
    """
    percent = percent_of(name)
    if percent is not None and percent <= 100.0:
        return core.percentile(percent, *where)
    if name == "crushes":
        return core.crushes(*where)
    if name == "fines":
        return core.finer(0, *where)
    if name in quantities:
        return core.scalar(name, *where)
    known = ", ".join(("crushes", "fines", *quantities))
    raise parameter_error("name", f"'{name}'", f"it must be a size such as d50, or one of {known}")


def require_inside(status: npt.NDArray[np.uint8], name: str, most: float, *, stress_ratio: Floats) -> None:
    """Raise ParameterError for the first load that a table, which goes to `most`, does not know."""
    bad = np.flatnonzero(status)
    if bad.size == 0:
        return
    first = int(bad[0])
    load = float(stress_ratio[first])
    if status[first] == IN_FINES:
        raise parameter_error(name, load, subject=name, finding=f"lies in the fines bin at stress ratio {load:g}")
    rule = f"the table goes from 0 to {most:.6g}"
    raise parameter_error(f"stress_ratio[{first}]" if stress_ratio.size > 1 else "stress_ratio", load, rule)


class ResponseTable:
    """Settled gradings of one packing against the load, to a stated tolerance.

    A closed material point that starts from a known packing has one internal variable, its largest load. The loads of
    the table follow the response; between them every number is a monotone cubic in ln(stress ratio). Percentiles are
    read from the interpolated grading, and jump where it has exact sizes. Tables are immutable, and threads share them.

    Parameters
    ----------
    material : Material
    start : Grading or Fabric
        A grading is mixed completely (Eq. 64); a fabric must not have been loaded.
    grid : LogGrid, optional
        Grid for a grading; left out, one is sized from grading, fragments and largest load (`fitting_grid`).
    largest : float
        Largest stress ratio of the table, > 0.
    tolerance : float
        Error of the mass finer than the edge of any bin, between the loads of the table.
    quantities : sequence of str
        Indices to be looked up beside sizes such as "d50", "crushes" and "fines", which always are: "breakage" (Einav),
        "relative_breakage" (Hardin), "uniformity", "curvature".
    loading_rate : float
        Share of the fast kernel (Eq. 67), in [0, 1].
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize, for a grading.
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`.

    Raises
    ------
    ParameterError
        For a value outside its range, a start that has been loaded, or a quantity it does not know.

    Warns
    -----
    ResolutionWarning
        If the bins are too wide for the start or the fragments, or more than 1 % of the mass ends in the fines bin.

    Examples
    --------
    >>> import comminute as cm
    >>> table = cm.ResponseTable(cm.Material(), cm.power_law(2.5, 0.01, 1.0), largest=1000.0)
    >>> coarse, fine = table.value("d50", [0.5, 100.0])
    >>> bool(fine < coarse), float(table.value("crushes", 0.5))
    (True, 0.0)
    >>> bool(table.derivative("breakage", 10.0) > 0.0)
    True
    """

    _core: CoreTable
    unit: str

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Fabric,
        grid: LogGrid | None = None,
        largest: float = 1e4,
        *,
        tolerance: float = defaults["ResponseTable"]["tolerance"],
        quantities: Sequence[str] = ("d50", "breakage"),
        loading_rate: float = 0.0,
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        require_word("scheme", scheme, Scheme)
        if not 0.0 < largest < np.inf:
            raise parameter_error("largest", float(largest), "it must be greater than 0 and finite")
        fabric = fabric_of(material, start, grid, largest, mean)
        self.unit = start.unit if isinstance(start, Grading) else ""
        self._core = CoreTable(material, fabric, largest, tolerance, loading_rate, scheme)
        needed = needed_spacing(material, start) if isinstance(start, Grading) else needed_spacing(material)
        self._warn(needed, float(fabric.grainsize()[0]))
        curves = [self.curve(load) for load in self.loads]
        before = SizeCurve.of(start) if isinstance(start, Grading) else curves[0]
        for name in quantities:
            if percent_of(name) is None and name not in ("crushes", "fines"):
                index = named_index(name, before)
                self._core = self._core.with_scalar(name, [index(curve) for curve in curves])

    def _warn(self, needed: float, first_fines: float) -> None:
        loads = self.loads[-1:]
        pmf = self.pmf(float(loads[0]))[None, :]
        found = [*spacing_warnings(self.grid, needed), *fines_warnings(self.grid, first_fines, loads, pmf, self.unit)]
        for warning in found:
            warnings.warn(warning, ResolutionWarning, stacklevel=4)

    @property
    def core(self) -> CoreTable:
        """Core that this table reads, for families of tables."""
        return self._core

    @classmethod
    def of_core(cls, core: CoreTable, unit: str = "") -> Self:
        """Table of its core."""
        table = cls.__new__(cls)
        table._core, table.unit = core, unit
        return table

    @property
    def grid(self) -> LogGrid:
        """Bins of the gradings."""
        return self._core.grid

    @property
    def loads(self) -> Floats:
        """(T,) stress ratios of the table, rising; at the first nothing has crushed."""
        return self._core.stress_ratios

    @property
    def tolerance(self) -> float:
        """Error of the mass finer than the edge of any bin, between the loads."""
        return self._core.tolerance

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the indices that are looked up; sizes such as "d50", "crushes" and "fines" always are."""
        return tuple(self._core.scalars)

    @property
    def nbytes(self) -> int:
        """Bytes of memory."""
        return self._core.memory

    def value(self, name: str, stress_ratio: float | Sequence[float] | Floats) -> Floats:
        """Look a number up under loads; below the first crush it is that of the start.

        Parameters
        ----------
        name : str
            A size such as "d50", "crushes", "fines", or one of `quantities`.
        stress_ratio : float or array_like
            Largest loads so far, >= 0 and no larger than the table's.

        Returns
        -------
        ndarray
            Of the loads' shape.

        Raises
        ------
        ParameterError
            For a name or a load that the table does not know, or a size in the fines bin.
        """
        return self._look_up(name, stress_ratio)[0]

    def derivative(self, name: str, stress_ratio: float | Sequence[float] | Floats) -> Floats:
        """Look the derivative of a number by the stress ratio up; 0 below the first crush, and where a size is exact.

        Parameters and errors are those of `value`.
        """
        return self._look_up(name, stress_ratio)[1]

    def pmf(self, stress_ratio: float) -> Floats:
        """(N,) mass by bin of `grid` under a load, exact sizes in their bins.

        Raises
        ------
        ParameterError
            For a load that the table does not know.
        """
        return np.diff(self.cdf(stress_ratio), prepend=0.0)

    def cdf(self, stress_ratio: float) -> Floats:
        """(N,) mass finer than the upper edge of each bin, `grid.edge_sizes[1:]`, under a load.

        Raises
        ------
        ParameterError
            For a load that the table does not know.
        """
        cdf, status, _ = self._core.grading(stress_ratio)
        self._require(np.array([status]), np.array([stress_ratio]), "cdf")
        return cdf

    def curve(self, stress_ratio: float) -> SizeCurve:
        """Grading curve under a load, with its jumps where sizes are exact.

        Raises
        ------
        ParameterError
            For a load that the table does not know.
        """
        cdf, status, points = self._core.grading(stress_ratio)
        self._require(np.array([status]), np.array([stress_ratio]), "curve")
        rising = np.maximum.accumulate(cdf)  # bins are interpolated one by one, and may cross by rounding
        return SizeCurve.on_grid(self.grid, rising, self.unit, points, self._core.largest)

    def __bytes__(self) -> bytes:
        """Version, numbers and a checksum, for `from_bytes` here and in C++ hosts; the unit is not among them."""
        return self._core.to_bytes()

    @classmethod
    def from_bytes(cls, content: bytes, unit: str = "") -> Self:
        """Table of what `bytes` of a table gave.

        Raises
        ------
        ParameterError
            For bytes that are no table, of another version, damaged or cut short.
        """
        return cls.of_core(CoreTable.from_bytes(content), unit)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a NetCDF file (.nc), complete or not at all: loads, gradings and scalars, and the table to the bit.

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
        gradings = np.array([self.cdf(load) for load in self.loads])
        names = ("crushes", "fines", *self.quantities)
        numbers = {name: self.value(name, self.loads) for name in names}
        return save_table(self._core, gradings, numbers, self.unit, target)

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file that `save` wrote.

        Raises
        ------
        ParameterError
            For a file that is missing, damaged, or holds no table.
        ImportError
            Naming the extra to install.
        """
        return cls.from_bytes(*read_table(Path(path)))

    def _look_up(self, name: str, stress_ratio: float | Sequence[float] | Floats) -> tuple[Floats, Floats]:
        loads = np.asarray(stress_ratio, dtype=np.float64)
        flat = loads.reshape(-1)
        value, derivative, status = look_up(self._core, name, self.quantities, flat)
        self._require(status, flat, name)
        return value.reshape(loads.shape), derivative.reshape(loads.shape)

    def _require(self, status: npt.NDArray[np.uint8], loads: Floats, name: str) -> None:
        require_inside(status, name, float(self.loads[-1]), stress_ratio=loads)

    def __eq__(self, other: object) -> bool:
        """Equal in every number and the unit."""
        return isinstance(other, ResponseTable) and self._core == other._core and self.unit == other.unit

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        loads = f"{self.loads.size} loads up to {self.loads[-1]:g}, {self.grid.bins} bins"
        return f"<ResponseTable: {loads}, tolerance {self.tolerance:g}, {self.nbytes / 1e6:.2g} MB>"

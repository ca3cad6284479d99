"""Material points: thousands of packings of one material, stepped by a host code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Self, TypeVar

import numpy as np
import numpy.typing as npt

from comminute._core import Fabric, Grading, LogGrid, Material
from comminute._core import MaterialPoints as CorePoints
from comminute.gradings.curves import SizeCurve
from comminute.starts import fabric_of
from comminute.util.choices import Mean, Scheme, require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
Storage = Literal["float64", "float32"]
Contents = Literal["states", "gradings"]
MergedLoad = Literal["smaller", "never"]
T = TypeVar("T", bound=np.generic)


class MaterialPoints:
    """Thousands of material points of one material, such as those of a finite-element or material-point code.

    Each point has a begin state, that of the last accepted step. `trial` takes all points from there to new loads and
    leaves the begin states alone, as often as an implicit host iterates; `commit` makes the end states the begin
    states, `discard` drops them. `update` is a trial and its commit in one. The points share their start until they
    first crush.

    Parameters
    ----------
    material : Material
    start : Grading or Fabric
        State of all points. A grading is mixed completely (Eq. 64). Exact sizes go into bins.
    count : int
        Number of points, >= 1.
    grid : LogGrid, optional
        Grid for a grading; left out, one is sized from grading, fragments and largest load (`fitting_grid`).
    largest : float
        Largest stress ratio that the grid is sized for.
    dtype : {"float64", "float32"}
        Numbers in which states are kept; all arithmetic is in float64. States in float32 are scaled to a total of 1
        whenever they are read.
    keep : {"states", "gradings"}
        A point keeps its fabric, N x N numbers, or 2 N: its grading when the packing was last mixed, from which the
        fabric follows, and its grading now. As exact, for points that are loaded at one loading rate between two
        mixings.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize, for a grading.
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`.

    Raises
    ------
    ParameterError
        For a value outside its range, or a start that has been loaded where gradings are kept.

    Examples
    --------
    >>> import numpy as np
    >>> import comminute as cm
    >>> points = cm.MaterialPoints(cm.Material(), cm.power_law(2.5, 0.01, 1.0), count=3, largest=100.0)
    >>> points.update(np.array([0.5, 10.0, 100.0]))
    array([0, 0, 0], dtype=uint8)
    >>> points.update(np.array([5.0, 5.0, -1.0]))  # unloads the second
    array([0, 0, 1], dtype=uint8)
    >>> points.settled_at
    array([  5.,  10., 100.])
    >>> points.message(2)
    'stress_ratio[2] is -1; it must be a number of at least 0 (0 is no load)'
    """

    _core: CorePoints
    unit: str

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Fabric,
        count: int,
        grid: LogGrid | None = None,
        largest: float = 1e4,
        dtype: Storage = "float64",
        *,
        keep: Contents = "states",
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        require_word("dtype", dtype, Storage)
        require_word("keep", keep, Contents)
        require_word("scheme", scheme, Scheme)
        if not 0.0 < largest < np.inf:
            raise parameter_error("largest", float(largest), "it must be greater than 0 and finite")
        fabric = fabric_of(material, start, grid, largest, mean)
        self.unit = start.unit if isinstance(start, Grading) else ""
        self._core = CorePoints(material, fabric, count, dtype == "float32", keep == "gradings", scheme)

    def __len__(self) -> int:
        """Give the number of points."""
        return self._core.count

    @property
    def grid(self) -> LogGrid:
        """Bins of the states."""
        return self._core.grid

    @property
    def material(self) -> Material:
        """Material of all points."""
        return self._core.material

    @property
    def scheme(self) -> Scheme:
        """Scheme by which the continuum becomes bins."""
        return self._core.scheme

    @property
    def dtype(self) -> Storage:
        """Numbers in which states are kept."""
        return "float32" if self._core.single else "float64"

    @property
    def keep(self) -> Contents:
        """State that a point keeps: its fabric, or two gradings."""
        return "gradings" if self._core.gradings_alone else "states"

    @property
    def nbytes(self) -> int:
        """Bytes of memory for states, those of trials among them."""
        return self._core.memory

    def update(
        self,
        stress_ratio: float | Sequence[float] | Floats,
        remix: bool | Sequence[bool] | npt.NDArray[np.bool_] | None = None,
        threads: int = 1,
        *,
        loading_rate: float | Sequence[float] | Floats = 0.0,
    ) -> npt.NDArray[np.uint8]:
        """Take all points to new loads: a trial and its commit in one.

        Parameters
        ----------
        stress_ratio : float or array_like (P,)
            Loads, >= 0. A load up to `settled_at` changes nothing.
        remix : bool or array_like (P,), optional
            Points whose packing is mixed anew before the load comes.
        threads : int
            At most so many at a time; no bit depends on it.
        loading_rate : float or array_like (P,)
            Share of the fast kernel (Eq. 67), in [0, 1].

        Returns
        -------
        ndarray (P,) of uint8
            0: done. Else the point keeps its begin state, and `message` says why: 1: its load is NaN or negative; 2:
            its loading rate is outside [0, 1]; 3: its rate is another than since its last mixing, and gradings are
            kept.

        Raises
        ------
        ShapeError
            For arrays of another length.
        ParameterError
            For fewer threads than 1.
        """
        return self._step(True, stress_ratio, remix, threads, loading_rate)

    def trial(
        self,
        stress_ratio: float | Sequence[float] | Floats,
        remix: bool | Sequence[bool] | npt.NDArray[np.bool_] | None = None,
        threads: int = 1,
        *,
        loading_rate: float | Sequence[float] | Floats = 0.0,
    ) -> npt.NDArray[np.uint8]:
        """Compute end states from the begin states, which stay; an earlier trial is dropped.

        Parameters, results and errors are those of `update`.
        """
        return self._step(False, stress_ratio, remix, threads, loading_rate)

    def commit(self) -> None:
        """Make the end states of the trial the begin states; without a trial nothing changes."""
        self._core.commit()

    def discard(self) -> None:
        """Drop the end states of the trial."""
        self._core.discard()

    def message(self, i: int) -> str:
        """Tell why a point was not done in the last step, in at most 511 characters; empty for one that was."""
        return self._core.message(i)

    def gradings(self, *, end: bool = False) -> Floats:
        """(P, N) mass by bin of `grid`, of the begin states, or of the end states of a trial."""
        return self._core.gradings(end)

    @property
    def settled_at(self) -> Floats:
        """(P,) load under which each begin state is at rest; 0 for one that was never loaded or is freshly mixed."""
        return self._core.settled_at

    @property
    def end_settled_at(self) -> Floats:
        """(P,) the same of the end states of a trial; of the begin states where none waits."""
        return self._core.end_settled_at

    @property
    def crushed(self) -> Floats:
        """(P,) mass crushed in psi in the last step, every crush counted."""
        return self._core.crushed

    def curve(self, i: int) -> SizeCurve:
        """Grading curve of a point's begin state: percentiles, sieves, plots."""
        finer = np.cumsum(self._core.grading(i))
        return SizeCurve.on_grid(self.grid, finer, self.unit, [], self._core.largest(i))

    def fabric(self, i: int) -> Fabric:
        """Begin state of a point; where gradings are kept it is computed anew from the last mixing."""
        return self._core.fabric(i)

    def shares_start(self, i: int) -> bool:
        """Tell whether a point still shares the start."""
        return self._core.shares_start(i)

    def merge(self, i: int, j: int, masses: tuple[float, float], *, settled_at: MergedLoad = "smaller") -> None:
        """Mix two points by their masses into the first; the second stays as it is, for its host to drop.

        The first then has (m_i p_i + m_j p_j) / (m_i + m_j). Where gradings are kept, which do not tell what lies
        beside what, it is mixed anew. A trial that waits is dropped.

        Parameters
        ----------
        i, j : int
            Two points.
        masses : (float, float)
            Their masses, >= 0, not both 0.
        settled_at : {"smaller", "never"}
            Load under which the merged point counts as at rest. "smaller": the smaller of the two. Mass of the other
            point that has crushed to the edge of its larger zone then counts as spread evenly outside the smaller
            zone, so that some of it, in the cells that an edge cuts, is tested again. "never": 0, all mass counts as
            freshly filled in.

        Raises
        ------
        ParameterError
            For points or masses outside their range.
        """
        require_word("settled_at", settled_at, MergedLoad)
        mass_i, mass_j = masses
        self._core.merge(i, j, mass_i, mass_j, settled_at == "never")

    def copy(self) -> Self:
        """Clone all points, a trial that waits among their states."""
        return self._with(self._core.clone(), self.unit)

    def pack(self) -> bytes:
        """All begin states with material, grid and start, for `unpack` here and in C++ hosts; the unit is left out."""
        return self._core.pack()

    @classmethod
    def unpack(cls, content: bytes, unit: str = "") -> Self:
        """Points that go on, to the bit, where `pack` found them.

        Raises
        ------
        ParameterError
            For bytes that are no points, of another version, damaged or cut short.
        """
        return cls._with(CorePoints.unpack(content), unit)

    def pack_point(self, i: int) -> bytes:
        """Begin state of one point, to be sent to other points of the same grid, start and options."""
        return self._core.pack_point(i)

    def unpack_point(self, i: int, content: bytes) -> None:
        """Take the begin state that `pack_point` gave.

        Raises
        ------
        ParameterError
            As `unpack`, and for another grid, start, dtype or contents.
        """
        self._core.unpack_point(i, content)

    @classmethod
    def _with(cls, core: CorePoints, unit: str) -> Self:
        points = cls.__new__(cls)
        points._core, points.unit = core, unit
        return points

    def _step(
        self,
        commits: bool,
        stress_ratio: float | Sequence[float] | Floats,
        remix: bool | Sequence[bool] | npt.NDArray[np.bool_] | None,
        threads: int,
        loading_rate: float | Sequence[float] | Floats,
    ) -> npt.NDArray[np.uint8]:
        mixing = self._each(np.asarray(False if remix is None else remix, dtype=np.bool_)).astype(np.uint8)
        loads = self._each(np.asarray(stress_ratio, dtype=np.float64, order="C"))
        rates = self._each(np.asarray(loading_rate, dtype=np.float64, order="C"))
        return self._core.step(commits, loads, mixing, rates, threads)

    def _each(self, given: npt.NDArray[T]) -> npt.NDArray[T]:
        """Give an array of one number for each point, of an array or a number."""
        return np.full(len(self), given) if given.ndim == 0 else given

    def __reduce__(self) -> tuple[object, tuple[bytes, str]]:
        """Pickle by what `pack` gives."""
        return type(self).unpack, (self.pack(), self.unit)

    def __eq__(self, other: object) -> bool:
        """Equal in material, grid, start, every begin state and the unit."""
        return isinstance(other, MaterialPoints) and self.pack() == other.pack() and self.unit == other.unit

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        kind = f"{self.grid.bins} bins, {self.dtype} {self.keep}"
        return f"<MaterialPoints: {len(self)} of {kind}, {self.nbytes / 1e6:.2g} MB>"

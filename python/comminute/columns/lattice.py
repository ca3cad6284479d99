"""The column of lattice rows, as its users meet it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, Self, TypedDict, Unpack, cast

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Grading,
    Lattice,
    LogGrid,
    Material,
    ShapeError,
    _ColumnLattice,
    _ColumnOptions,
    defaults,
    fitting_grid,
)
from comminute.columns.drive import Given, ShearMixing
from comminute.columns.lattice_result import ColumnLatticeResult
from comminute.columns.running import drive_of, walk
from comminute.util.choices import Mean, require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
Partners = Literal["permuted", "shift", "locked"]
CrushOrder = Literal["random", "weakest"]
SwapRates = Literal["pair", "flowslm"]
DEFAULTS, DRIVE = defaults["ColumnLattice"], defaults["ColumnLattice.run"]


class ColumnOptions(TypedDict, total=False):
    """Options of a column; one that is left out has the core's default, `_core.defaults`."""

    seed: int
    mean: Mean
    partners: Partners
    order: CrushOrder
    rates: SwapRates
    largest_mixing: float
    largest_segregation: float
    threads: int


def _options(given: ColumnOptions) -> _ColumnOptions:
    """Options for the core, the given ones and its own defaults."""
    for name in given:
        if name not in DEFAULTS:
            raise TypeError(f"there is no option {name}; it must be one of {', '.join(DEFAULTS)}")
    options = cast("ColumnOptions", dict(DEFAULTS) | given)
    require_word("partners", options["partners"], Partners)
    require_word("order", options["order"], CrushOrder)
    require_word("rates", options["rates"], SwapRates)
    return _ColumnOptions(**options)


class ColumnLattice:
    """A column of stochastic lattice rows that mix, segregate and crush: the witness of open systems (Section 8.3).

    A row is a ring of cells, as of `Lattice`, at one height; each cell stands for the same mass, each row for the same
    height of solid. In an exchange every cell of a row may change places with one of the row above, by mixing and,
    where it is the larger of the two, by segregation. A time in which a probability would pass its limit is divided;
    none is ever cut. Then cells that have come to be active crush.

    An exchange of the probability q is off by an error of the first order in q, some q in a profile; smaller limits, or
    two of them and Richardson's rule, take it away.

    Parameters
    ----------
    material : Material
    start : Grading, or sequence of Grading
        Grading of all rows, or of each, bottom first.
    height : float
        Height of the column, in metres of solid.
    cells : int
        Number of rows, 2 or more. Their distance is also the length over which a grain meets new neighbours.
    cells_per_row : int
        Number of cells of a row.
    seed : int
        Seed of the random numbers. Without an exchange row z is replica z of a `Lattice` of the same seed, bit for bit.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize.
    partners : {"permuted", "shift", "locked"}
        Which cell above a cell may change places with: another at random each time, which is what shear between the
        rows does and the limit of ever shorter times; that at one random distance for the whole row; always the same.
    order : {"random", "weakest"}
        Which active cell crushes first after an exchange: any, the limit of a large crushing rate, or the weakest.
        While a load rises it is always the weakest.
    rates : {"pair", "flowslm"}
        Probability of segregation by the difference of the two sizes; or by that of each to the mean of its row.
    largest_mixing, largest_segregation : float
        Limits of the probabilities of one exchange, at most 1; what they leave is an error of first order.
    threads : int
        At most so many rows are worked on at a time; it changes no bit.

    Raises
    ------
    ParameterError
        For a number or a word outside its range.

    Examples
    --------
    >>> import comminute as cm
    >>> two = cm.gap_graded(2.0, 1.0).with_unit("mm")
    >>> column = cm.ColumnLattice(cm.Material(), two, height=0.02, cells=10, cells_per_row=2000)
    >>> result = column.run(time=[0.0, 20.0], stress_ratio=0.0, segregation=1e-3)
    >>> bottom, top = result.mean_size[-1, [0, -1]]
    >>> bool(bottom < 1.3), bool(top > 1.7)  # large grains rise
    (True, True)
    """

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Sequence[Grading],
        *,
        height: float,
        cells: int = 50,
        cells_per_row: int = 100_000,
        **options: Unpack[ColumnOptions],
    ) -> None:
        rows = [start] * cells if isinstance(start, Grading) else list(start)
        if len(rows) != cells:
            rule = f"it must have one for each of the {cells} rows"
            raise parameter_error("start", len(rows), rule, finding=f"has {len(rows)} gradings")
        units = {grading.unit for grading in rows}
        if len(units) > 1:
            raise parameter_error("start", subject="the gradings", finding="have several units", remedy="use_one_unit")
        how = _options(options)
        self._set(_ColumnLattice(rows, cells_per_row, material, height, how), material, height, units.pop(), options)
        self._rows, self._cells = cells, cells_per_row
        self._largest: Grading | None = max(rows, key=lambda grading: grading.largest)

    @classmethod
    def from_sizes(
        cls,
        sizes: Floats,
        material: Material,
        *,
        height: float,
        unit: str = "",
        **options: Unpack[ColumnOptions],
    ) -> Self:
        """Make a column whose cells have given sizes.

        Parameters
        ----------
        sizes : ndarray (Z, M)
            Sizes around each ring, > 0, in the material's unit, bottom first.
        material : Material
        height : float
            Height of the column, in metres of solid.
        unit : str
            Unit of the sizes.
        **options
            Options as the class takes them.

        Raises
        ------
        ShapeError
            For an array without two dimensions.
        ParameterError
            For sizes that are not greater than 0.

        Examples
        --------
        >>> import numpy as np
        >>> import comminute as cm
        >>> layers = np.repeat([[1.0], [0.5]], 100, axis=1)
        >>> cm.ColumnLattice.from_sizes(layers, cm.Material(), height=0.01)
        <ColumnLattice: 2 rows of 100 cells, 0.01 m>
        """
        given = np.ascontiguousarray(sizes, dtype=np.float64)
        if given.ndim != 2:
            raise ShapeError(f"sizes has {given.ndim} dimensions; it must have two, rows and the cells around each")
        column = cls.__new__(cls)
        column._set(_ColumnLattice(given, material, height, _options(options)), material, height, unit, options)
        column._rows, column._cells = given.shape
        column._largest = None
        return column

    def _set(self, core: _ColumnLattice, material: Material, height: float, unit: str, options: ColumnOptions) -> None:
        self._core, self.material, self.height, self.unit = core, material, float(height), unit
        self.mean: Mean = options.get("mean", DEFAULTS["mean"])

    def __eq__(self, other: object) -> bool:
        """Equal state and equal future; the number of threads does not count."""
        if not isinstance(other, ColumnLattice):
            return NotImplemented
        return self.unit == other.unit and self._core == other._core

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<ColumnLattice: {self._rows} rows of {self._cells} cells, {self.height:g} m>"

    @property
    def z(self) -> Floats:
        """(Z,) heights of the rows' middles, in metres of solid, bottom first."""
        return (np.arange(self._rows) + 0.5) * self.height / self._rows

    @property
    def psi(self) -> Floats:
        """(Z, M) ln(size) of all cells as they are."""
        return np.array([self._core.psi(row) for row in range(self._rows)])

    @property
    def crushes(self) -> npt.NDArray[np.uint32]:
        """(Z, M) how often each grain has crushed since the start, wherever it was then."""
        return np.array([self._core.crushes(row) for row in range(self._rows)])

    @suggests_keywords
    def run(
        self,
        time: Sequence[float] | Floats,
        *,
        stress_ratio: Given | None = None,
        stress: Given | None = None,
        shear_rate: Given = 1.0,
        segregation: float = DRIVE["segregation"],
        mixing: float | ShearMixing = DRIVE["mixing"],
        crush_rate: float = DRIVE["crush_rate"],
        step: float | None = None,
        grid: LogGrid | None = None,
        on_time: Callable[[int], object] | None = None,
    ) -> ColumnLatticeResult:
        """Drive the column through times, on from the state in which it is.

        At the first time the loads are raised, before anything is exchanged. Then, step by step: exchange and crush
        under the loads that stand, and take on those of the step's end.

        Parameters
        ----------
        time : sequence of float
            Times at which the column is looked at, rising, in seconds.
        stress_ratio : float, (Z,), (T, Z) or callable
            Loads, bottom first; of one row for each time straight lines between them; a callable of heights and a time.
        stress : float, (Z,), (T, Z) or callable
            Loads as stresses that are quoted as the material's first_crush_stress is, in place of stress ratios.
        shear_rate : float, (Z,), (T, Z) or callable
            Shear rate, in 1/s.
        segregation : float
            k_s, in metres: a grain of size s moves with k_s * shear rate * (s / mean - 1).
        mixing : float or ShearMixing
            Diffusivity D of the grains over the height, in m2/s; or by shear, which takes sizes with a unit.
        crush_rate : float
            k_b, crushes of an active grain in a unit of shear strain; inf: at once.
        step : float, optional
            Longest time after which loads and shear rates are taken anew. Left out, the times themselves.
        grid : LogGrid, optional
            Bins of the result's `pmf`; left out, they are sized from the start.
        on_time : callable, optional
            Called with the index of each time that is finished.

        Returns
        -------
        ColumnLatticeResult

        Raises
        ------
        ParameterError
            For numbers outside their range, times that do not rise, or loads of another shape.
        KeyboardInterrupt
            On Ctrl-C; the column is left between two exchanges, and can go on.
        """
        times = np.asarray(time, dtype=np.float64)
        drive = drive_of(
            self.material,
            self.unit,
            self.z,
            times,
            stress_ratio=stress_ratio,
            stress=stress,
            shear_rate=shear_rate,
            segregation=segregation,
            mixing=mixing,
            crush_rate=crush_rate,
            step=step,
        )

        def advance(duration: float, rates: list[float]) -> int:
            return self._core.advance(
                duration, rates, drive.mixing, drive.shear_mixing, drive.segregation, drive.crush_rate
            )[0]

        sizes, crushes, looked, exchanges = [], [], [], []
        for k, (loads, count) in enumerate(walk(self._core, advance, drive, times)):
            sizes.append(self.psi)
            crushes.append([self._core.mean_crushes(row) for row in range(self._rows)])
            looked.append(loads)
            exchanges.append(count)
            if on_time is not None:
                on_time(k)
        found = np.array(sizes)
        return ColumnLatticeResult(
            self.z,
            times,
            np.array(looked),
            found,
            np.array(crushes),
            grid or self._grid(found, float(np.max(looked))),
            self.unit,
            np.array(exchanges, dtype=np.int64),
            self.mean,
            self.material.reference_size,
        )

    def _grid(self, psi: Floats, largest_load: float) -> LogGrid:
        """Bins for the start, or for cells of given sizes, and the loads that were."""
        if self._largest is not None:
            return fitting_grid(self._largest, self.material, largest_load)
        return Lattice(np.exp(psi[0].ravel()), self.material).fitting_grid(largest_load)

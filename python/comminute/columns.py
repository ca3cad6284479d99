"""Columns of lattice rows that mix, segregate and crush, as their users meet them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Self

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Fabric,
    Grading,
    LogGrid,
    Material,
    ShapeError,
    _ColumnLattice,
    _ColumnOptions,
    defaults,
    fitting_grid,
)
from comminute._core import Lattice as CoreLattice
from comminute.util.choices import Mean, require_word
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords
from comminute.util.optional import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]
Given = float | Sequence[float] | Floats | Callable[[Floats, float], float | Sequence[float] | Floats]
Partners = Literal["permuted", "shift", "locked"]
CrushOrder = Literal["random", "weakest"]
SwapRates = Literal["pair", "flowslm"]
OPTIONS = defaults["ColumnLattice"]


@dataclass(frozen=True)
class ShearMixing:
    """Mixing by shear: a diffusivity D = factor * shear rate * (mean size)**2.

    Attributes
    ----------
    factor : float
        D_0, about 0.1 for dense flows.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.ShearMixing(0.1)
    ShearMixing(factor=0.1)
    """

    factor: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.factor < math.inf:
            raise parameter_error("factor", self.factor, "it must be at least 0 and finite")


@dataclass(frozen=True, eq=False, repr=False)
class ColumnResult:
    """Gradings of a column by height and time: T times, Z rows, M cells a row.

    Attributes
    ----------
    z : ndarray (Z,)
        Heights of the rows' middles, in metres of solid, bottom first.
    time : ndarray (T,)
        Times, in seconds.
    stress_ratio : ndarray (T, Z)
        Loads.
    log_sizes : ndarray (T, Z, M)
        Log sizes of the cells around each ring, each of the same mass.
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
    log_sizes: Floats
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
        return np.asarray(np.exp(self.log_sizes).mean(axis=2))

    def cdf_at(self, sizes: Sequence[float] | Floats) -> Floats:
        """(T, Z, len(sizes)) mass fraction of grains no larger than sizes, from the cells' own sizes."""
        at = np.log(np.asarray(sizes, dtype=np.float64)) + 1e-12
        times, rows, cells = self.log_sizes.shape
        found = np.empty((times, rows, at.size))
        for k in range(times):
            for i in range(rows):
                found[k, i] = np.searchsorted(np.sort(self.log_sizes[k, i]), at, side="right") / cells
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
        cells = self.log_sizes.shape[2]
        place = min(max(math.ceil(percent / 100.0 * cells) - 1, 0), cells - 1)
        return np.asarray(np.exp(np.partition(self.log_sizes, place, axis=2)[:, :, place]))

    def fabric(self, k: int, row: int) -> Fabric:
        """Joint histogram of a row's grains and neighbourhoods at time k, on `grid`.

        Raises
        ------
        IndexError
            If there is no such time or row.
        """
        material = Material(reference_size=self.reference_size)
        mean: Mean = "geometric" if self.mean == "geometric" else "arithmetic"
        return CoreLattice(np.exp(self.log_sizes[k, row]), material, mean=mean).fabric(self.grid)

    def __eq__(self, other: object) -> bool:
        """Equal in every cell."""
        if not isinstance(other, ColumnResult):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        times, rows, cells = self.log_sizes.shape
        return f"<ColumnResult: {times} times to {self.time[-1]:g} s, {rows} rows of {cells} cells>"

    def plot(self, percent: float = 50.0) -> Figure:
        """Draw a size D_x over height and time; needs matplotlib.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute.plotting.columns import plot_column  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plot_column(self.time, self.z, self.percentile(percent), f"D{percent:g}", self.unit)


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

    _start: Grading | None

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Sequence[Grading],
        *,
        height: float,
        cells: int = 50,
        cells_per_row: int = 100_000,
        seed: int = OPTIONS["seed"],
        mean: Mean = OPTIONS["mean"],
        partners: Partners = OPTIONS["partners"],
        order: CrushOrder = OPTIONS["order"],
        rates: SwapRates = OPTIONS["rates"],
        largest_mixing: float = OPTIONS["largest_mixing"],
        largest_segregation: float = OPTIONS["largest_segregation"],
        threads: int = OPTIONS["threads"],
    ) -> None:
        rows = [start] * cells if isinstance(start, Grading) else list(start)
        if len(rows) != cells:
            rule = f"it must have one for each of the {cells} rows"
            raise parameter_error("start", len(rows), rule, finding=f"has {len(rows)} gradings")
        units = {grading.unit for grading in rows}
        if len(units) > 1:
            raise parameter_error("start", subject="the gradings", finding="have several units", remedy="use_one_unit")
        require_word("partners", partners, Partners)
        require_word("order", order, CrushOrder)
        require_word("rates", rates, SwapRates)
        self.material, self.height, self.mean = material, float(height), mean
        self.unit = units.pop()
        options = _ColumnOptions(seed, mean, partners, order, rates, largest_mixing, largest_segregation, threads)
        self._core = _ColumnLattice(rows, cells_per_row, material, self.height, options)
        self._rows, self._cells = cells, cells_per_row
        self._start = max(rows, key=lambda grading: grading.largest)

    @classmethod
    def of_sizes(
        cls,
        material: Material,
        sizes: Floats,
        *,
        height: float,
        unit: str = "",
        seed: int = OPTIONS["seed"],
        mean: Mean = OPTIONS["mean"],
        partners: Partners = OPTIONS["partners"],
        order: CrushOrder = OPTIONS["order"],
        rates: SwapRates = OPTIONS["rates"],
        largest_mixing: float = OPTIONS["largest_mixing"],
        largest_segregation: float = OPTIONS["largest_segregation"],
        threads: int = OPTIONS["threads"],
    ) -> Self:
        """Make a column whose cells have given sizes.

        Parameters
        ----------
        material : Material
        sizes : ndarray (Z, M)
            Sizes around each ring, bottom first.
        height : float
        unit : str
            Unit of the sizes.
        seed, mean, partners, order, rates, largest_mixing, largest_segregation, threads
            As for the class.

        Raises
        ------
        ShapeError
            For an array without two dimensions.
        ParameterError
            For sizes that are not greater than 0.
        """
        given = np.ascontiguousarray(sizes, dtype=np.float64)
        if given.ndim != 2:
            raise ShapeError(f"sizes has {given.ndim} dimensions; it must have two, rows and the cells around each")
        column = cls.__new__(cls)
        column.material, column.height, column.mean, column.unit = material, float(height), mean, unit
        options = _ColumnOptions(seed, mean, partners, order, rates, largest_mixing, largest_segregation, threads)
        column._core = _ColumnLattice(given, material, column.height, options)
        column._rows, column._cells = given.shape
        column._start = None
        return column

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
    def log_sizes(self) -> Floats:
        """(Z, M) log sizes of all cells as they are."""
        return np.array([self._core.psi(row) for row in range(self._rows)])

    def crush_counts(self, row: int) -> npt.NDArray[np.uint32]:
        """(M,) how often each grain of a row has crushed, wherever it was then."""
        return self._core.crushes(row)

    @suggests_keywords
    def run(
        self,
        time: Sequence[float] | Floats,
        *,
        stress_ratio: Given | None = None,
        stress: Given | None = None,
        shear_rate: Given = 1.0,
        segregation: float = 0.0,
        mixing: float | ShearMixing = 0.0,
        crush_rate: float = math.inf,
        step: float | None = None,
        grid: LogGrid | None = None,
        on_time: Callable[[int], object] | None = None,
    ) -> ColumnResult:
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
            Diffusivity D of the grains over the height, in m2/s; or by shear.
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
        ColumnResult

        Raises
        ------
        ParameterError
            For numbers outside their range, times that do not rise, or loads of another shape.
        KeyboardInterrupt
            On Ctrl-C; the column is left between two exchanges, and can go on.
        """
        times = np.asarray(time, dtype=np.float64)
        if times.ndim != 1 or times.size == 0 or np.any(np.diff(times) <= 0.0) or not np.all(np.isfinite(times)):
            raise parameter_error("time", subject="time", finding="must rise, from one time at least")
        if step is not None and not step > 0.0:
            raise parameter_error("step", step, "it must be greater than 0")
        loads = self._loads(stress_ratio, stress, times)
        shear = self._by_row("shear_rate", shear_rate, times)
        constant, by_shear = (0.0, mixing.factor) if isinstance(mixing, ShearMixing) else (float(mixing), 0.0)
        raised = self._core.load_to if math.isinf(crush_rate) else self._core.stand_under
        sizes, crushes, looked, exchanges = [], [], [], []
        raised(loads(times[0]))
        for k, now in enumerate(times):
            count = 0
            if k > 0:
                before = times[k - 1]
                parts = 1 if step is None else max(math.ceil((now - before) / step - 1e-9), 1)
                for part in range(parts):
                    begin, end = before + (now - before) * part / parts, before + (now - before) * (part + 1) / parts
                    rates = shear(0.5 * (begin + end))
                    report = self._core.advance(end - begin, rates, constant, by_shear, segregation, crush_rate)
                    count += report[0]
                    raised(loads(end))
            sizes.append(self.log_sizes)
            crushes.append([self._core.mean_crushes(row) for row in range(self._rows)])
            looked.append(loads(now))
            exchanges.append(count)
            if on_time is not None:
                on_time(k)
        found = np.array(sizes)
        return ColumnResult(
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

    def _loads(self, stress_ratio: Given | None, stress: Given | None, times: Floats) -> Callable[[float], list[float]]:
        """Give the stress ratios of the rows as a function of the time."""
        if stress_ratio is not None and stress is None:
            return self._by_row("stress_ratio", stress_ratio, times)
        if stress is None or stress_ratio is not None:
            raise parameter_error("stress_ratio", subject="give one kind of load:", finding="stress_ratio or stress")
        stresses = self._by_row("stress", stress, times)
        return lambda now: list(np.asarray(self.material.stress_ratio(np.array(stresses(now)))).tolist())

    def _by_row(self, name: str, given: Given, times: Floats) -> Callable[[float], list[float]]:
        """Give the numbers of the rows as a function of the time."""
        if callable(given):
            return lambda now: self._checked(name, given(self.z, now))
        numbers = np.asarray(given, dtype=np.float64)
        if numbers.ndim == 2:
            if numbers.shape != (times.size, self._rows):
                rule = f"it must be a number, ({self._rows},), or ({times.size}, {self._rows})"
                raise parameter_error(name, numbers.shape, rule, finding=f"has shape {numbers.shape}")
            return lambda now: [float(np.interp(now, times, numbers[:, row])) for row in range(self._rows)]
        fixed = self._checked(name, numbers)
        return lambda _: fixed

    def _checked(self, name: str, given: float | Sequence[float] | Floats) -> list[float]:
        numbers = np.asarray(given, dtype=np.float64)
        if numbers.ndim > 1 or (numbers.ndim == 1 and numbers.shape != (self._rows,)):
            rule = f"it must be a number or one for each of the {self._rows} rows"
            raise parameter_error(name, numbers.shape, rule, finding=f"has shape {numbers.shape}")
        return list(np.broadcast_to(numbers, (self._rows,)).tolist())

    def _grid(self, log_sizes: Floats, largest_load: float) -> LogGrid:
        """Bins for the cells as they were and the loads that were."""
        if self._start is not None:
            return fitting_grid(self._start, self.material, largest_load)
        return CoreLattice(np.exp(log_sizes[0].ravel()), self.material).fitting_grid(largest_load)

"""The column of laws of three cells, as its users meet it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal, TypedDict, Unpack, cast

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Grading,
    LogGrid,
    Material,
    ResolvedGrid,
    _fitting_nodes,
    _ResolvedColumn,
    _ResolvedColumnOptions,
    defaults,
)
from comminute.columns.drive import Feed, Given, ShearMixing
from comminute.columns.result import ColumnResult
from comminute.columns.running import drive_of, walk
from comminute.util.choices import Mean, require_word
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

Floats = npt.NDArray[np.float64]
Partners = Literal["permuted", "shift"]
End = Literal["closed", "periodic", "outflow"]
Kept = Literal["all", "last", "none"]
DEFAULTS, DRIVE = defaults["Column"], defaults["ColumnLattice.run"]
FABRIC_SPACING = 0.05  # bin width of the fabrics of rows


class ColumnOptions(TypedDict, total=False):
    """Options of a column; one that is left out has the core's default, `_core.defaults`."""

    mean: Mean
    partners: Partners
    largest_mixing: float
    largest_segregation: float
    tolerance: float
    competition: float
    rest: float
    threads: int


class Column:
    """A column of rows that mix, segregate and crush (Section 8.3), each with the law of three adjacent cells.

    It is `ColumnLattice` with infinitely many cells: free of noise, the same at every run. The transport of the law
    needs no closure; crushing is closed as by `Resolved`, with pairs of grains that have just met told from old ones.
    After an exchange active cells crush in random order; while a load rises, the weakest first. Loads do not fall while
    grains are exchanged. An exchange of the probability q leaves an error of the first order in q.

    Parameters
    ----------
    material : Material
        Every size has one strength.
    start : Grading, or sequence of Grading
        Grading of all rows, or of each, bottom first; each row is a random mixture.
    height : float
        Height of the column, in metres of solid.
    cells : int
        Number of rows, 2 or more.
    neighbour_length : float
        Distance of a grain's neighbours, in metres of solid, some grains: a length of the material, which says after
        how much mixing a grain has new neighbours. At most the distance of the rows, height / cells.
    bottom, top : {"closed", "periodic", "outflow"} or Feed
        Surroundings of the ends: a wall, the other end, grains that never run out, or nothing, where a feed at the
        other end pushes the column on.
    sizes : sequence of float
        Sizes at which curves are wanted, which become ends of bins.
    grid : ResolvedGrid, optional
        Sizes that are told apart; left out, they fit the gradings. Finer ones cost the third to fourth power.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize.
    partners : {"permuted", "shift"}
        Whether every cell has another partner in each exchange, or a row is shifted as a whole, for comparison.
    largest_mixing, largest_segregation : float
        Limits of the probabilities of one exchange, at most 1, beyond which it is divided.
    tolerance, competition, rest : float
        Mass that a raise overruns or that crushes in one step; of the active mass of new pairs, share whose partner is
        active too; active mass at which a row counts as at rest.
    threads : int
        At most so many rows are worked on at a time; it changes no bit.

    Raises
    ------
    ParameterError
        For a number or a word outside its range, ends that do not fit, and strengths that are scattered.

    Examples
    --------
    >>> import comminute as cm
    >>> column = cm.Column(cm.Material(), cm.monodisperse(1.0), height=4e-3, cells=4, neighbour_length=1e-3)
    >>> result = column.run(time=[0.0, 5.0], stress_ratio=[8.0, 4.0, 2.0, 1.0], mixing=1e-8)
    >>> bool((result.crushes[1] > result.crushes[0]).all())  # new neighbours, new crushes
    True
    """

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Sequence[Grading],
        *,
        height: float,
        cells: int = 50,
        neighbour_length: float,
        bottom: End | Feed = "closed",
        top: End | Feed = "closed",
        sizes: Sequence[float] = (),
        grid: ResolvedGrid | None = None,
        **options: Unpack[ColumnOptions],
    ) -> None:
        for name in options:
            if name not in DEFAULTS:
                raise TypeError(f"there is no option {name}; it must be one of {', '.join(DEFAULTS)}")
        given = cast("ColumnOptions", dict(DEFAULTS) | options)
        require_word("partners", given["partners"], Partners)
        for name, end in (("bottom", bottom), ("top", top)):
            if not isinstance(end, Feed):
                require_word(name, end, End)
        rows = [start] * cells if isinstance(start, Grading) else list(start)
        if len(rows) != cells:
            rule = f"it must have one for each of the {cells} rows"
            raise parameter_error("start", len(rows), rule, finding=f"has {len(rows)} gradings")
        if not neighbour_length > 0.0:
            raise parameter_error("neighbour_length", float(neighbour_length), "it must be greater than 0")
        fed = [end for end in (bottom, top) if isinstance(end, Feed)]
        gradings = [*rows, *(feed.grading for feed in fed)]
        units = {grading.unit for grading in gradings}
        if len(units) > 1:
            raise parameter_error("start", subject="the gradings", finding="have several units", remedy="use_one_unit")
        self.material, self.height, self.unit = material, float(height), units.pop()
        self.mean: Mean = given["mean"]
        if grid is not None and len(sizes) > 0:
            raise parameter_error(
                "sizes", subject="sizes", finding="are ends of bins that are made; give them or a grid"
            )
        edges = [math.log(size) for size in sizes]
        self.grid = grid or _fitting_nodes(gradings, material.fabric_width, edges)
        self._bottom, self._top = ("feed" if isinstance(end, Feed) else end for end in (bottom, top))
        self._feed = self.grid.pmf(fed[0].grading).tolist() if fed else []
        self._feed_rate = fed[0].rate if fed else 0.0
        self._rows = cells
        how = _ResolvedColumnOptions(neighbour_length=neighbour_length, **given)
        start_mass = np.array([self.grid.pmf(grading) for grading in rows])
        self._core = _ResolvedColumn(self.grid, material, start_mass, height, how)
        top_psi = float(self.grid.upper[-1])
        bins = math.ceil((top_psi - float(self.grid.upper[0])) / FABRIC_SPACING) + 2
        self.fabric_grid = LogGrid(top_psi - FABRIC_SPACING * (bins - 1), top_psi, bins)

    def __eq__(self, other: object) -> bool:
        """Equal state and equal future; the number of threads does not count."""
        if not isinstance(other, Column):
            return NotImplemented
        ends = [(c.unit, c._bottom, c._top, c._feed, c._feed_rate) for c in (self, other)]
        return ends[0] == ends[1] and self._core == other._core

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Column: {self._rows} rows of {self.grid.nodes} nodes, {self.height:g} m>"

    @property
    def z(self) -> Floats:
        """(Z,) heights of the rows' middles, in metres of solid, bottom first."""
        return (np.arange(self._rows) + 0.5) * self.height / self._rows

    def triples(self, row: int) -> Floats:
        """(N, N, N) mass of the centre b between a and c at [b, a, c], in a row as it is.

        Raises
        ------
        ParameterError
            If there is no such row.
        """
        return self._core.triples(row)

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
        fabrics: Kept = "last",
        on_time: Callable[[int], object] | None = None,
    ) -> ColumnResult:
        """Drive the column through times, on from the state in which it is.

        Parameters
        ----------
        time, stress_ratio, stress, shear_rate, segregation, mixing, crush_rate, step, on_time
            As `ColumnLattice.run` takes them.
        fabrics : {"all", "last", "none"}
            Times at which the joint law of grains and neighbourhoods of every row is kept.

        Returns
        -------
        ColumnResult

        Raises
        ------
        ParameterError
            For numbers outside their range, times that do not rise, loads of another shape, and loads that fall while
            grains are exchanged.
        KeyboardInterrupt
            On Ctrl-C; the column is left between two exchanges, and can go on.
        """
        require_word("fabrics", fabrics, Kept)
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
        inflow = np.zeros((times.size, self.grid.nodes))
        now = 0

        def advance(duration: float, rates: list[float]) -> int:
            exchanges, _, came = self._core.advance(
                duration,
                rates,
                drive.mixing,
                drive.shear_mixing,
                drive.segregation,
                drive.crush_rate,
                self._bottom,
                self._top,
                self._feed,
                self._feed_rate,
            )
            inflow[now] += came
            return exchanges

        mass, crushes, pending, looked, exchanges = [], [], [], [], []
        kept: dict[int, Floats] = {}
        rows = range(self._rows)
        for k, (loads, count) in enumerate(walk(self._core, advance, drive, times)):
            mass.append([self._core.pmf(row) for row in rows])
            crushes.append([self._core.crushes(row) for row in rows])
            pending.append([self._core.pending(row) for row in rows])
            looked.append(loads)
            exchanges.append(count)
            if fabrics == "all" or (fabrics == "last" and k == times.size - 1):
                kept[k] = np.array([self._core.joint(row, self.fabric_grid) for row in rows])
            if on_time is not None:
                on_time(k)
            now = k + 1
        return ColumnResult(
            z=self.z,
            time=times,
            stress_ratio=np.array(looked),
            mass=np.array(mass),
            crushes=np.array(crushes),
            pending=np.array(pending),
            inflow=inflow,
            grid=self.grid,
            unit=self.unit,
            exchanges=np.array(exchanges, dtype=np.int64),
            mean=self.mean,
            fabric_grid=self.fabric_grid,
            fabrics=kept,
        )

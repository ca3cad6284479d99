"""The stochastic lattice as a user meets it: a state of many rings, and its runs over load paths."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal, Self, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from comminute import _core
from comminute._core import Fabric, Grading, LogGrid, Material
from comminute.lattice.results import LatticeResult, mean_and_error
from comminute.runs.load_path import LoadPath, load_path, wanted_fabrics
from comminute.simulation import Interrupted
from comminute.util.choices import Mean

Floats = npt.NDArray[np.float64]


class _Options(TypedDict, total=False):
    """Options of either lattice; one that is left out has the core's default, `_core.defaults`."""

    seed: int
    replicas: int
    mean: Mean
    threads: int


class LatticeOptions(_Options, total=False):
    """Options of `Lattice`."""

    record_avalanches: bool


class SteppingOptions(_Options, total=False):
    """Options of `TimeSteppedLattice`."""

    crush_probability: float
    load_factor: float


@dataclass
class _Records:
    """What a run writes down after each load."""

    pmf: list[Floats] = field(default_factory=list)
    cdf_error: list[Floats] = field(default_factory=list)
    crushes: list[float] = field(default_factory=list)
    crushes_error: list[float] = field(default_factory=list)
    fabrics: list[Fabric | None] = field(default_factory=list)

    def add(self, lattice: Rings, grid: LogGrid, *, keep: bool) -> None:
        sizes = lattice.grainsizes(grid)
        self.pmf.append(np.mean(sizes, axis=0))
        self.cdf_error.append(mean_and_error(np.cumsum(sizes, axis=1))[1])
        crushes, error = mean_and_error(lattice._core.mean_crushes)
        self.crushes.append(float(crushes))
        self.crushes_error.append(float(error))
        self.fabrics.append(lattice.fabric(grid) if keep else None)


class Rings:
    """What `Lattice` and `TimeSteppedLattice` have in common; make one of those."""

    _core: _core.Lattice | _core.TimeSteppedLattice
    _unit: str

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
    def psi(self) -> Floats:
        """(replicas, cells) log sizes around the rings; a copy."""
        return self._core.psi

    @property
    def crushes(self) -> npt.NDArray[np.uint32]:
        """(replicas, cells) number of times each cell has crushed since the start; a copy."""
        return self._core.crushes

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
        """The Material."""
        return self._core.material

    @property
    def seed(self) -> int:
        """Seed of the random number generator."""
        return self._core.seed

    @property
    def mean(self) -> Mean:
        """How two neighbours make a neighbourhood grainsize, "arithmetic" or "geometric"."""
        return self._core.mean

    @property
    def threads(self) -> int:
        """Largest number of rings that are worked on at a time; changes no bit of the results."""
        return self._core.threads

    def grainsizes(self, grid: LogGrid) -> Floats:
        """(replicas, N) mass by bin; what is finer than the grid goes to the fines bin.

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

    def run(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: float | Iterable[float] | None = None,
        remix_after: Iterable[int] = (),
        grid: LogGrid | None = None,
        keep_fabrics: Literal["all", "last"] | Sequence[int] = "all",
        on_load: Callable[[int], object] | None = None,
    ) -> LatticeResult:
        """Take the lattice through a load path, on from the state in which it is.

        Parameters
        ----------
        stress_ratio : float or sequence
            Loads, each >= 0, in any order: unloading changes nothing.
        stress : float or sequence
            The same in the unit of the material's first_crush_stress. Give one of the two.
        remix_after : sequence of int
            Indices of loads after which the rings are shuffled.
        grid : LogGrid, optional
            Bins of the result; to compare with a continuum run give the `grid` of its result. Left out,
            one is sized from the cells and the largest load (`fitting_grid`).
        keep_fabrics : {"all", "last"} or sequence of int
            For which loads `Result.fabric` is kept, N x N numbers each.
        on_load : callable, optional
            Called with the index of each load when it is finished, for progress bars.

        Returns
        -------
        LatticeResult

        Raises
        ------
        ParameterError
            For a load, index or word outside its range, or a cell above the grid's top.
        Interrupted
            On Ctrl-C; its `result` has the finished loads, and the lattice can go on.
        """
        path = load_path(self.material, stress_ratio, stress, 0.0, remix_after)
        wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size)
        grid = grid or self._core.fitting_grid(float(path.stress_ratio.max()))
        start = self.fabric(grid)
        records = _Records()
        try:
            for k, load in enumerate(path.stress_ratio):
                self.load_to(float(load))
                records.add(self, grid, keep=k in wanted)
                if k in path.remix_after:
                    self.remix()
                if on_load is not None:
                    on_load(k)
        except KeyboardInterrupt:
            raise Interrupted(self._result(start, path, records) if records.pmf else None) from None
        return self._result(start, path, records)

    def _result(self, start: Fabric, path: LoadPath, records: _Records) -> LatticeResult:
        done = len(records.pmf)
        pmf = np.array(records.pmf)
        return LatticeResult(
            material=self.material,
            grid=start.grid,
            start=start,
            unit=self._unit,
            stress_ratio=path.stress_ratio[:done],
            stress=None if path.stress is None else path.stress[:done],
            pmf=pmf,
            crushes=np.array(records.crushes),
            mass_error=pmf.sum(axis=1) - 1.0,
            engine=type(self).__name__,
            scheme="no bins",
            fabrics=tuple(records.fabrics),
            points=((),) * done,
            cells=self.cells,
            replicas=self.replicas,
            seed=self.seed,
            cdf_error=np.array(records.cdf_error),
            crushes_error=np.array(records.crushes_error),
        )


class Lattice(Rings):
    """The stochastic lattice (Section 2), quasi-static and event driven.

    Each replica is a ring of cells of equal mass. The load rises to the smallest critical stress ratio
    (Eq. 2, the neighbourhood being the mean of the two neighbours), that cell crushes, and the avalanche it
    sets off runs at constant load, weakest cell first, before the load rises again. Equally weak cells crush
    in random order. Loading to 2 and then to 8 is loading to 8 at once, to the bit.

    Parameters
    ----------
    cells : int
        Cells of a ring, >= 2.
    material : Material
    grading : Grading
        The sizes are drawn from it independently.
    seed : int, default 0
        Seed of the random number generator; each replica has a stream of its own.
    replicas : int, default 1
        Independent rings, >= 1.
    mean : {"arithmetic", "geometric"}, default "arithmetic"
        How two neighbours make a neighbourhood grainsize (Eq. 48 or 65).
    threads : int, default 1
        Largest number of rings that are worked on at a time; changes no bit of the results.
    record_avalanches : bool, default False
        Keep the size of every avalanche, 16 bytes each; see `avalanches`.

    Raises
    ------
    ParameterError
        For a value outside its range; the message names it.

    Examples
    --------
    >>> import comminute as cm
    >>> lattice = cm.Lattice(100_000, cm.Material(), cm.monodisperse(1.0), seed=1)
    >>> crushes = lattice.load_to(1.0)  # random sequential adsorption: (1 - exp(-2)) / 2 of the cells
    >>> abs(crushes / lattice.cells - 0.432332) < 0.005
    True
    """

    _core: _core.Lattice

    def __init__(self, cells: int, material: Material, grading: Grading, **options: Unpack[LatticeOptions]) -> None:
        self._core = _core.Lattice(cells, material, grading, **options)
        self._unit = grading.unit

    @classmethod
    def from_sizes(cls, sizes: Floats, material: Material, **options: Unpack[LatticeOptions]) -> Self:
        """Make a lattice of given sizes, in their order around the ring; every replica starts with them.

        Parameters
        ----------
        sizes : ndarray (cells,)
            Sizes, > 0, in the material's unit, float64.
        material, **options
            As for `Lattice`.

        Returns
        -------
        Lattice

        Raises
        ------
        TypeError, ShapeError, ParameterError
            For another dtype or shape, or a size that is not positive; the message gives its place.
        """
        lattice = cls.__new__(cls)
        lattice._core = _core.Lattice(sizes, material, **options)
        lattice._unit = ""
        return lattice

    def avalanches(self, replica: int = 0) -> tuple[Floats, npt.NDArray[np.uint64]]:
        """Avalanches of one replica since the start, in the order of their loads.

        An avalanche is what crushes at one value of the load, before it has to rise again. After a remixing
        the loads begin anew.

        Parameters
        ----------
        replica : int

        Returns
        -------
        stress_ratio, crushes : ndarray (A,)
            Loads, and how many crushes each set off.

        Raises
        ------
        ParameterError
            Unless the lattice was made with record_avalanches=True.
        """
        return self._core.avalanches(replica)


class TimeSteppedLattice(Rings):
    """The lattice of published time-stepping codes, for comparison.

    Neighbourhoods are frozen at the start of a pass, every active cell crushes in it with a given
    probability, passes are repeated until none is active, and then the load rises by a factor, beginning
    with the first load that crushes anything. As the factor goes to 1 and the probability to 0 together this
    becomes `Lattice`; with probability 1 a monodisperse ring crushes whole at once, which is another model.

    Parameters
    ----------
    cells, material, grading
        As for `Lattice`.
    crush_probability : float, default 0.1
        Probability that an active cell crushes in one pass, in (0, 1].
    load_factor : float, default 1.01
        Ratio of each load to the one before, > 1; inf goes at once to the load asked for.
    seed, replicas, mean, threads
        As for `Lattice`.

    Raises
    ------
    ParameterError
        For a value outside its range; the message names it.

    Examples
    --------
    >>> import comminute as cm
    >>> lattice = cm.TimeSteppedLattice(1000, cm.Material(), cm.monodisperse(1.0), crush_probability=1.0)
    >>> lattice.crush_pass(1.0)
    1000
    """

    _core: _core.TimeSteppedLattice

    def __init__(self, cells: int, material: Material, grading: Grading, **options: Unpack[SteppingOptions]) -> None:
        self._core = _core.TimeSteppedLattice(cells, material, grading, **options)
        self._unit = grading.unit

    @classmethod
    def from_sizes(cls, sizes: Floats, material: Material, **options: Unpack[SteppingOptions]) -> Self:
        """Make a lattice of given sizes; see `Lattice.from_sizes`."""
        lattice = cls.__new__(cls)
        lattice._core = _core.TimeSteppedLattice(sizes, material, **options)
        lattice._unit = ""
        return lattice

    @property
    def crush_probability(self) -> float:
        """Probability that an active cell crushes in one pass."""
        return self._core.crush_probability

    @property
    def load_factor(self) -> float:
        """Ratio of each load to the one before."""
        return self._core.load_factor

    def crush_pass(self, stress_ratio: float) -> int:
        """One single pass at a load, whether it leaves active cells or not.

        Returns
        -------
        int
            Number of crushes, of all replicas together.

        Raises
        ------
        ParameterError
            As `load_to`.
        """
        return self._core.crush_pass(stress_ratio)

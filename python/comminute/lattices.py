"""Lattices as their users meet them: rings made from a grading or from sizes, and taken through load paths."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Self, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material
from comminute._core import Lattice as CoreLattice
from comminute._core import TimeSteppedLattice as CoreTimeSteppedLattice
from comminute.lattice.rings import Rings
from comminute.lattice.walk import lattice_run
from comminute.result import LatticeResult, finished
from comminute.runs.load_path import AxialStress, Keep, Stress, load_path, wanted_fabrics
from comminute.util.choices import Mean
from comminute.util.keywords import suggests_keywords

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


class LoadedRings(Rings):
    """Rings with their runs over load paths; make a `Lattice` or a `TimeSteppedLattice`."""

    _unit: str

    @suggests_keywords
    def run(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: Stress | None = None,
        remix_after: Iterable[int] = (),
        grid: LogGrid | None = None,
        keep_fabrics: Keep = "auto",
        on_load: Callable[[int], object] | None = None,
        **axial: Unpack[AxialStress],
    ) -> LatticeResult:
        """Take the lattice through a load path, on from the state in which it is.

        Parameters
        ----------
        stress_ratio : float or sequence
            Loads, each >= 0, in any order: unloading changes nothing.
        stress, p, q, vertical, k0
            Loads as stresses; see `Simulation.run`.
        remix_after : sequence of int
            Indices of the loads after which the rings are shuffled.
        grid : LogGrid, optional
            Bins of the result; to compare with a continuum run give the `grid` of its result. Left out,
            one is sized from the cells and the largest load (`fitting_grid`).
        keep_fabrics : {"auto", "all", "last"} or sequence of int
            Loads whose `Result.fabric` is kept, N x N numbers each; "auto": as many as fit into 256 MB, evenly over
            the path, the last among them. A lattice does not compute the others again.
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
        path = load_path(self.material, stress_ratio, stress, 0.0, remix_after, **axial)
        grid = grid or self._core.fitting_grid(float(path.stress_ratio.max()))
        wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size, grid.bins)
        return finished(lattice_run(LatticeResult, self, path, grid, wanted=wanted, unit=self._unit), on_load)


class Lattice(LoadedRings):
    """The stochastic lattice (Section 2), quasi-static and event driven.

    Each replica is a ring of cells of equal mass. The load rises to the smallest critical stress ratio
    (Eq. 2, the neighbourhood being the mean of the two neighbours), that cell crushes, and the avalanche it
    sets off runs at constant load, weakest cell first, before the load rises again. Equally weak cells crush
    in random order. Loading to 2 and then to 8 is loading to 8 at once, to the bit.

    Parameters
    ----------
    cells : int
        Number of cells of a ring, >= 2.
    material : Material
    grading : Grading
        Grading from which the sizes are drawn independently.
    seed : int, default 0
        Seed of the random number generator; each replica has a stream of its own.
    replicas : int, default 1
        Number of independent rings, >= 1.
    mean : {"arithmetic", "geometric"}, default "arithmetic"
        Mean by which two neighbours make a neighbourhood grainsize (Eq. 48 or 65).
    threads : int, default 1
        Largest number of rings that are worked on at a time; changes no bit of the results.
    record_avalanches : bool, default False
        Whether the size of every avalanche is kept, 16 bytes each; see `avalanches`.

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

    _core: CoreLattice

    def __init__(self, cells: int, material: Material, grading: Grading, **options: Unpack[LatticeOptions]) -> None:
        self._core = CoreLattice(cells, material, grading, **options)
        self._unit = grading.unit

    @classmethod
    def from_sizes(cls, sizes: Floats, material: Material, **options: Unpack[LatticeOptions]) -> Self:
        """Make a lattice of given sizes, in their order around the ring; every replica starts with them.

        Parameters
        ----------
        sizes : ndarray (cells,)
            Sizes, > 0, in the material's unit, float64.
        material, **options
            Material and options as `Lattice` takes them.

        Returns
        -------
        Lattice

        Raises
        ------
        TypeError, ShapeError, ParameterError
            For another dtype or shape, or a size that is not positive; the message gives its place.
        """
        lattice = cls.__new__(cls)
        lattice._core = CoreLattice(sizes, material, **options)
        lattice._unit = ""
        return lattice

    def avalanches(self, replica: int = 0) -> tuple[Floats, npt.NDArray[np.uint64]]:
        """Avalanches of one replica since the start, in the order of their loads.

        An avalanche is the crushes at one value of the load, before it has to rise again. After a remixing
        the loads begin anew.

        Parameters
        ----------
        replica : int

        Returns
        -------
        stress_ratio, crushes : ndarray (A,)
            Loads, and the number of crushes each set off.

        Raises
        ------
        ParameterError
            Unless the lattice was made with record_avalanches=True.
        """
        return self._core.avalanches(replica)


class TimeSteppedLattice(LoadedRings):
    """The lattice of published time-stepping codes, for comparison.

    Neighbourhoods are frozen at the start of a pass, every active cell crushes in it with a given
    probability, passes are repeated until none is active, and then the load rises by a factor, beginning
    with the first load that crushes anything. As the factor goes to 1 and the probability to 0 together this
    becomes `Lattice`; with probability 1 a monodisperse ring crushes whole at once, which is another model.

    Parameters
    ----------
    cells, material, grading
        Size, material and grading as `Lattice` takes them.
    crush_probability : float, default 0.1
        Probability that an active cell crushes in one pass, in (0, 1].
    load_factor : float, default 1.01
        Ratio of one load to the one before, > 1; inf goes at once to the load asked for.
    seed, replicas, mean, threads
        Options as `Lattice` takes them.

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

    _core: CoreTimeSteppedLattice

    def __init__(self, cells: int, material: Material, grading: Grading, **options: Unpack[SteppingOptions]) -> None:
        self._core = CoreTimeSteppedLattice(cells, material, grading, **options)
        self._unit = grading.unit

    @classmethod
    def from_sizes(cls, sizes: Floats, material: Material, **options: Unpack[SteppingOptions]) -> Self:
        """Make a lattice of given sizes; see `Lattice.from_sizes`."""
        lattice = cls.__new__(cls)
        lattice._core = CoreTimeSteppedLattice(sizes, material, **options)
        lattice._unit = ""
        return lattice

    @property
    def crush_probability(self) -> float:
        """Probability that an active cell crushes in one pass."""
        return self._core.crush_probability

    @property
    def load_factor(self) -> float:
        """Ratio of one load to the one before."""
        return self._core.load_factor

    def crush_pass(self, stress_ratio: float) -> int:
        """Make one single pass at a load, whether it leaves active cells or not.

        Returns
        -------
        int
            Number of crushes, of all replicas together.

        Raises
        ------
        ParameterError
            For a load that `load_to` refuses.
        """
        return self._core.crush_pass(stress_ratio)

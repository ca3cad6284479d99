"""The exact time-evolution operator of a small ring (Section 4, Eqs. 29-38), state by state."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, ShapeError, critical_stress_ratio, fragment_pmf
from comminute.util.choices import Mean, Scheme, require_word
from comminute.util.errors import parameter_error, scattered

Floats = npt.NDArray[np.float64]

LARGEST_BINS = 20
CLOSED = 1e-12  # relative tolerance of the load, so that a cell at its critical load crushes however that was rounded


class SmallRing:
    """All states of a ring of two to four cells on a grid, and the synchronous step between them.

    A state of the ring is one bin per cell, so its law is an array of N^M probabilities. In one step every
    cell that the load crushes (Eq. 2, sizes at bin centres, the neighbourhood size being the mean of its two
    neighbours' and never put in a bin) goes down by the fragment pmf, all at once and independently (Eqs. 36
    to 38). Mass that falls below the grid goes to bin 0. With two cells this is `FullConvolution` with kind
    "exact".

    Parameters
    ----------
    cells : int
        M, 2 to 4; in a ring of two each cell is both neighbours of the other.
    grid : LogGrid
        Grid of at most 20 bins.
    material : Material
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize (Eq. 48 or 65).
    scheme : {"conservative", "paper"}
        Fragments on the grid, as in `fragment_pmf`; cells crush by their bin's centre under either.

    Raises
    ------
    ParameterError
        For more cells or bins, or a word that is not known.

    Examples
    --------
    >>> import comminute as cm
    >>> ring = cm.SmallRing(3, cm.LogGrid(-3.0, 0.0, 16), cm.Material(fabric_width=0.5), scheme="paper")
    >>> p = ring.start(cm.monodisperse(1.0))
    >>> p = ring.step(p, 8.0)
    >>> p.shape, float(p.sum().round(12)), float(ring.grainsize(p)[-1])
    ((16, 16, 16), 1.0, 0.0)
    """

    def __init__(
        self,
        cells: int,
        grid: LogGrid,
        material: Material,
        *,
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        if cells not in (2, 3, 4):
            raise parameter_error("cells", cells, "it must be 2, 3 or 4: the state has bins^cells entries")
        if grid.bins > LARGEST_BINS:
            finding, rule = f"has {grid.bins} bins", f"it must have at most {LARGEST_BINS} here"
            raise parameter_error("bins", grid.bins, rule, subject="the grid", finding=finding)
        require_word("mean", mean, Mean)
        if material.strength_scatter:
            raise scattered("a small ring")
        self.cells = cells
        self.grid = grid
        self.material = material
        self.mean: Mean = mean
        self.scheme: Scheme = scheme
        self._critical = [self._critical_of(cell) for cell in range(cells)]
        self._move = _transition(fragment_pmf(material.fragments, grid.spacing, grid.bins, scheme))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a law: (N, ..., N), one axis per cell."""
        return (self.grid.bins,) * self.cells

    def start(self, grading: Grading) -> Floats:
        """Law of a ring whose cells are drawn from a grading independently.

        Returns
        -------
        ndarray (N, ..., N)
        """
        law = np.ones(())
        for _ in range(self.cells):
            law = np.multiply.outer(law, grading.on_grid(self.grid))
        return law

    def active(self, stress_ratio: float) -> npt.NDArray[np.bool_]:
        """(M, N, ..., N) truth of each cell's crushing under a load, state by state (Eq. 33)."""
        return np.array([critical <= stress_ratio * (1.0 + CLOSED) for critical in self._critical])

    def step(self, law: Floats, stress_ratio: float) -> Floats:
        """Law after one synchronous step under a load (Eq. 38).

        Parameters
        ----------
        law : ndarray (N, ..., N)
        stress_ratio : float
            Load, >= 0.

        Returns
        -------
        ndarray (N, ..., N)

        Raises
        ------
        ShapeError
            For an array of another shape.
        ParameterError
            For a load that is negative or NaN.
        """
        if law.shape != self.shape:
            raise ShapeError(f"law has shape {law.shape}; a ring of {self.cells} cells needs {self.shape}")
        if not stress_ratio >= 0.0:
            raise parameter_error("stress_ratio", stress_ratio, "it must be a number of at least 0 (0 is no load)")
        active = self.active(stress_ratio)
        after = np.zeros(self.shape)
        for crushing in itertools.product((False, True), repeat=self.cells):
            here = np.all([active[c] == crushing[c] for c in range(self.cells)], axis=0)
            part = np.where(here, law, 0.0)
            for cell in range(self.cells):
                if crushing[cell]:
                    part = np.moveaxis(np.tensordot(self._move, part, axes=(1, cell)), 0, cell)
            after += part
        return after

    def grainsize(self, law: Floats) -> Floats:
        """(N,) mass by bin: the marginal of one cell, averaged over the cells."""
        others = [tuple(c for c in range(self.cells) if c != cell) for cell in range(self.cells)]
        return np.asarray(np.mean([law.sum(axis=axes) for axes in others], axis=0))

    def _critical_of(self, cell: int) -> Floats:
        """(N, ..., N) critical stress ratio of one cell, state by state."""
        psi = np.meshgrid(*[self.grid.centres] * self.cells, indexing="ij")
        left, right = psi[cell - 1], psi[(cell + 1) % self.cells]
        neighbour = np.exp(0.5 * (left + right)) if self.mean == "geometric" else 0.5 * (np.exp(left) + np.exp(right))
        return critical_stress_ratio(self.material, np.exp(psi[cell]), neighbour)

    def __eq__(self, other: object) -> bool:
        """Equal in everything that a step depends on."""
        return isinstance(other, SmallRing) and self._settings() == other._settings()

    def _settings(self) -> tuple[object, ...]:
        return self.cells, self.grid, self.material, self.mean, self.scheme

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"SmallRing({self.cells}, {self.grid}, {self.material}, mean='{self.mean}', scheme='{self.scheme}')"


def _transition(pmf: Floats) -> Floats:
    """(N, N) probability [to, from] that one crush takes a cell from one bin to another."""
    bins = pmf.size
    move = np.zeros((bins, bins))
    for source in range(bins):
        move[1 : source + 1, source] = pmf[:source][::-1]
        move[0, source] = 1.0 - move[1:, source].sum()
    return move

"""Models that a fit may take: each gives the mass finer than the measured sieves under the measured loads."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, fitting_grid
from comminute.lattices import Lattice
from comminute.runs.remarks import ResolutionWarning
from comminute.simulation import Simulation

Floats = npt.NDArray[np.float64]
FitModel = Literal["paper", "resolved", "lattice"]
SPACING = 0.04  # bin width of a search, whose second-order errors are far below those of sieves
BESIDE = 1e-12  # distance in ln(size) by which a grain as large as a sieve passes it


@dataclass(frozen=True)
class Specimen:
    """Loads of the specimens that share a start, each from rest, and the sieves of each.

    Attributes
    ----------
    start : Grading
    loads : tuple of float
        Stresses, or stress ratios where the material has no first crush stress; rising.
    sizes : tuple of ndarray
        Sieves at which each grading is wanted.
    """

    start: Grading
    loads: tuple[float, ...]
    sizes: tuple[Floats, ...]


class Model(Protocol):
    """Mass finer than sieves, by a model of the packing."""

    @property
    def step(self) -> float:
        """Step of a parameter, on the scale of the search, over which a derivative is taken."""

    def prepare(self, material: Material, specimens: Sequence[Specimen]) -> None:
        """Choose what must not change while a search goes on, such as a grid, for parameters near those given."""

    def curves(self, material: Material, which: int, specimen: Specimen, loading_rate: float) -> list[Floats]:
        """(M,) mass finer than the sieves, under each load of the specimen of that number."""


def _loads(material: Material, loads: Sequence[float]) -> dict[str, Any]:
    """Keyword of a run for loads; see `Specimen`."""
    return {"stress" if material.first_crush_stress is not None else "stress_ratio": list(loads)}


def ratios(material: Material, loads: Sequence[float]) -> Floats:
    """Stress ratios of loads; see `Specimen`."""
    return np.asarray(loads, dtype=np.float64) / (material.first_crush_stress or 1.0)


@dataclass
class Paper:
    """The continuum of two sizes, on one grid for each start while a search goes on."""

    step: float = 1e-3
    grids: list[LogGrid] = field(default_factory=list)

    def prepare(self, material: Material, specimens: Sequence[Specimen]) -> None:
        """Size the grids."""
        self.grids = [
            fitting_grid(one.start, material, float(ratios(material, one.loads).max()), spacing=SPACING)
            for one in specimens
        ]

    def curves(self, material: Material, which: int, specimen: Specimen, loading_rate: float) -> list[Floats]:
        """(M,) mass finer than the sieves, under each load."""
        simulation = Simulation(material, specimen.start, grid=self.grids[which])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResolutionWarning)  # far from the best parameters they mean nothing
            run = simulation.run(**_loads(material, specimen.loads), loading_rate=loading_rate, keep_fabrics=[])
        return [run.curve(k).finer_than(size) for k, size in enumerate(specimen.sizes)]


@dataclass
class ResolvedLaw:
    """The law of three cells, whose bins have the sieves among their edges."""

    step: float = 3e-3

    def prepare(self, material: Material, specimens: Sequence[Specimen]) -> None:
        """Nothing is to be chosen: its bins follow from start and sieves."""

    def curves(self, material: Material, which: int, specimen: Specimen, loading_rate: float) -> list[Floats]:
        """(M,) mass finer than the sieves, under each load."""
        sieves = np.unique(np.concatenate(specimen.sizes))
        simulation = Simulation(material, specimen.start, closure="resolved", sizes=[float(size) for size in sieves])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResolutionWarning)
            run = simulation.run(**_loads(material, specimen.loads))
        return [run.curve(k).finer_than(size) for k, size in enumerate(specimen.sizes)]


@dataclass
class LatticeModel:
    """The stochastic lattice, always with the same random numbers, so that its noise is a function of the parameters.

    Attributes
    ----------
    cells, seed, threads : int
        Grains, seed of the generator, threads.
    """

    cells: int = 100_000
    seed: int = 0
    threads: int = 1
    step: float = 0.1

    def prepare(self, material: Material, specimens: Sequence[Specimen]) -> None:
        """Nothing is to be chosen."""

    def curves(self, material: Material, which: int, specimen: Specimen, loading_rate: float) -> list[Floats]:
        """(M,) mass finer than the sieves, under each load."""
        lattice = Lattice(self.cells, material, specimen.start, seed=self.seed + which, threads=self.threads)
        found = []
        for load, size in zip(ratios(material, specimen.loads), specimen.sizes, strict=True):
            lattice.load_to(float(load))
            found.append(np.searchsorted(np.sort(lattice.psi[0]), np.log(size) + BESIDE, side="right") / self.cells)
        return found

"""Runs: a start, a load path, and the engine that takes one through the other."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable
from typing import Literal, Unpack

from comminute._core import Fabric, Grading, LogGrid, Material, ParameterError, fitting_grid, mixed_fabric
from comminute.result import Result, finished
from comminute.runs.continuum import Setup, continuum_run
from comminute.runs.load_path import AxialStress, Keep, Stress, load_path, wanted_fabrics
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning
from comminute.util.choices import EngineName, Kind, Mean, Scheme, require_word
from comminute.util.keywords import suggests_keywords


def _require_parts(material: object, start: object) -> None:
    """Raise TypeError at once for what is no material or no start, and say what to do with a file."""
    if not isinstance(material, Material):
        raise TypeError(f"material is a {type(material).__name__}; it must be a Material")
    if isinstance(start, str | os.PathLike):
        name = os.fspath(start)
        raise TypeError(f"start is '{name}', the name of a file; read it first: Grading.read('{name}')")
    if not isinstance(start, Grading | Fabric):
        raise TypeError(f"start is a {type(start).__name__}; it must be a Grading or a Fabric")


class Simulation:
    """A material and a start, ready to be loaded.

    Parameters
    ----------
    material : Material
    start : Grading or Fabric
        A grading is mixed completely (Eq. 64); a fabric is taken as it is, on its own grid.
    grid : LogGrid, optional
        Grid for a grading. Left out, `run` sizes one from grading, fragments and largest load
        (`fitting_grid`).
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize (Eq. 48 or 65), for a grading.
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`. Time-stepping engines take its fragments
        (`fragment_pmf`) and test zones at bin centres.

    Raises
    ------
    ParameterError
        For a scheme or mean it does not know, or a grid beside a fabric that has another.

    Examples
    --------
    >>> import comminute as cm
    >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0))
    >>> result = sim.run(stress_ratio=[0.5, 1.0])
    >>> result.crushes[0], bool(result.crushes[1] > 0.4)
    (np.float64(0.0), True)
    """

    @suggests_keywords
    def __init__(
        self,
        material: Material,
        start: Grading | Fabric,
        *,
        grid: LogGrid | None = None,
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        _require_parts(material, start)
        require_word("scheme", scheme, Scheme)
        require_word("mean", mean, Mean)
        if isinstance(start, Fabric) and grid is not None and grid != start.grid:
            raise ParameterError(f"grid is {grid} but the fabric has {start.grid}; leave grid out")
        self.material = material
        self.start = start
        self.grid = start.grid if isinstance(start, Fabric) else grid
        self.mean: Mean = mean
        self.scheme: Scheme = scheme

    def __eq__(self, other: object) -> bool:
        """Equal in everything that a run depends on."""
        return isinstance(other, Simulation) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        grid = "" if self.grid is None else f", grid={self.grid}"
        return f"Simulation({self.material}, {self.start}{grid}, mean='{self.mean}', scheme='{self.scheme}')"

    def initial_fabric(self, max_stress_ratio: float) -> Fabric:
        """Fabric at the start of a run up to a load, on the grid that the run uses.

        Parameters
        ----------
        max_stress_ratio : float
            Largest load to come; sizes the grid where none was given.

        Returns
        -------
        Fabric
        """
        if isinstance(self.start, Fabric):
            return self.start
        grid = self.grid or fitting_grid(self.start, self.material, max_stress_ratio)
        return mixed_fabric(self.start, grid, mean=self.mean)

    def _setup(self, max_stress_ratio: float) -> Setup:
        """Everything that is the same at all loads of a run up to a load; see `initial_fabric`."""
        fabric = self.initial_fabric(max_stress_ratio)
        if isinstance(self.start, Grading):
            return Setup.mixed(self.material, self.start, fabric, self.scheme)
        return Setup.of_fabric(self.material, fabric, self.scheme)

    @suggests_keywords
    def run(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: Stress | None = None,
        loading_rate: float | Iterable[float] = 0.0,
        remix_after: Iterable[int] = (),
        engine: EngineName = "auto",
        kind: Kind | None = None,
        steps_per_load: int | Literal["rest"] = "rest",
        keep_fabrics: Keep = "auto",
        on_load: Callable[[int], object] | None = None,
        **axial: Unpack[AxialStress],
    ) -> Result:
        """Take the start through a load path.

        Parameters
        ----------
        stress_ratio : float or sequence
            Loads, each >= 0, in any order: unloading and 0 are allowed.
        stress : float or sequence, or ndarray (T, 3, 3) or (T, 6)
            Loads that are quoted as the material's first_crush_stress is; or effective stress tensors, positive in
            compression, rows in the order xx yy zz yz xz xy. `Result.stress` is quoted as first_crush_stress is,
            whichever way the loads are given; they are given in one way.
        p, q : float or sequence, optional
            Loads as mean stress, and axial less radial stress, of axisymmetric tests.
        vertical, k0 : float or sequence, optional
            Loads as vertical stress without lateral strain, and the ratio of the horizontal stress to it; left out,
            the material's own. Tensors and these pairs need the material's stress_measure.
        loading_rate : float or sequence
            Share of the fast kernel (Eq. 67), in [0, 1], one for all or one per load.
        remix_after : sequence of int
            Indices of loads after which the packing is remixed.
        engine : {"auto", "quasi-static", "slow-update", "full-convolution"}
            "auto" takes the quasi-static solver wherever it is exact: every kernel but "exact", to rest.
            Otherwise the slow update for the slow kernel, and the full convolution for the others.
        kind : {"slow", "exact", "fast", "blend"}, optional
            Kernel. Left out: slow, or the blend where a loading rate is given.
        steps_per_load : int or "rest"
            Steps at each load, for time-stepping engines: a number, or as many as bring the state to rest.
        keep_fabrics : {"auto", "all", "last"} or sequence of int
            Loads whose fabric is kept, N x N numbers each. "auto" keeps all that fit into 256 MB, else as many as do,
            evenly over the path and the last among them. `Result.fabric` computes the others again when it is asked
            for them, and what is kept changes no bit of any result.
        on_load : callable, optional
            Called with the index of each load when it is finished, for progress bars.

        Returns
        -------
        Result

        Raises
        ------
        ParameterError
            For a load, rate, index or word outside its range; the message names it. For stresses that are tensile
            throughout, the mark of the other sign; one among others is no load.
        Interrupted
            On Ctrl-C; its `result` has the finished loads.

        Warns
        -----
        ResolutionWarning
            If more than 1 % of the mass ends in the fines bin, if curves are off by more than 1e-3 because neighbours
            there are judged wrongly, or if the bins are too wide for the start or the fragments.

        Examples
        --------
        >>> import numpy as np
        >>> import comminute as cm
        >>> sand = cm.Material(first_crush_stress=10.0, stress_measure="mean")
        >>> sim = cm.Simulation(sand, cm.monodisperse(1.0))
        >>> by_tensors = sim.run(stress=np.stack([np.diag([5.0, 5.0, 20.0]), np.diag([30.0, 30.0, 30.0])]))
        >>> by_tensors.stress
        array([10., 30.])
        >>> by_tensors == sim.run(p=[10.0, 30.0], q=[15.0, 0.0])
        True
        """
        path = load_path(self.material, stress_ratio, stress, loading_rate, remix_after, **axial)
        require_word("engine", engine, EngineName)
        counted = isinstance(steps_per_load, int) and not isinstance(steps_per_load, bool) and steps_per_load >= 1
        if steps_per_load != "rest" and not counted:
            raise ParameterError(f'steps_per_load is {steps_per_load!r}; it must be "rest" or a number of at least 1')
        recipe = Recipe.of(
            path,
            engine=engine,
            kind=kind,
            steps_per_load=steps_per_load,
        )
        setup = self._setup(float(path.stress_ratio.max()))
        wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size, setup.start.grid.bins)
        result = finished(continuum_run(Result, setup, path, recipe, wanted=wanted), on_load)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=2)
        return result

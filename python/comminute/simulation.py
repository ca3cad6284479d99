"""Runs: a start, a load path, and the engine that takes one through the other."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, Unpack

from comminute._core import Fabric, Grading, LogGrid, Material, ParameterError, ResolvedGrid, fitting_grid, mixed_fabric
from comminute.result import ResolvedResult, Result, finished
from comminute.runs.continuum import Setup, continuum_run
from comminute.runs.load_path import AxialStress, Keep, LoadPath, Stress, load_path, wanted_fabrics
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning
from comminute.runs.resolved_run import ResolvedSetup, nodes, require_quasi_static, resolved_run, start_fabric
from comminute.util.choices import Closure, EngineName, Kind, Mean, Scheme, require_word
from comminute.util.errors import parameter_error, scattered
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
    closure : {"paper", "resolved"}
        Knowledge of a cell's neighbours: the mean of their sizes, in a millisecond, or both sizes, in some tenths of a
        second and at a tenth to a fiftieth of the distance to the lattice; see `Resolved` and `compare_closures`. The
        latter takes no grid, scheme, engine or loading rate.
    sizes : sequence of float
        Sizes > 0, in the unit of the grading, at which curves by the resolved closure are wanted, such as sieves: they
        become edges of its bins, beside those of a measured grading. Between edges a curve is read from a straight
        line in ln(size).

    Raises
    ------
    ParameterError
        For a word it does not know, a grid beside a fabric that has another, or an option that the closure does not
        take.

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
        closure: Closure = "paper",
        sizes: Sequence[float] = (),
    ) -> None:
        _require_parts(material, start)
        require_word("scheme", scheme, Scheme)
        require_word("mean", mean, Mean)
        require_word("closure", closure, Closure)
        _require_options(material, closure, start, grid, scheme, sizes)
        if isinstance(start, Fabric) and grid is not None and grid != start.grid:
            raise ParameterError(f"grid is {grid} but the fabric has {start.grid}; leave grid out")
        self.material = material
        self.start = start
        self.grid: LogGrid | ResolvedGrid | None = start.grid if isinstance(start, Fabric) else grid
        if closure == "resolved":
            assert isinstance(start, Grading)  # as the options require
            self.grid = nodes(material, start, sizes)
        self.mean: Mean = mean
        self.scheme: Scheme = scheme
        self.closure: Closure = closure
        self.sizes = tuple(float(size) for size in sizes)

    def __eq__(self, other: object) -> bool:
        """Equal in everything that a run depends on."""
        return isinstance(other, Simulation) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        parts = f"{self.material}, {self.start}"
        if self.closure == "resolved":
            sizes = f", sizes={self.sizes}" if self.sizes else ""
            return f"Simulation({parts}, mean='{self.mean}', closure='resolved'{sizes})"
        grid = "" if self.grid is None else f", grid={self.grid}"
        return f"Simulation({parts}{grid}, mean='{self.mean}', scheme='{self.scheme}')"

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
        if isinstance(self.grid, ResolvedGrid):
            return start_fabric(self.material, self.start, self.grid, self.mean)
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
            Engine of the paper's closure; the resolved one is its own. "auto" takes the quasi-static solver wherever
            it is exact: every kernel but "exact", to rest. Otherwise the slow update for the slow kernel, and the
            full convolution for the others.
        kind : {"slow", "exact", "fast", "blend"}, optional
            Kernel. Left out: slow, or the blend where a loading rate is given.
        steps_per_load : int or "rest"
            Steps at each load, for time-stepping engines: a number, or as many as bring the state to rest.
        keep_fabrics : {"auto", "all", "last"} or sequence of int
            Loads whose fabric is kept, N x N numbers each. "auto" keeps all that fit into 256 MB, else as many as do,
            evenly over the path and the last among them. `Result.fabric` computes the others again when it is asked
            for them, and what is kept changes no bit of any result. The resolved closure keeps none.
        on_load : callable, optional
            Called with the index of each load when it is finished, for progress bars.

        Returns
        -------
        Result
            By the resolved closure a `ResolvedResult`.

        Raises
        ------
        ParameterError
            For a load, rate, index or word outside its range, or a setting that the closure does not take; the message
            names it. For stresses that are tensile throughout, the mark of the other sign; one among others is no load.
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
        if isinstance(self.grid, ResolvedGrid):
            return self._run_resolved(self.grid, path, recipe, keep_fabrics, on_load)
        setup = self._setup(float(path.stress_ratio.max()))
        wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size, setup.start.grid.bins)
        result = finished(continuum_run(Result, setup, path, recipe, wanted=wanted), on_load)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=3)
        return result

    def _run_resolved(
        self,
        grid: ResolvedGrid,
        path: LoadPath,
        recipe: Recipe,
        keep_fabrics: Keep,
        on_load: Callable[[int], object] | None,
    ) -> Result:
        assert isinstance(self.start, Grading)  # as the options require
        require_quasi_static(recipe)
        if recipe.engine != "auto":
            rule = "the resolved closure is its own engine: leave it out"
            raise parameter_error("engine", f"'{recipe.engine}'", rule)
        if not (keep_fabrics == "auto" or (not isinstance(keep_fabrics, str) and len(keep_fabrics) == 0)):
            rule = "a run by the resolved closure keeps none: leave it out, and ask the result for a fabric"
            raise parameter_error("keep_fabrics", repr(keep_fabrics), rule)
        setup = ResolvedSetup(self.material, self.start, grid, self.initial_fabric(float(path.stress_ratio.max())))
        result = finished(resolved_run(ResolvedResult, setup, path, recipe), on_load)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=4)
        return result


def _require_options(
    material: Material,
    closure: Closure,
    start: Grading | Fabric,
    grid: LogGrid | None,
    scheme: Scheme,
    sizes: Sequence[float],
) -> None:
    """Raise ParameterError for an option of one closure that is given to the other, or a size that is none."""
    if closure == "paper":
        if material.strength_scatter:
            raise scattered("the paper's closure")
        if len(sizes):
            rule = "the paper's closure has even bins: give a grid, or closure = 'resolved'"
            raise parameter_error("sizes", _listed(sizes), rule)
        return
    for index, size in enumerate(sizes):
        if not 0.0 < size < math.inf:
            raise parameter_error(f"sizes[{index}]", float(size), "it must be greater than 0 and finite")
    if isinstance(start, Fabric):
        rule = "the resolved closure needs both: start from a Grading, or take Resolved.from_lattice"
        raise parameter_error("start", "a Fabric", rule, finding="knows the mean of two neighbours")
    if grid is not None:
        rule = (
            "the resolved closure makes its own uneven bins: leave it out, or give sizes that are to be edges of them"
        )
        raise parameter_error("grid", grid, rule)
    if scheme != "conservative":
        raise parameter_error("scheme", f"'{scheme}'", "the resolved closure has one scheme: leave it out")


def _listed(values: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:g}" for value in values[:4]) + (", ..." if len(values) > 4 else "") + "]"

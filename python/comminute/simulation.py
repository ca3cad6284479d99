"""Runs: a start, a load path, and the engine that takes one through the other."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Literal

import numpy as np

from comminute._core import Fabric, Grading, LogGrid, Material, ParameterError, fitting_grid, mixed_fabric
from comminute.result import Result
from comminute.runs.load_path import LoadPath, load_path, wanted_fabrics
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning, explained, resolution_warnings
from comminute.runs.walk import Engines, Records, Walk, engine_of, kind_of
from comminute.util.choices import EngineName, Kind, Mean, Scheme, require_word
from comminute.util.keywords import suggests_keywords


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `result` has the loads that were finished (None if there are none)."""

    def __init__(self, result: Result | None) -> None:
        done = 0 if result is None else len(result.stress_ratio)
        super().__init__(f"interrupted after {done} finished loads; they are in .result")
        self.result = result

    def __reduce__(self) -> tuple[type[Interrupted], tuple[Result | None]]:
        """Pickle by what it was made of; exceptions go by their message otherwise."""
        return Interrupted, (self.result,)


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
        For a grading. Left out, `run` sizes one from grading, fragments and largest load
        (`fitting_grid`).
    mean : {"arithmetic", "geometric"}
        How two neighbours make a neighbourhood grainsize (Eq. 48 or 65), for a grading.
    scheme : {"conservative", "paper"}
        How the continuum becomes bins; see `QuasiStatic`. Time-stepping engines take its fragments
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

    @suggests_keywords
    def run(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: float | Iterable[float] | None = None,
        loading_rate: float | Iterable[float] = 0.0,
        remix_after: Iterable[int] = (),
        engine: EngineName = "auto",
        kind: Kind | None = None,
        steps_per_load: int | Literal["rest"] = "rest",
        keep_fabrics: Literal["all", "last"] | Sequence[int] = "all",
        on_load: Callable[[int], object] | None = None,
    ) -> Result:
        """Take the start through a load path.

        Parameters
        ----------
        stress_ratio : float or sequence
            Loads, each >= 0, in any order: unloading and 0 are allowed.
        stress : float or sequence
            The same in the unit of the material's first_crush_stress. Give one of the two.
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
            For time-stepping engines, steps at each load: a number, or as many as bring the state to rest.
        keep_fabrics : {"all", "last"} or sequence of int
            For which loads `Result.fabric` is kept, N x N numbers each.
        on_load : callable, optional
            Called with the index of each load when it is finished, for progress bars.

        Returns
        -------
        Result

        Raises
        ------
        ParameterError
            For a load, rate, index or word outside its range; the message names it.
        Interrupted
            On Ctrl-C; its `result` has the finished loads.

        Warns
        -----
        ResolutionWarning
            If more than 1 % of the mass ends in the fines bin, or the crush zone reaches it.
        """
        path = load_path(self.material, stress_ratio, stress, loading_rate, remix_after)
        require_word("engine", engine, EngineName)
        counted = isinstance(steps_per_load, int) and not isinstance(steps_per_load, bool) and steps_per_load >= 1
        if steps_per_load != "rest" and not counted:
            raise ParameterError(f'steps_per_load is {steps_per_load!r}; it must be "rest" or a number of at least 1')
        fabric = self.initial_fabric(float(path.stress_ratio.max()))
        engines = Engines(fabric.grid, self.material, self.scheme)
        wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size)
        steps = None if steps_per_load == "rest" else steps_per_load
        rules = [kind_of(kind, float(rate)) for rate in path.loading_rate]
        names = [
            engine_of(engine, rule, float(rate), steps=steps)
            for rule, rate in zip(rules, path.loading_rate, strict=True)
        ]
        records = Records()
        walk = Walk(fabric, engines, steps)
        rates, remixed = tuple(path.loading_rate.tolist()), tuple(sorted(path.remix_after))
        chained = len(wanted) == path.stress_ratio.size
        recipe = Recipe(rates, remixed, engine, kind, steps_per_load, by_stress=path.by_stress, chained=chained)
        try:
            for k, load in enumerate(path.stress_ratio):
                rate = float(path.loading_rate[k])
                outcome = walk.load(names[k], rules[k], rate, float(load), with_fabric=k in wanted)
                records.add(outcome, keep=k in wanted)
                if k in path.remix_after:
                    walk.remix()
                if on_load is not None:
                    on_load(k)
        except KeyboardInterrupt:
            done = len(records.outcomes)
            raise Interrupted(self._result(fabric, path, engines, records, recipe) if done else None) from None
        result = self._result(fabric, path, engines, records, recipe)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=2)
        return result

    def _result(self, start: Fabric, path: LoadPath, engines: Engines, records: Records, recipe: Recipe) -> Result:
        done = len(records.outcomes)
        pmf = np.array([outcome.grainsize for outcome in records.outcomes])
        crushes = np.array([outcome.crushed for outcome in records.outcomes])
        ratios = path.stress_ratio[:done]
        unit = self.start.unit if isinstance(self.start, Grading) else ""
        assumed = self.start.notes if isinstance(self.start, Grading) else ()
        return Result(
            material=self.material,
            grid=start.grid,
            start=start,
            unit=unit,
            stress_ratio=ratios,
            stress=None if path.stress is None else path.stress[:done],
            pmf=pmf,
            crushes=crushes,
            mass_error=np.array([math.fsum(row) - 1.0 for row in pmf.tolist()]),
            engine=" + ".join(engines.names),
            scheme=self.scheme,
            notes=(*assumed, *explained(ratios, crushes)),
            warnings=tuple(resolution_warnings(start.grid, self.material, ratios, pmf, unit)),
            fabrics=tuple(records.kept),
            points=tuple(outcome.points for outcome in records.outcomes),
            reports=tuple(outcome.report for outcome in records.outcomes),
            recipe=recipe.of_first(done),
        )

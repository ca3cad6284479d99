"""Runs: a start, a load path, and the engine that takes one through the other."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from comminute._core import (
    CrushZones,
    Fabric,
    FullConvolution,
    Grading,
    LogGrid,
    Material,
    ParameterError,
    SlowUpdate,
    fitting_grid,
    mixed_fabric,
    remix,
)
from comminute.recipe import Recipe
from comminute.results import Result

Kind = Literal["slow", "exact", "fast", "blend"]
Mean = Literal["arithmetic", "geometric"]
Scheme = Literal["conservative", "paper"]
EngineName = Literal["auto", "slow-update", "full-convolution"]
Floats = npt.NDArray[np.float64]

FINES_LIMIT = 0.01


class ResolutionWarning(UserWarning):
    """Curves near the grid's lower end are not to be trusted; the message says below which size."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `result` has the loads that were finished (None if there are none)."""

    def __init__(self, result: Result | None) -> None:
        done = 0 if result is None else len(result.stress_ratio)
        super().__init__(f"interrupted after {done} finished loads; they are in .result")
        self.result = result


@dataclass(frozen=True)
class LoadPath:
    """The loads of one run, checked: one entry of each field per load."""

    stress_ratio: Floats
    stress: Floats | None
    loading_rate: Floats
    remix_after: frozenset[int]
    by_stress: bool


def _loads(name: str, values: float | Iterable[float]) -> Floats:
    loads = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if loads.ndim != 1 or loads.size == 0:
        raise ParameterError(f"{name} has shape {loads.shape}; it must be a list of at least one load")
    for index, load in enumerate(loads):
        if not load >= 0.0:
            raise ParameterError(f"{name}[{index}] is {load:g}; it must be a number of at least 0 (0 is no load)")
    return loads


def _load_path(
    material: Material,
    stress_ratio: float | Iterable[float] | None,
    stress: float | Iterable[float] | None,
    loading_rate: float | Iterable[float],
    remix_after: Iterable[int],
) -> LoadPath:
    if (stress_ratio is None) == (stress is None):
        raise ParameterError("give either stress_ratio or stress, and not both")
    stresses: Floats | None
    if stress is not None:
        stresses = _loads("stress", stress)
        ratios = np.asarray(material.stress_ratio(stresses), dtype=np.float64)
    else:
        assert stress_ratio is not None
        ratios = _loads("stress_ratio", stress_ratio)
        unit = material.first_crush_stress
        stresses = None if unit is None else ratios * unit
    rates = np.asarray(loading_rate, dtype=np.float64)
    if rates.ndim > 1 or (rates.ndim == 1 and rates.shape != ratios.shape):
        raise ParameterError(
            f"loading_rate has shape {rates.shape}; it must be one number or one for each of the {ratios.size} loads"
        )
    rates = np.broadcast_to(rates, ratios.shape).astype(np.float64)
    for index, rate in enumerate(rates):
        if not 0.0 <= rate <= 1.0:
            raise ParameterError(f"loading_rate[{index}] is {rate:g}; it must be between 0 and 1")
    indices = frozenset(int(k) for k in remix_after)
    for index in sorted(indices):
        if not 0 <= index < ratios.size:
            raise ParameterError(f"remix_after has {index}; it must hold indices of loads, 0 to {ratios.size - 1}")
    return LoadPath(ratios, stresses, rates, indices, by_stress=stress is not None)


def _kind_of(kind: Kind | None, rate: float) -> Kind:
    """Kernel of one load: slow unless a rate or a kind says otherwise."""
    if kind is None:
        return "blend" if rate > 0.0 else "slow"
    if rate > 0.0 and kind != "blend":
        raise ParameterError(
            f"loading_rate is {rate:g} but kind is '{kind}'; a rate belongs to the blend: leave kind out"
        )
    return kind


class _Engines:
    """Makes the stepping engine of each load, and keeps it for the loads that want the same."""

    def __init__(self, grid: LogGrid, material: Material, scheme: Scheme, name: EngineName) -> None:
        self._grid = grid
        self._material = material
        self._rule = scheme
        self._name = name
        self._made: dict[tuple[Kind, float], SlowUpdate | FullConvolution] = {}
        self.names: list[str] = []

    def get(self, kind: Kind, rate: float) -> SlowUpdate | FullConvolution:
        name = self._name
        if name == "auto":
            name = "slow-update" if kind == "slow" else "full-convolution"
        if name == "slow-update" and kind != "slow":
            raise ParameterError(
                f'engine "slow-update" has the slow kernel only, and this load asks for kind "{kind}" '
                f'(loading_rate {rate:g}); use engine "full-convolution" or "auto"'
            )
        if name not in self.names:
            self.names.append(name)
        rate = rate if kind == "blend" else 0.0
        if (kind, rate) not in self._made:
            self._made[kind, rate] = (
                SlowUpdate(self._grid, self._material, fragment_rule=self._rule)
                if name == "slow-update"
                else FullConvolution(self._grid, self._material, kind, loading_rate=rate, fragment_rule=self._rule)
            )
        return self._made[kind, rate]


@dataclass
class _Records:
    """What a run writes down after each load."""

    pmf: list[Floats] = field(default_factory=list)
    crushes: list[float] = field(default_factory=list)
    mass_error: list[float] = field(default_factory=list)
    fabrics: list[Fabric | None] = field(default_factory=list)

    def add(self, fabric: Fabric, crushed: float, *, keep: bool) -> None:
        self.pmf.append(fabric.grainsize())
        self.crushes.append(crushed + (self.crushes[-1] if self.crushes else 0.0))
        self.mass_error.append(math.fsum(self.pmf[-1]) - 1.0)
        self.fabrics.append(fabric if keep else None)


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
        How fragments fall into bins; see `fragment_pmf`.

    Raises
    ------
    ParameterError
        For a scheme it does not know, or a grid beside a fabric that has another.

    Examples
    --------
    >>> import comminute as cm
    >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0))
    >>> result = sim.run(stress_ratio=[0.5, 1.0])
    >>> result.crushes[0], bool(result.crushes[1] > 0.4)
    (np.float64(0.0), True)
    """

    def __init__(
        self,
        material: Material,
        start: Grading | Fabric,
        *,
        grid: LogGrid | None = None,
        mean: Mean = "arithmetic",
        scheme: Scheme = "conservative",
    ) -> None:
        if scheme not in ("conservative", "paper"):
            raise ParameterError(f"scheme is '{scheme}'; it must be one of 'conservative', 'paper'")
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
        engine : {"auto", "slow-update", "full-convolution"}
            "auto" takes the slow update wherever it does (slow kernel), else the full convolution.
        kind : {"slow", "exact", "fast", "blend"}, optional
            Kernel of the time steps. Left out: slow, or the blend where a loading rate is given.
        steps_per_load : int or "rest"
            Time steps at each load: a number, or as many as bring the state to rest.
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
        path = _load_path(self.material, stress_ratio, stress, loading_rate, remix_after)
        if engine not in ("auto", "slow-update", "full-convolution"):
            raise ParameterError(f"engine is '{engine}'; it must be one of 'auto', 'slow-update', 'full-convolution'")
        if steps_per_load != "rest" and not (isinstance(steps_per_load, int) and steps_per_load >= 1):
            raise ParameterError(f'steps_per_load is {steps_per_load!r}; it must be "rest" or a number of at least 1')
        fabric = self.initial_fabric(float(path.stress_ratio.max()))
        engines = _Engines(fabric.grid, self.material, self.scheme, engine)
        wanted = _wanted(keep_fabrics, path.stress_ratio.size)
        steps = None if steps_per_load == "rest" else steps_per_load
        records = _Records()
        start = fabric
        rates, remixed = tuple(path.loading_rate.tolist()), tuple(sorted(path.remix_after))
        recipe = Recipe(rates, remixed, engine, kind, steps_per_load, path.by_stress)
        try:
            for k, load in enumerate(path.stress_ratio):
                rate = float(path.loading_rate[k])
                stepper = engines.get(_kind_of(kind, rate), rate)
                fabric, crushed = _settled(fabric, float(load), stepper, steps)
                records.add(fabric, crushed, keep=k in wanted)
                if k in path.remix_after:
                    fabric = remix(fabric)
                if on_load is not None:
                    on_load(k)
        except KeyboardInterrupt:
            done = len(records.pmf)
            raise Interrupted(self._result(start, path, engines, records, recipe) if done else None) from None
        result = self._result(start, path, engines, records, recipe)
        for warning in result.warnings:
            warnings.warn(warning, ResolutionWarning, stacklevel=2)
        return result

    def _result(self, start: Fabric, path: LoadPath, engines: _Engines, records: _Records, recipe: Recipe) -> Result:
        done = len(records.pmf)
        pmf = np.array(records.pmf)
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
            crushes=np.array(records.crushes),
            mass_error=np.array(records.mass_error),
            engine=" + ".join(engines.names),
            scheme=self.scheme,
            notes=(*assumed, *_explained(ratios, np.array(records.crushes))),
            warnings=tuple(_resolution_warnings(start.grid, self.material, ratios, pmf, unit)),
            fabrics=tuple(records.fabrics),
            recipe=recipe.of_first(done),
        )


def _settled(
    fabric: Fabric, load: float, engine: SlowUpdate | FullConvolution, steps: int | None
) -> tuple[Fabric, float]:
    """Fabric after one load, and the mass that crushed in psi."""
    p = engine.settle(fabric.probability, load, steps=steps)
    # After a fixed number of steps some mass may still lie inside the zone: at rest under no known load.
    settled = max(load, fabric.settled_at or 0.0) if steps is None else None
    return Fabric(fabric.grid, p, settled_at=settled, mean=fabric.mean), engine.report.crushed


def _wanted(keep: Literal["all", "last"] | Sequence[int], loads: int) -> frozenset[int]:
    if keep == "all":
        return frozenset(range(loads))
    if keep == "last":
        return frozenset([loads - 1])
    if isinstance(keep, str):
        raise ParameterError(f"keep_fabrics is '{keep}'; it must be 'all', 'last' or indices of loads")
    for index in keep:
        if not 0 <= index < loads:
            raise ParameterError(f"keep_fabrics has {index}; it must hold indices of loads, 0 to {loads - 1}")
    return frozenset(keep)


def _explained(loads: Floats, crushes: Floats) -> list[str]:
    """One line each for loads that are allowed but may surprise."""
    notes = []
    if np.any((loads > 0.0) & (loads < 1.0)):
        notes.append("stress ratios below 1 crush only grains larger than the reference size (more so among equals)")
    if np.any(np.diff(loads) < 0.0):
        notes.append("unloading changes nothing: a load crushes only where it exceeds all earlier ones")
    if crushes[-1] == 0.0:
        notes.append("nothing crushed: the load path stays below what the weakest grain bears")
    return notes


def _resolution_warnings(grid: LogGrid, material: Material, loads: Floats, pmf: Floats, unit: str) -> list[str]:
    """Where the fines bin spoils the answer, and below which size."""
    in_unit = f" {unit}" if unit else ""
    found = []
    worst = int(np.argmax(pmf[:, 0]))
    if pmf[worst, 0] > FINES_LIMIT:
        found.append(
            f"{100 * pmf[worst, 0]:.3g} % of the mass lies in the fines bin at stress ratio "
            f"{loads[worst]:g}: curves below a size of {grid.edge_sizes[1]:.3g}{in_unit} are not to be "
            "trusted; lower psi_min"
        )
    distrusted = CrushZones(grid, material, float(loads.max())).distrusted_below
    if distrusted > -math.inf:
        size = math.exp(min(distrusted, 700.0))
        found.append(
            f"the crush zone reaches the fines bin at stress ratio {loads.max():g}: curves below a size of "
            f"{size:.3g}{in_unit} are not exact; lower psi_min"
        )
    return found

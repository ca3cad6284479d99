"""The law of three cells along a load path, from a grading or from where an earlier result ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from comminute._core import (
    Fabric,
    Grading,
    Material,
    PointMass,
    Resolved,
    ResolvedGrid,
    fitting_grid,
    mixed_fabric,
)
from comminute.gradings.curves import SizeCurve
from comminute.runs.load_path import Load, LoadPath
from comminute.runs.outcomes import Outcome, mass_error, outcomes_of, rows
from comminute.runs.path_run import PathRun
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import explained, fines_warnings
from comminute.runs.results import Floats, ResolvedData, closure_error
from comminute.util.choices import Mean
from comminute.util.errors import parameter_error

R = TypeVar("R", bound=ResolvedData)

FABRIC_SPACING = 0.05  # bin width of the fabrics that a law of three cells is shown on
NO_MASS = 1e-15  # at an exact size, which is rounding


@dataclass(frozen=True)
class ResolvedSetup:
    """Everything that is the same at all loads of a run.

    Attributes
    ----------
    material : Material
    grading : Grading
        The start is a random mixture of its grains.
    grid : ResolvedGrid
        Sizes that the law tells apart.
    start : Fabric
        The random mixture, on the even bins of the run's fabrics.
    """

    material: Material
    grading: Grading
    grid: ResolvedGrid
    start: Fabric


def nodes(material: Material, grading: Grading, sizes: Sequence[float]) -> ResolvedGrid:
    """Sizes that a run from a grading tells apart, with `sizes` among the edges of its bins."""
    return ResolvedGrid.fitting(grading, material.fabric_width, edges=[math.log(size) for size in sizes])


def start_fabric(material: Material, grading: Grading, grid: ResolvedGrid, mean: Mean) -> Fabric:
    """Random mixture of a grading on even bins, as far down as the nodes of a grid."""
    even = fitting_grid(grading, material, 0.0, spacing=FABRIC_SPACING, psi_min=float(grid.upper[0]))
    return mixed_fabric(grading, even, mean=mean)


def setup_of(result: ResolvedData) -> ResolvedSetup:
    """Give the setup of the run that made a result."""
    return ResolvedSetup(result.material, result.grading, result.grid, result.start)


@dataclass(slots=True, kw_only=True)
class ResolvedOutcome(Outcome):
    """State of the law of three cells after one load.

    Attributes
    ----------
    avalanches : float
        Avalanches a cell has begun since the start of the path.
    step_error : float
        Largest difference of the coarse and the fine curve.
    """

    avalanches: float
    step_error: float


class ResolvedWalker:
    """Law of three cells on its way along a load path."""

    def __init__(self, setup: ResolvedSetup) -> None:
        self._law = Resolved(setup.material, setup.grading, setup.grid, mean=setup.start.mean)
        self._even = setup.start.grid
        exact = setup.grid.exact
        self._bin = np.cumsum(~exact) - 1  # of each node
        self._exact = np.flatnonzero(exact).tolist()
        self._psi = setup.grid.upper

    def load(self, load: Load, *, with_fabric: bool) -> ResolvedOutcome:
        """Load the law; see `Walker`. It is quasi-static, and knows no loading rate."""
        self.skip(load)
        mass = self._law.pmf()
        grainsize = np.asarray(np.bincount(self._bin, mass), dtype=np.float64)
        return ResolvedOutcome(
            grainsize=grainsize,
            crushed=self._law.crushes,
            mass_error=mass_error(grainsize),
            points=tuple(self._point(k, mass) for k in self._exact if mass[k] > NO_MASS),
            fabric=self.fabric() if with_fabric else None,
            avalanches=self._law.avalanches,
            step_error=self._law.step_error,
        )

    def skip(self, load: Load) -> None:
        """Go past a load whose outcome is known."""
        self._law.load_to(load.stress_ratio)

    def remix(self) -> None:
        """Mix the packing anew."""
        self._law.remix()

    def fabric(self) -> Fabric:
        """Joint law of a cell's size and its neighbourhood's, on even bins."""
        joint = np.maximum(self._law.joint(self._even), 0.0)  # single entries may fall below 0 by the error of a step
        return Fabric(self._even, joint / joint.sum(), settled_at=self._law.settled_at or None, mean=self._law.mean)

    def _point(self, node: int, mass: Floats) -> PointMass:
        return PointMass(float(self._psi[node]), float(mass[node]), math.exp(self._psi[node]))


def fabric_after(result: ResolvedData, path: LoadPath, k: int) -> Fabric:
    """Fabric after load k of a result."""
    walker = ResolvedWalker(setup_of(result))
    for load in path.loads():
        walker.skip(load)
        if load.place == k:
            break
        if load.remixed:
            walker.remix()
    return walker.fabric()


def resolved_outcomes(result: ResolvedData) -> list[ResolvedOutcome]:
    """Outcomes of the loads of a result."""
    return [
        ResolvedOutcome(
            grainsize=outcome.grainsize,
            crushed=outcome.crushed,
            mass_error=outcome.mass_error,
            points=outcome.points,
            avalanches=avalanches,
            step_error=step_error,
        )
        for outcome, avalanches, step_error in zip(
            outcomes_of(result), result.avalanches.tolist(), result.step_error.tolist(), strict=True
        )
    ]


def resolved_run(
    make: Callable[..., R], setup: ResolvedSetup, path: LoadPath, recipe: Recipe, *, earlier: R | None = None
) -> PathRun[ResolvedOutcome, R]:
    """Run of the law of three cells along a load path; the loads are taken when it is iterated over.

    Parameters
    ----------
    make : callable
        Class of the result, which takes the fields of `ResolvedData` by name.
    setup : ResolvedSetup
    path : LoadPath
        All loads, those of the earlier result first.
    recipe : Recipe
        Settings of the run, for the result to carry.
    earlier : ResolvedData, optional
        Result of the first loads. The law is taken through them again, which changes no bit: where it stops on its way
        leaves no trace.

    Returns
    -------
    PathRun
        It keeps no fabrics; a result computes them when it is asked for one.

    Raises
    ------
    ParameterError
        For a material that the law of three cells does not take.
    """
    walker = ResolvedWalker(setup)
    finished = [] if earlier is None else resolved_outcomes(earlier)
    for load, _ in zip(path.loads(), finished, strict=False):
        walker.skip(load)
        if load.remixed:
            walker.remix()

    def result_of(outcomes: Sequence[ResolvedOutcome]) -> R:
        fields = rows(path, outcomes)
        ratios = fields["stress_ratio"]
        return make(
            material=setup.material,
            grid=setup.grid,
            start=setup.start,
            grading=setup.grading,
            unit=setup.grading.unit,
            engine="resolved",
            scheme="three cells",
            notes=(
                *setup.grading.notes,
                *explained(ratios, fields["crushes"], path.remix_after),
                closure_note(setup.material),
            ),
            warnings=tuple(fines_warnings(setup.grid, _first_fines(setup), ratios, fields["pmf"], setup.grading.unit)),
            recipe=recipe.of_first(len(outcomes)),
            measured=SizeCurve.of(setup.grading) if setup.grading.measured else None,
            avalanches=np.array([outcome.avalanches for outcome in outcomes]),
            step_error=np.array([outcome.step_error for outcome in outcomes]),
            **fields,
        )

    return PathRun(walker, path, result_of, wanted=frozenset(), finished=finished)


def require_quasi_static(recipe: Recipe) -> None:
    """Raise ParameterError for a kernel, loading rate or number of steps, which the law of three cells does not know.

    Raises
    ------
    ParameterError
        For the first such setting.
    """
    rates = max(recipe.loading_rate)
    quasi_static = "the lattice and the resolved closure are quasi-static: it must be"
    if rates > 0.0:
        raise parameter_error("loading_rate", rates, f"{quasi_static} 0")
    if recipe.kind not in (None, "slow"):
        raise parameter_error("kind", f"'{recipe.kind}'", f"{quasi_static} 'slow', or left out")
    if recipe.steps_per_load != "rest":
        raise parameter_error("steps_per_load", recipe.steps_per_load, f"{quasi_static} 'rest'")


def closure_note(material: Material) -> str:
    """Tell how near to the lattice the closure is at the fabric width of a material."""
    found, width = closure_error(material), f"fabric width {material.fabric_width:.4g}"
    if math.isnan(found):
        return f"the closure of three cells was compared with the lattice up to a fabric width of 0.4, not at {width}"
    return f"the closure of three cells was found within {found:.2g} of the lattice's curves at {width}"


def _first_fines(setup: ResolvedSetup) -> float:
    return float(setup.grid.pmf(setup.grading)[0])

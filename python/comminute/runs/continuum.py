"""Runs of the continuum along a load path, from a start or from where an earlier result ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from comminute._core import Fabric, Grading, Material, needed_spacing
from comminute.gradings.curves import SizeCurve
from comminute.runs.fines_bin import spoiled_below
from comminute.runs.load_path import LoadPath
from comminute.runs.outcomes import Outcome, outcomes_of, rows
from comminute.runs.path_run import PathRun
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import explained, fines_warnings, reach_warnings, spacing_warnings
from comminute.runs.results import ResultData
from comminute.runs.walk import ContinuumWalker
from comminute.util.choices import Scheme
from comminute.util.errors import parameter_error

R = TypeVar("R", bound=ResultData)


@dataclass(frozen=True)
class Setup:
    """Everything that is the same at all loads of a run.

    Attributes
    ----------
    material : Material
    start : Fabric
        State before the first load.
    scheme : {"conservative", "paper"}
        Scheme by which the continuum becomes bins; see `QuasiStatic`.
    unit : str
        Unit of the sizes; empty where they are relative.
    notes : tuple of str
        Assumptions made about the start, to stand first in the notes of the result.
    measured : SizeCurve, optional
        Sieve data that the start was made of.
    needed_spacing : float
        Bin width that the start and the fragments need; see `comminute.needed_spacing`.
    grading : Grading, optional
        The start is a random mixture of its grains, where it is known.
    """

    material: Material
    start: Fabric
    scheme: Scheme
    unit: str = ""
    notes: tuple[str, ...] = ()
    measured: SizeCurve | None = None
    needed_spacing: float = math.inf
    grading: Grading | None = None

    @classmethod
    def mixed(cls, material: Material, grading: Grading, start: Fabric, scheme: Scheme) -> Setup:
        """Give the setup of a run from a grading, which `start` is made of."""
        measured = SizeCurve.of(grading) if grading.measured else None
        needed = needed_spacing(material, grading)
        return cls(material, start, scheme, grading.unit, grading.notes, measured, needed, grading)

    @classmethod
    def of_fabric(cls, material: Material, start: Fabric, scheme: Scheme) -> Setup:
        """Give the setup of a run from a fabric."""
        return cls(material, start, scheme, needed_spacing=needed_spacing(material))


def setup_of(result: ResultData) -> Setup:
    """Give the setup of the run that made a result; its notes without those to which its loads gave rise."""
    remixed = result.recipe.remix_after if result.recipe else ()
    said_of_loads = explained(result.stress_ratio, result.crushes, remixed)
    notes = tuple(note for note in result.notes if note not in said_of_loads)
    scheme: Scheme = result.scheme  # type: ignore[assignment]
    needed = result.recipe.needed_spacing if result.recipe else needed_spacing(result.material)
    return Setup(result.material, result.start, scheme, result.unit, notes, result.measured, needed)


def recipe_of(result: ResultData) -> Recipe:
    """Recipe of a result; an error where it carries none."""
    if result.recipe is None:
        finding, rule = "does not say how it was made (recipe is None)", "run it with Simulation.run"
        raise parameter_error("recipe", None, rule, subject="the result", finding=finding)
    return result.recipe


def continuum_run(
    make: Callable[..., R],
    setup: Setup,
    path: LoadPath,
    recipe: Recipe,
    *,
    wanted: frozenset[int],
    keep_latest: bool = False,
    earlier: R | None = None,
) -> PathRun[Outcome, R]:
    """Run of the continuum along a load path; the loads are taken when it is iterated over.

    Parameters
    ----------
    make : callable
        Class of the result, which takes the fields of `ResultData` by name.
    setup : Setup
    path : LoadPath
        All loads, those of the earlier result first.
    recipe : Recipe
        Kernels and engines of the loads, for the result to carry.
    wanted, keep_latest
        Fabrics that are kept; see `PathRun`.
    earlier : ResultData, optional
        Result of the first loads, after which the run goes on as one run of all loads would. A remixing among those
        loads, and a time-stepping engine, is gone through again where the fabric before it was not kept.

    Returns
    -------
    PathRun

    Raises
    ------
    ParameterError
        For a load that the engine asked for cannot take.
    """
    walker = ContinuumWalker(setup.start, setup.material, setup.scheme, recipe, path)
    finished = [] if earlier is None else outcomes_of(earlier)
    for load, outcome in zip(path.loads(), finished, strict=False):
        walker.skip(load, outcome)
        if load.remixed:
            walker.remix()

    def result_of(outcomes: Sequence[Outcome]) -> R:
        if earlier is not None and len(outcomes) == len(finished):
            return earlier
        fields = rows(path, outcomes)
        ratios, crushes = fields["stress_ratio"], fields["crushes"]
        spoiled = None
        if len(outcomes) == path.stress_ratio.size:  # the loads are taken once more for this, which is done once
            curves = np.cumsum(fields["pmf"], axis=1)
            spoiled = spoiled_below(setup.start, setup.grading, setup.material, setup.scheme, path, recipe, curves)
        warnings = [
            *spacing_warnings(setup.start.grid, setup.needed_spacing),
            *fines_warnings(setup.start.grid, float(setup.start.grainsize()[0]), ratios, fields["pmf"], setup.unit),
            *reach_warnings(spoiled, float(ratios.max()), setup.unit),
        ]
        return make(
            material=setup.material,
            grid=setup.start.grid,
            start=setup.start,
            unit=setup.unit,
            engine=walker.engine,
            scheme=setup.scheme,
            notes=(*setup.notes, *explained(ratios, crushes, path.remix_after)),
            warnings=tuple(warnings),
            recipe=replace(recipe.of_first(len(outcomes)), needed_spacing=setup.needed_spacing),
            measured=setup.measured,
            **fields,
        )

    return PathRun(
        walker,
        path,
        result_of,
        wanted=wanted,
        keep_latest=keep_latest,
        finished=finished,
    )

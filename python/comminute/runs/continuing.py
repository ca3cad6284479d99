"""Results taken further and run again, load by load and bit for bit."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from comminute._core import Fabric
from comminute.runs.continuum import continuum_run, recipe_of, setup_of
from comminute.runs.load_path import LoadPath
from comminute.runs.outcomes import outcomes_of
from comminute.runs.path_run import PathRun
from comminute.runs.resolved_run import fabric_after as resolved_fabric_after
from comminute.runs.resolved_run import resolved_run
from comminute.runs.resolved_run import setup_of as resolved_setup_of
from comminute.runs.results import ResolvedData, ResultData
from comminute.runs.walk import ContinuumWalker

R = TypeVar("R", bound=ResultData)


def path_of(result: ResultData) -> LoadPath:
    """Load path of a result."""
    recipe = recipe_of(result)
    rates = np.array(recipe.loading_rate)
    return LoadPath(result.stress_ratio, result.stress, rates, frozenset(recipe.remix_after), recipe.by_stress)


def kept_of(result: ResultData) -> frozenset[int]:
    """Find the loads whose fabric a result has."""
    return frozenset(k for k, fabric in enumerate(result.fabrics) if fabric is not None)


def fabric_after(result: ResultData, k: int) -> Fabric:
    """Compute the fabric after load k of a result again, to the bits that a run which keeps it has.

    Raises
    ------
    ParameterError
        If the result has no recipe.
    """
    if isinstance(result, ResolvedData):
        return resolved_fabric_after(result, path_of(result), k)
    path = path_of(result)
    walker = ContinuumWalker(result.start, result.material, setup_of(result).scheme, recipe_of(result), path)
    loads = path.loads()
    for outcome, load in zip(outcomes_of(result)[:k], loads, strict=False):
        walker.skip(load, outcome)
        if load.remixed:
            walker.remix()
    fabric = walker.load(next(loads), with_fabric=True).fabric
    assert fabric is not None
    return fabric


def resumed(result: R, later: LoadPath, wanted: frozenset[int]) -> PathRun[Any, R]:
    """Run that goes on from the last load of a result, to the bits of one run through all loads.

    Parameters
    ----------
    result : ResultData
    later : LoadPath
        Loads to come.
    wanted : frozenset of int
        Indices of those whose fabric is kept, from 0; fabrics that the result has are kept anyhow.

    Returns
    -------
    PathRun
        Its result is of the class of the earlier one, and has all loads.

    Raises
    ------
    ParameterError
        If the result has no recipe, or for a load that its engine cannot take.
    """
    done = result.stress_ratio.size
    path = path_of(result).then(later)
    recipe = replace(
        recipe_of(result),
        loading_rate=tuple(path.loading_rate.tolist()),
        remix_after=tuple(sorted(path.remix_after)),
    )
    if isinstance(result, ResolvedData):
        return resolved_run(type(result), resolved_setup_of(result), path, recipe, earlier=result)
    kept = kept_of(result) | {done + k for k in wanted}
    return continuum_run(type(result), setup_of(result), path, recipe, wanted=kept, earlier=result)


def again(result: R) -> PathRun[Any, R]:
    """Run of the loads of a result, anew from its start, material and recipe; its fabrics are those that it has.

    Raises
    ------
    ParameterError
        If the result has no recipe.
    """
    if isinstance(result, ResolvedData):
        return resolved_run(type(result), resolved_setup_of(result), path_of(result), recipe_of(result))
    return continuum_run(type(result), setup_of(result), path_of(result), recipe_of(result), wanted=kept_of(result))

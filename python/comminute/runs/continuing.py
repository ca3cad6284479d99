"""Results taken further and run again, load by load and bit for bit."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal

import numpy as np

from comminute import simulation
from comminute._core import Fabric, Material, ParameterError, remix
from comminute.result import Result
from comminute.runs.load_path import LoadPath, load_path, wanted_fabrics
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning, explained, resolution_warnings

Keep = Literal["all", "last"] | Sequence[int]


def recipe_of(result: Result) -> Recipe:
    """Recipe of a result; an error where it carries none."""
    if result.recipe is None:
        raise ParameterError("the result does not say how it was made (recipe is None); run it with Simulation.run")
    return result.recipe


def resume(
    result: Result,
    stress_ratio: float | Iterable[float] | None = None,
    *,
    stress: float | Iterable[float] | None = None,
    loading_rate: float | Iterable[float] = 0.0,
    remix_after: Iterable[int] = (),
    keep_fabrics: Keep = "all",
    on_load: Callable[[int], object] | None = None,
) -> Result:
    """Go on from the last load of a result; see `Result.resume`."""
    path = load_path(result.material, stress_ratio, stress, loading_rate, remix_after)
    recipe = recipe_of(result)
    wanted = wanted_fabrics(keep_fabrics, path.stress_ratio.size)
    whole, fabric = result, next_start(result)
    for k in range(path.stress_ratio.size):
        try:
            part = one_load(result.material, result.scheme, fabric, path, k, recipe)
            fabric = part.fabric(0)
            if k in path.remix_after:
                fabric = remix(fabric)
            whole = joined(whole, part, keep=k in wanted, remixed=k in path.remix_after)
            if on_load is not None:
                on_load(k)
        except KeyboardInterrupt:
            raise simulation.Interrupted(whole) from None
    return whole


def next_start(result: Result) -> Fabric:
    """Fabric from which the next load goes on."""
    last = result.stress_ratio.size - 1
    fabric = result.fabric(last)
    return remix(fabric) if last in recipe_of(result).remix_after else fabric


def one_load(material: Material, scheme: str, fabric: Fabric, path: LoadPath, k: int, recipe: Recipe) -> Result:
    """Run load k of a path alone, from a fabric, with the settings of a recipe."""
    settings: dict[str, Any] = {"engine": recipe.engine, "kind": recipe.kind, "steps_per_load": recipe.steps_per_load}
    load: dict[str, Any] = {"stress_ratio": [path.stress_ratio[k]]}
    if path.by_stress and path.stress is not None:
        load = {"stress": [path.stress[k]]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResolutionWarning)  # said once, of the whole
        return simulation.Simulation(material, fabric, scheme=scheme).run(  # type: ignore[arg-type]
            **load, loading_rate=float(path.loading_rate[k]), **settings
        )


def joined(first: Result, then: Result, *, keep: bool, remixed: bool) -> Result:
    """Two results end to end, the second of one load; the fabrics of the first are kept as they are."""
    recipe, loads = recipe_of(first), first.stress_ratio.size
    changes: dict[str, Any] = {}
    for field in dataclasses.fields(Result):
        mine, theirs = getattr(first, field.name), getattr(then, field.name)
        if isinstance(mine, np.ndarray) and isinstance(theirs, np.ndarray) and mine.shape[0] == loads:
            changes[field.name] = np.concatenate([mine, theirs])
        elif field.name in ("points", "reports"):
            changes[field.name] = (*mine, *theirs)
    changes["crushes"] = np.append(first.crushes, then.crushes[0] + first.crushes[-1])
    changes["fabrics"] = (*first.fabrics, then.fabrics[0] if keep else None)
    changes["recipe"] = dataclasses.replace(
        recipe,
        loading_rate=(*recipe.loading_rate, *recipe_of(then).loading_rate),
        remix_after=(*recipe.remix_after, *([loads] if remixed else [])),
    )
    if then.engine not in first.engine.split(" + "):
        changes["engine"] = f"{first.engine} + {then.engine}"
    ratios, crushes = changes["stress_ratio"], changes["crushes"]
    surprising = explained(first.stress_ratio, first.crushes)
    assumed = [note for note in first.notes if note not in surprising]
    changes["notes"] = (*assumed, *explained(ratios, crushes))
    changes["warnings"] = tuple(resolution_warnings(first.grid, first.material, ratios, changes["pmf"], first.unit))
    return dataclasses.replace(first, **changes)


def run_again(result: Result) -> Result:
    """Run a result again from its start, material and recipe.

    Parameters
    ----------
    result : Result

    Returns
    -------
    Result
        Equal to it in every bit, on the same machine and build; in all but the last bits where it was resumed
        after loads whose fabric was not kept.

    Raises
    ------
    ParameterError
        If the result does not say how it was made.

    Examples
    --------
    >>> import comminute as cm
    >>> result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8])
    >>> cm.run_again(result) == result
    True
    """
    recipe = recipe_of(result)
    kept = [k for k, fabric in enumerate(result.fabrics) if fabric is not None]
    loads: dict[str, Any] = {"stress": result.stress} if recipe.by_stress else {"stress_ratio": result.stress_ratio}
    sim = simulation.Simulation(result.material, result.start, scheme=result.scheme)  # type: ignore[arg-type]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResolutionWarning)
        again = sim.run(
            **loads,
            loading_rate=recipe.loading_rate,
            remix_after=recipe.remix_after,
            engine=recipe.engine,  # type: ignore[arg-type]
            kind=recipe.kind,  # type: ignore[arg-type]
            steps_per_load=recipe.steps_per_load,
            keep_fabrics="all" if recipe.chained else kept,
        )
    fabrics = tuple(fabric if k in kept else None for k, fabric in enumerate(again.fabrics))
    labels: dict[str, Any] = {
        "fabrics": fabrics,
        "unit": result.unit,
        "notes": result.notes,
        "warnings": result.warnings,
        "recipe": recipe,
    }
    return dataclasses.replace(again, **labels)

"""How far the fines bin, whose grains are all judged as if they had its size, spoils the curves above it."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice

import numpy as np
import numpy.typing as npt

from comminute._core import CrushZones, Fabric, Grading, LogGrid, Material, Ridge, mixed_fabric
from comminute.runs.load_path import LoadPath
from comminute.runs.recipe import Law, Recipe
from comminute.runs.walk import ContinuumWalker
from comminute.util.choices import Scheme

Floats = npt.NDArray[np.float64]

TOLERABLE_ERROR = 1e-3  # of the mass finer than a size, below which nothing is said
TAIL_LEFT = 0.005  # share of a fragment law that the deeper grid may still leave below itself
MOST_BINS_BELOW = 4000


def spoiled_below(
    start: Fabric,
    grading: Grading | None,
    material: Material,
    scheme: Scheme,
    path: LoadPath,
    recipe: Recipe,
    curves: Floats,
) -> tuple[float, float] | None:
    """Find the size above which the fines bin spoils no curve by more than `TOLERABLE_ERROR`.

    A pair is judged wrongly only where a grain of it is in the fines bin. Such pairs are no more than the fines at the
    start of the run and of each mixing, and where the zone reaches the bin; where those are enough to matter, the
    loads are taken once more on a grid that goes on below, and the curves compared.

    Parameters
    ----------
    start : Fabric
        State before the first load.
    grading : Grading, optional
        The start is a random mixture of its grains; without it, fines of the start have one size on both grids.
    material : Material
    scheme : {"conservative", "paper"}
    path : LoadPath
    recipe : Recipe
    curves : ndarray (T, N)
        Mass fraction finer than the upper edges of the bins after the first T loads.

    Returns
    -------
    (float, float), optional
        That size, and the largest error below it; None where no curve is spoiled.
    """
    grid, loads = start.grid, curves.shape[0]
    zones = CrushZones(grid, material, float(path.stress_ratio[:loads].max()))
    mixed = [place for place in path.remix_after if place < loads - 1]
    misplaced = mixed_in = float(start.grainsize()[0] + curves[mixed, 0].sum())
    if reaches_fines(zones, material):
        misplaced += float(curves[:, 0].max())
    if misplaced <= TOLERABLE_ERROR:
        return None
    kind = None if recipe.kind == "exact" else recipe.kind
    solved = replace(recipe, engine="auto", kind=kind, steps_per_load="rest")
    below = _bins_below(grid, zones, material.fragments, mixed=mixed_in > 0.0)
    deeper = _with_bins_below(start, grading, below)
    of_deeper = _curves_of(deeper, material, scheme, path, solved, loads)[:, below:]
    if solved != recipe:
        curves = _curves_of(start, material, scheme, path, solved, loads)
    error = np.abs(curves - of_deeper).max(axis=0)
    spoiled = np.flatnonzero(error > TOLERABLE_ERROR)
    if spoiled.size == 0:
        return None
    return float(grid.edge_sizes[min(int(spoiled[-1]) + 2, grid.bins)]), float(error.max())


def reaches_fines(zones: CrushZones, material: Material) -> bool:
    """Tell whether a crush zone has grains of the fines bin in it, beside others."""
    return bool(np.isfinite(material.fabric_width) and np.any(zones.band[1:] == np.arange(1, zones.band.size)))


def _bins_below(grid: LogGrid, zones: CrushZones, fragments: Law, *, mixed: bool) -> int:
    """Count the bins to add below: to where the last grains that crush leave few fragments, or no zone reaches.

    A mixing of fines hands an error on to grains whose zones reach those that it was made in, and so past that end.
    """
    reach = float(np.max(zones.half_width(grid.centres) - grid.centres)) + grid.psi_min
    depths = np.arange(1, MOST_BINS_BELOW)
    crushing = zones.half_width(grid.psi_min - grid.spacing * depths) >= 0.0
    few = fragments.cdf(-grid.spacing * depths) <= TAIL_LEFT
    tail = int(np.argmax(few)) + 1 if few.any() else MOST_BINS_BELOW
    bins = min(int(crushing.sum()) + tail, MOST_BINS_BELOW)
    return bins if mixed else min(math.ceil(reach / grid.spacing), bins)


def _with_bins_below(fabric: Fabric, grading: Grading | None, below: int) -> Fabric:
    """Give the same state on a grid that has more bins at its lower end."""
    grid = fabric.grid
    deeper = LogGrid(grid.psi_min - below * grid.spacing, grid.psi_max, grid.bins + below)
    if grading is not None:
        return mixed_fabric(grading, deeper, mean=fabric.mean)
    return Fabric(
        deeper,
        np.pad(fabric.probability, ((below, 0), (below, 0))),
        fabric.atoms,
        settled_at=fabric.settled_at,
        mean=fabric.mean,
        ridges=[Ridge(ridge.exact, ridge.at, np.pad(ridge.mass, (below, 0)), ridge.above) for ridge in fabric.ridges],
        largest=fabric.largest,
    )


def _curves_of(start: Fabric, material: Material, scheme: Scheme, path: LoadPath, recipe: Recipe, loads: int) -> Floats:
    walker = ContinuumWalker(start, material, scheme, recipe, path)
    gradings = list[Floats]()
    for load in islice(path.loads(), loads):
        gradings.append(walker.load(load, with_fabric=False).grainsize)
        if load.remixed:
            walker.remix()
    return np.cumsum(gradings, axis=1)

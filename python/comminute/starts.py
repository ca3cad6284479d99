"""Starts of what holds one packing: a grading is mixed on a grid, a fabric is taken as it is."""

from __future__ import annotations

from comminute._core import Fabric, Grading, LogGrid, Material, fitting_grid, mixed_fabric
from comminute.util.choices import Mean, require_word
from comminute.util.errors import parameter_error


def fabric_of(
    material: Material, start: Grading | Fabric, grid: LogGrid | None, max_stress_ratio: float, mean: Mean
) -> Fabric:
    """Give the fabric of a start.

    Parameters
    ----------
    material : Material
    start : Grading or Fabric
    grid : LogGrid, optional
        Grid for a grading; left out, one is sized from grading, fragments and largest load (`fitting_grid`).
    max_stress_ratio : float
        Largest load that the grid is sized for, > 0.
    mean : {"arithmetic", "geometric"}
        Mean by which two neighbours make a neighbourhood grainsize, for a grading.

    Raises
    ------
    ParameterError
        For a word outside its range, or another grid than a fabric's own.
    """
    require_word("mean", mean, Mean)
    if isinstance(start, Grading):
        return mixed_fabric(start, grid or fitting_grid(start, material, max_stress_ratio), mean=mean)
    if grid is not None and grid != start.grid:
        raise parameter_error("grid", grid, f"the fabric has {start.grid}; leave grid out")
    return start

"""Crushing by size alone, the fabric model with its fabric switched off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, QuasiStatic, fitting_grid, mixed_fabric
from comminute.gradings.curves import SizeCurve
from comminute.runs.recipe import material_of, material_record
from comminute.util.errors import parameter_error

Many = Sequence[float] | npt.NDArray[np.float64]


@overload
def size_threshold(
    start: Grading, material: Material, stress_ratio: float, *, spacing: float | None = ...
) -> SizeCurve: ...
@overload
def size_threshold(
    start: Grading, material: Material, stress_ratio: Many, *, spacing: float | None = ...
) -> list[SizeCurve]: ...
def size_threshold(
    start: Grading, material: Material, stress_ratio: float | Many, *, spacing: float | None = None
) -> SizeCurve | list[SizeCurve]:
    """Grading after every grain that is larger than the load allows has crushed until it is not.

    A grain bears a load whatever its neighbours: up to the size reference_size * stress_ratio**(-w / 3), w the Weibull
    modulus, which is the paper's model as the fabric width grows without end.

    Parameters
    ----------
    start : Grading
    material : Material
        Grains; their fabric width does not count.
    stress_ratio : float or sequence of float
        Loads, each from rest.
    spacing : float, optional
        Width of the bins in ln(size); left out, as a run would have it.

    Returns
    -------
    SizeCurve, or a list of them for several loads

    Raises
    ------
    ParameterError
        For loads outside their range.

    Examples
    --------
    >>> import comminute as cm
    >>> curve = cm.comparators.size_threshold(cm.monodisperse(1.0), cm.Material(), 8.0)
    >>> float(curve.size[-1].round(6))  # 8**-1
    0.125
    """
    loads = np.atleast_1d(np.asarray(stress_ratio, dtype=np.float64))
    for load in loads:
        if not 0.0 <= load < np.inf:
            raise parameter_error("stress_ratio", float(load), "it must be a finite number of at least 0")
    grains = material_of(material_record(material) | {"fabric_width": np.inf})
    curves = [_after(start, grains, float(load), spacing) for load in loads]
    return curves if np.ndim(stress_ratio) else curves[0]


def _after(start: Grading, grains: Material, load: float, spacing: float | None) -> SizeCurve:
    """Curve under one load, on bins of which one ends at the largest size that bears it."""
    fitted = fitting_grid(start, grains, load, spacing=spacing)
    grid = fitted
    if load > 0.0:
        bears = np.log(grains.reference_size) - grains.weibull_modulus / 3.0 * np.log(load)
        shift = (bears - fitted.edges[0]) % fitted.spacing
        grid = LogGrid(fitted.psi_min + shift - fitted.spacing, fitted.psi_max + shift, fitted.bins + 1)
    fabric = mixed_fabric(start, grid)
    after = QuasiStatic(grid, grains).grading_after(fabric, load)
    return SizeCurve.on_grid(grid, np.cumsum(after.grainsize), start.unit, after.points, fabric.largest)

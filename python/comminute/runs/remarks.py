"""Remarks on a result in plain words: loads that may surprise, sizes at which its curves are not to be trusted."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from comminute._core import CrushZones, LogGrid, Material
from comminute.runs.results import ResultData

Floats = npt.NDArray[np.float64]

FINES_LIMIT = 0.01  # share of the mass in the fines bin above which a result warns


class ResolutionWarning(UserWarning):
    """Curves near the grid's lower end are not to be trusted; the message says below which size."""


def load_labels(result: ResultData) -> tuple[str, list[str]]:
    """Name of the loads' quantity with its unit, stress where it is known, and a text for each load, none twice."""
    quantity, loads = "stress ratio", result.stress_ratio
    if result.stress is not None:
        unit = result.recipe.stress_unit if result.recipe else ""
        quantity, loads = f"stress ({unit})" if unit else "stress", result.stress
    texts = list[str]()
    for load in loads:
        text = f"{float(f'{load:.4g}'):g}"  # four digits, and 10000 rather than 1e+04
        while text in texts:  # the same load again, after a remixing or unloading
            text += "'"
        texts.append(text)
    return quantity, texts


def explained(loads: Floats, crushes: Floats) -> list[str]:
    """One line each for loads that are allowed but may surprise."""
    notes = []
    if np.any((loads > 0.0) & (loads < 1.0)):
        notes.append("stress ratios below 1 crush only grains larger than the reference size (more so among equals)")
    if np.any(np.diff(loads) < 0.0):
        notes.append("unloading changes nothing: a load crushes only where it exceeds all earlier ones")
    if crushes[-1] == 0.0:
        notes.append("nothing crushed: the load path stays below what the weakest grain bears")
    return notes


def resolution_warnings(grid: LogGrid, material: Material, loads: Floats, pmf: Floats, unit: str) -> list[str]:
    """One line for each way in which the fines bin spoils the curves, with the size below which it does."""
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

"""Remarks on a result in plain words: loads that may surprise, sizes at which its curves are not to be trusted."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from comminute._core import LogGrid, ResolvedGrid
from comminute.runs.results import ResultData

Floats = npt.NDArray[np.float64]

NEEDED_ERROR = 2e-3  # error of a curve whose bins are as wide as `needed_spacing`; it grows as the width's square
NEGLIGIBLE_ERROR = 5e-3  # expected error below which nothing is said
MOST_ERROR = 0.5  # of a curve, however coarse its bins
NO_CRUSHES = 1e-15  # crushes a cell that are rounding: not one grain in any packing
FINES_LIMIT = 0.01  # share of the mass in the fines bin above which a result warns


class ResolutionWarning(UserWarning):
    """Curves are less exact than a user expects; the message says below which size, or by how much."""


def load_text(load: float) -> str:
    """Text of a load of four digits, 10000 rather than 1e+04."""
    return f"{float(f'{load:.4g}'):g}"


def load_labels(result: ResultData) -> tuple[str, list[str]]:
    """Name of the loads' quantity with its unit, stress where it is known, and a text for each load, none twice."""
    quantity, loads = "stress ratio", result.stress_ratio
    if result.stress is not None:
        unit = result.recipe.stress_unit if result.recipe else ""
        quantity, loads = f"stress ({unit})" if unit else "stress", result.stress
    texts = list[str]()
    for load in loads:
        text = load_text(load)
        while text in texts:  # the same load again, after a remixing or unloading
            text += "'"
        texts.append(text)
    return quantity, texts


def explained(loads: Floats, crushes: Floats, remix_after: Iterable[int]) -> list[str]:
    """One line each for loads that are allowed but may surprise."""
    remixed = sorted(k for k in remix_after if k + 1 < loads.size)
    notes = []
    if np.any((loads > 0.0) & (loads < 1.0)):
        notes.append("stress ratios below 1 crush only grains larger than the reference size (more so among equals)")
    segments = np.split(loads, [k + 1 for k in remixed])
    if any(np.any(np.diff(segment) < 0.0) for segment in segments):
        earlier = "all earlier ones since the last remixing" if remixed else "all earlier ones"
        notes.append(f"unloading changes nothing: a load crushes only where it exceeds {earlier}")
    if any(loads[k + 1] < loads[: k + 1].max() for k in remixed):
        notes.append("after a remixing grains have new neighbours, so a load may crush that is lower than earlier ones")
    if crushes[-1] <= NO_CRUSHES:
        notes.append("nothing crushed: the load path stays below what the weakest grain bears")
    return notes


def spacing_warnings(grid: LogGrid, needed: float) -> list[str]:
    """One line where bins are wider than the start and the fragments need, with the error to expect."""
    expected = NEEDED_ERROR * (grid.spacing / needed) ** 2 if needed > 0.0 else math.inf
    if not expected > NEGLIGIBLE_ERROR:
        return []
    need = f"need {needed:.2g}" if needed > 0.0 else "need bins without end"
    error = f"of about {expected:.1g}" if expected < MOST_ERROR else f"up to {MOST_ERROR}"
    return [
        f"bins are {grid.spacing:.2g} wide in ln(size), where the start and the fragments {need}: expect errors "
        f"{error} in the mass finer than a size; take more bins"
    ]


def fines_warnings(
    grid: LogGrid | ResolvedGrid, first_fines: float, loads: Floats, pmf: Floats, unit: str
) -> list[str]:
    """One line where much of the mass is too fine for the grid, with what that spoils."""
    remedy = "ask for finer sizes" if isinstance(grid, ResolvedGrid) else "lower psi_min"
    if first_fines > FINES_LIMIT:
        return [
            f"{100 * first_fines:.3g} % of the start lies in the fines bin: curves below a size of "
            f"{grid.edge_sizes[1]:.3g}{_in(unit)} are not to be trusted, and grains beside such fines are judged "
            f"wrongly; {remedy}"
        ]
    worst = int(np.argmax(pmf[:, 0]))
    if not pmf[worst, 0] > FINES_LIMIT:
        return []
    return [
        f"{100 * pmf[worst, 0]:.3g} % of the mass lies in the fines bin at stress ratio {loads[worst]:.4g}: curves "
        f"below a size of {grid.edge_sizes[1]:.3g}{_in(unit)} are not to be trusted; {remedy}"
    ]


def reach_warnings(spoiled: tuple[float, float] | None, load: float, unit: str) -> list[str]:
    """One line where the crush zone reaches the fines bin, with the error of the curves and where it ends."""
    if spoiled is None:
        return []
    size, error = spoiled
    return [
        f"neighbours in the fines bin are judged as if they had its size: curves below a size of {size:.3g}{_in(unit)} "
        f"are off by up to {error:.1g} at stress ratios up to {load:.4g}; lower psi_min"
    ]


def _in(unit: str) -> str:
    return f" {unit}" if unit else ""

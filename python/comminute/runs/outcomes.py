"""Outcomes of single loads, and the rows of a result that they make."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from comminute._core import Fabric, PointMass
from comminute.runs.load_path import LoadPath
from comminute.runs.results import Report, ResultData

Floats = npt.NDArray[np.float64]


@dataclass(slots=True)
class Outcome:
    """State of a packing after one load.

    Attributes
    ----------
    grainsize : ndarray (N,)
        Mass by bin.
    crushed : float
        Mean number of crushes a cell has been through since the start of the path.
    mass_error : float
        Total mass less 1.
    points : tuple of PointMass
        Mass that still has an exact size.
    report : SolveReport or StepReport, optional
        Account of the engine, where it gives one.
    fabric : Fabric, optional
        Fabric before a remixing, where it is asked for or comes with the step.
    """

    grainsize: Floats
    crushed: float
    mass_error: float
    points: tuple[PointMass, ...] = ()
    report: Report | None = None
    fabric: Fabric | None = None


def mass_error(grainsize: Floats) -> float:
    """Total of a grading less 1, summed exactly: what a sum of its own would add is as large as the error."""
    return math.fsum(grainsize.tolist()) - 1.0


def outcomes_of(result: ResultData) -> list[Outcome]:
    """Outcomes of the loads of a result, from which `rows` makes its arrays again bit for bit."""
    loads = result.stress_ratio.size
    rows = zip(
        result.pmf,
        result.crushes.tolist(),
        result.mass_error.tolist(),
        result.points or ((),) * loads,
        result.reports or (None,) * loads,
        result.fabrics or (None,) * loads,
        strict=True,
    )
    return [Outcome(*row) for row in rows]


def rows(path: LoadPath, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Fields of a result that have one entry per load, of the first loads of a path, by name."""
    done = len(outcomes)
    return {
        "stress_ratio": path.stress_ratio[:done],
        "stress": None if path.stress is None else path.stress[:done],
        "pmf": np.array([outcome.grainsize for outcome in outcomes]),
        "crushes": np.array([outcome.crushed for outcome in outcomes]),
        "mass_error": np.array([outcome.mass_error for outcome in outcomes]),
        "fabrics": tuple(outcome.fabric for outcome in outcomes),
        "points": tuple(outcome.points for outcome in outcomes),
        "reports": tuple(outcome.report for outcome in outcomes if outcome.report is not None),
    }

"""Columns on their way through times, whatever their rows are made of."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
import numpy.typing as npt

from comminute._core import Material
from comminute.columns.drive import ByRow, Given, ShearMixing, by_row, stress_ratios
from comminute.gradings.sieves import convert
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


class Loaded(Protocol):
    """Rows of the core that take loads."""

    def load_to(self, stress_ratio: Sequence[float]) -> None:
        """Raise the loads."""

    def stand_under(self, stress_ratio: Sequence[float]) -> None:
        """Take loads without a crush."""


@dataclass(frozen=True)
class Drive:
    """Loads and rates of a run, by row and time.

    Attributes
    ----------
    loads, shear : callable
        Stress ratios and shear rates of the rows at a time.
    mixing, shear_mixing : float
        Diffusivity; and that of mixing by shear, over the shear rate and the square of the mean size in its own unit.
    segregation, crush_rate : float
    step : float, optional
        Longest time after which loads and shear rates are taken anew.
    """

    loads: ByRow
    shear: ByRow
    mixing: float
    shear_mixing: float
    segregation: float
    crush_rate: float
    step: float | None


def drive_of(
    material: Material,
    unit: str,
    z: Floats,
    times: Floats,
    *,
    stress_ratio: Given | None,
    stress: Given | None,
    shear_rate: Given,
    segregation: float,
    mixing: float | ShearMixing,
    crush_rate: float,
    step: float | None,
) -> Drive:
    """Read what drives a column; see `ColumnLattice.run`.

    Raises
    ------
    ParameterError
        For times that do not rise, a step that is not greater than 0, loads of another shape, and for mixing by shear
        of sizes without a unit of length.
    """
    if times.ndim != 1 or times.size == 0 or np.any(np.diff(times) <= 0.0) or not np.all(np.isfinite(times)):
        raise parameter_error("time", subject="time", finding="must rise, from one time at least")
    if step is not None and not step > 0.0:
        raise parameter_error("step", step, "it must be greater than 0")
    constant, by_shear = (0.0, mixing.factor) if isinstance(mixing, ShearMixing) else (float(mixing), 0.0)
    if by_shear > 0.0:
        if not unit:
            raise parameter_error(
                "mixing", subject="mixing by shear", finding="needs sizes in a unit of length", remedy="name_unit"
            )
        by_shear *= convert(1.0, unit, "m") ** 2
    return Drive(
        stress_ratios(material, stress_ratio, stress, z, times),
        by_row("shear_rate", shear_rate, z, times),
        constant,
        by_shear,
        float(segregation),
        float(crush_rate),
        step,
    )


def walk(
    core: Loaded, advance: Callable[[float, list[float]], int], drive: Drive, times: Floats
) -> Iterator[tuple[list[float], int]]:
    """Take a column from time to time; at each give its loads, and the exchanges since the time before.

    Loads are raised at the first time, before anything is exchanged, and at the end of each step.

    Parameters
    ----------
    core : Loaded
    advance : callable
        Takes a time and the shear rates of the rows; gives the number of exchanges.
    drive : Drive
    times : ndarray (T,)
    """
    raised = core.load_to if math.isinf(drive.crush_rate) else core.stand_under
    raised(drive.loads(times[0]))
    yield drive.loads(times[0]), 0
    for before, now in pairwise(times.tolist()):
        parts = 1 if drive.step is None else max(math.ceil((now - before) / drive.step - 1e-9), 1)
        ends = [before + (now - before) * part / parts for part in range(parts + 1)]
        count = 0
        for begin, end in pairwise(ends):
            count += advance(end - begin, drive.shear(0.5 * (begin + end)))
            raised(drive.loads(end))
        yield drive.loads(now), count

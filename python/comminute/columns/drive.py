"""Drive of a column: rates, and numbers that may differ by row and time."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, Material
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
Given = float | Sequence[float] | Floats | Callable[[Floats, float], float | Sequence[float] | Floats]
ByRow = Callable[[float], list[float]]


@dataclass(frozen=True)
class ShearMixing:
    """Mixing by shear: a diffusivity D = factor * shear rate * (mean size)**2, the size in metres.

    Attributes
    ----------
    factor : float
        D_0, about 0.1 for dense flows.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.ShearMixing(0.1)
    ShearMixing(factor=0.1)
    """

    factor: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.factor < math.inf:
            raise parameter_error("factor", self.factor, "it must be at least 0 and finite")


@dataclass(frozen=True)
class Feed:
    """Grains that never run out, beyond an end of a column.

    The row at that end exchanges grains with them as with any row. At a rate, rows of them also push the column on:
    each is a random mixture that enters when it is full, and a row leaves at the other end, which is an outflow.

    Attributes
    ----------
    grading : Grading
    rate : float
        In metres of solid a second; 0: nothing moves on.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.Feed(cm.power_law(2.3, 0.05, 2.0), rate=1e-5).rate
    1e-05
    """

    grading: Grading
    rate: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.rate < math.inf:
            raise parameter_error("rate", self.rate, "it must be at least 0 and finite")


def by_row(name: str, given: Given, z: Floats, times: Floats) -> ByRow:
    """Give the numbers of the rows as a function of the time.

    Parameters
    ----------
    name : str
        Name of the numbers, for errors.
    given : float, (Z,), (T, Z) or callable
        One number, one for each row, one for each time and row with straight lines between, or a function of heights
        and a time.
    z : ndarray (Z,)
        Heights of the rows.
    times : ndarray (T,)

    Raises
    ------
    ParameterError
        For another shape.
    """
    if callable(given):
        return lambda now: _checked(name, given(z, now), z.size)
    numbers = np.asarray(given, dtype=np.float64)
    if numbers.ndim == 2:
        if numbers.shape != (times.size, z.size):
            rule = f"it must be a number, ({z.size},), or ({times.size}, {z.size})"
            raise parameter_error(name, numbers.shape, rule, finding=f"has shape {numbers.shape}")
        return lambda now: [float(np.interp(now, times, numbers[:, row])) for row in range(z.size)]
    fixed = _checked(name, numbers, z.size)
    return lambda _: fixed


def stress_ratios(
    material: Material, stress_ratio: Given | None, stress: Given | None, z: Floats, times: Floats
) -> ByRow:
    """Give the stress ratios of the rows as a function of the time; see `by_row`.

    Raises
    ------
    ParameterError
        Unless one kind of load is given; for stresses of a material without a first crush stress.
    """
    if (stress_ratio is None) == (stress is None):
        raise parameter_error("stress_ratio", subject="give one kind of load:", finding="stress_ratio or stress")
    if stress_ratio is not None:
        return by_row("stress_ratio", stress_ratio, z, times)
    assert stress is not None
    stresses = by_row("stress", stress, z, times)
    return lambda now: list(np.asarray(material.stress_ratio(np.array(stresses(now)))).tolist())


def _checked(name: str, given: float | Sequence[float] | Floats, rows: int) -> list[float]:
    numbers = np.asarray(given, dtype=np.float64)
    if numbers.ndim > 1 or (numbers.ndim == 1 and numbers.shape != (rows,)):
        rule = f"it must be a number or one for each of the {rows} rows"
        raise parameter_error(name, numbers.shape, rule, finding=f"has shape {numbers.shape}")
    return list(np.broadcast_to(numbers, (rows,)).tolist())

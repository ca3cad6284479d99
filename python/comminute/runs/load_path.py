"""The loads of a run, checked, and which of its fabrics are kept."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from comminute._core import Material, ParameterError

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class LoadPath:
    """The loads of one run, checked: one entry of each field per load."""

    stress_ratio: Floats
    stress: Floats | None
    loading_rate: Floats
    remix_after: frozenset[int]
    by_stress: bool


def _loads(name: str, values: float | Iterable[float]) -> Floats:
    loads = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if loads.ndim != 1 or loads.size == 0:
        raise ParameterError(f"{name} has shape {loads.shape}; it must be a list of at least one load")
    for index, load in enumerate(loads):
        if not load >= 0.0:
            raise ParameterError(f"{name}[{index}] is {load:g}; it must be a number of at least 0 (0 is no load)")
    return loads


def _indices(name: str, values: Iterable[int], loads: int) -> frozenset[int]:
    found = set()
    for value in values:
        try:
            index = operator.index(value)
        except TypeError:
            index = -1
        if not 0 <= index < loads:
            raise ParameterError(f"{name} has {value}; it must hold indices of loads, 0 to {loads - 1}")
        found.add(index)
    return frozenset(found)


def load_path(
    material: Material,
    stress_ratio: float | Iterable[float] | None,
    stress: float | Iterable[float] | None,
    loading_rate: float | Iterable[float],
    remix_after: Iterable[int],
) -> LoadPath:
    """Check the loads of a run; see `Simulation.run` for the arguments and what is refused."""
    if (stress_ratio is None) == (stress is None):
        raise ParameterError("give either stress_ratio or stress, and not both")
    stresses: Floats | None
    if stress is not None:
        stresses = _loads("stress", stress)
        ratios = np.asarray(material.stress_ratio(stresses), dtype=np.float64)
    else:
        assert stress_ratio is not None
        ratios = _loads("stress_ratio", stress_ratio)
        unit = material.first_crush_stress
        stresses = None if unit is None else ratios * unit
    rates = np.asarray(loading_rate, dtype=np.float64)
    if rates.ndim > 1 or (rates.ndim == 1 and rates.shape != ratios.shape):
        raise ParameterError(
            f"loading_rate has shape {rates.shape}; it must be one number or one for each of the {ratios.size} loads"
        )
    rates = np.broadcast_to(rates, ratios.shape).astype(np.float64)
    for index, rate in enumerate(rates):
        if not 0.0 <= rate <= 1.0:
            raise ParameterError(f"loading_rate[{index}] is {rate:g}; it must be between 0 and 1")
    return LoadPath(ratios, stresses, rates, _indices("remix_after", remix_after, ratios.size), stress is not None)


def wanted_fabrics(keep: Literal["all", "last"] | Sequence[int], loads: int) -> frozenset[int]:
    """Find the loads whose fabric is kept, by index; see `Simulation.run`."""
    if keep == "all":
        return frozenset(range(loads))
    if keep == "last":
        return frozenset([loads - 1])
    if isinstance(keep, str):
        raise ParameterError(f"keep_fabrics is '{keep}'; it must be 'all', 'last' or indices of loads")
    return _indices("keep_fabrics", keep, loads)

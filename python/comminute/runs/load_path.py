"""Load paths: the loads of a run, checked, and the indices of those whose fabric is kept."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from comminute._core import Material
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


Keep = Literal["auto", "all", "last"] | Sequence[int]
FABRICS_MEMORY = 256_000_000  # bytes of the fabrics that are kept unless told otherwise


class Load(NamedTuple):
    """One load of a path.

    Attributes
    ----------
    place : int
        Index in the path, from 0.
    stress_ratio : float
        Load, >= 0.
    loading_rate : float
        Share of the fast kernel (Eq. 67), in [0, 1].
    remixed : bool
        Whether the packing is remixed after this load.
    """

    place: int
    stress_ratio: float
    loading_rate: float
    remixed: bool


@dataclass(frozen=True)
class LoadPath:
    """Loads of one run, checked.

    Attributes
    ----------
    stress_ratio : ndarray (T,)
        Loads, each >= 0, in any order.
    stress : ndarray (T,) or None
        Loads as stresses, where first_crush_stress is known.
    loading_rate : ndarray (T,)
        Share of the fast kernel at each load.
    remix_after : frozenset of int
        Indices of the loads after which the packing is remixed.
    by_stress : bool
        Whether the loads were given as stresses.
    """

    stress_ratio: Floats
    stress: Floats | None
    loading_rate: Floats
    remix_after: frozenset[int]
    by_stress: bool

    def loads(self, first: int = 0) -> Iterator[Load]:
        """Give the loads one by one, beginning with index `first`."""
        values = zip(self.stress_ratio[first:].tolist(), self.loading_rate[first:].tolist(), strict=True)
        for place, (stress_ratio, loading_rate) in enumerate(values, first):
            yield Load(place, stress_ratio, loading_rate, place in self.remix_after)

    def then(self, later: LoadPath) -> LoadPath:
        """Path of these loads with those of another path after them."""
        size = self.stress_ratio.size
        unknown = self.stress is None or later.stress is None
        return LoadPath(
            np.concatenate([self.stress_ratio, later.stress_ratio]),
            None if unknown else np.concatenate([self.stress, later.stress]),
            np.concatenate([self.loading_rate, later.loading_rate]),
            self.remix_after | {size + k for k in later.remix_after},
            self.by_stress,
        )


def _loads(name: str, values: float | Iterable[float]) -> Floats:
    loads = np.array(values, dtype=np.float64, ndmin=1)  # a copy, since the caller's array may change later
    if loads.ndim != 1 or loads.size == 0:
        rule = "it must be a list of at least one load"
        raise parameter_error(name, loads.shape, rule, finding=f"has shape {loads.shape}")
    for index, load in enumerate(loads):
        if not load >= 0.0:
            raise parameter_error(f"{name}[{index}]", float(load), "it must be a number of at least 0 (0 is no load)")
    return loads


def _indices(name: str, values: Iterable[int], loads: int) -> frozenset[int]:
    found = set()
    for value in values:
        try:
            index = operator.index(value)
        except TypeError:
            index = -1
        if not 0 <= index < loads:
            rule = f"it must hold indices of loads, 0 to {loads - 1}"
            raise parameter_error(name, value, rule, finding=f"has {value}")
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
        raise parameter_error("stress_ratio", subject="give either stress_ratio or stress,", finding="and not both")
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
        rule = f"it must be one number or one for each of the {ratios.size} loads"
        raise parameter_error("loading_rate", rates.shape, rule, finding=f"has shape {rates.shape}")
    rates = np.broadcast_to(rates, ratios.shape).astype(np.float64)
    for index, rate in enumerate(rates):
        if not 0.0 <= rate <= 1.0:
            raise parameter_error(f"loading_rate[{index}]", float(rate), "it must be between 0 and 1")
    return LoadPath(ratios, stresses, rates, _indices("remix_after", remix_after, ratios.size), stress is not None)


def fabric_memory(bins: int) -> int:
    """Bytes of a fabric, its N x N numbers."""
    return 8 * bins * bins


def wanted_fabrics(keep: Keep, loads: int, bins: int) -> frozenset[int]:
    """Find the loads whose fabric is kept, by index, in a path of so many loads; see `Simulation.run`."""
    if keep == "auto":
        most = min(loads, FABRICS_MEMORY // fabric_memory(bins))
        return frozenset(loads - 1 - (k * loads) // most for k in range(most))
    if keep == "all":
        return frozenset(range(loads))
    if keep == "last":
        return frozenset([loads - 1])
    if isinstance(keep, str):
        raise parameter_error("keep_fabrics", f"'{keep}'", "it must be 'auto', 'all', 'last' or indices of loads")
    return _indices("keep_fabrics", keep, loads)

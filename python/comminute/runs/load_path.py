"""Load paths: the loads of a run, checked, and the indices of those whose fabric is kept."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from comminute._core import Material
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


Stress = npt.ArrayLike  # numbers, or tensors
Keep = Literal["auto", "all", "last"] | Sequence[int]
FABRICS_MEMORY = 256_000_000  # bytes of the fabrics that are kept unless told otherwise


class AxialStress(TypedDict, total=False):
    """Loads as stresses of axisymmetric tests, by keyword: p with q, or vertical with k0; see `Material.stress_ratio`.

    Each is one number or one for each load; a k0 that is left out is the material's own.
    """

    p: float | Iterable[float]
    q: float | Iterable[float]
    vertical: float | Iterable[float]
    k0: float | Iterable[float]


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
        Loads as stresses that are quoted as first_crush_stress is, where that is known.
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


def _loads(name: str, values: npt.ArrayLike | Iterable[float]) -> Floats:
    loads = np.array(values, dtype=np.float64, ndmin=1)  # a copy, since the caller's array may change later
    if loads.ndim != 1 or loads.size == 0:
        rule = "it must be a list of at least one load"
        raise parameter_error(name, loads.shape, rule, finding=f"has shape {loads.shape}")
    if not np.all(loads >= 0.0):
        index = int(np.argmin(loads >= 0.0))
        rule = "it must be a number of at least 0 (0 is no load)"
        raise parameter_error(f"{name}[{index}]", float(loads[index]), rule)
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


def _tensor_loads(material: Material, tensors: Floats) -> tuple[Floats, Floats]:
    """Stress ratios and mean stresses of tensors."""
    if material.stress_measure is None:
        rule = "tensors need the material's stress_measure"
        finding = f"has shape {tensors.shape}"
        raise parameter_error("stress", tensors.shape, rule, finding=finding, remedy="set_stress_measure")
    ratios = np.array(material.stress_ratio(tensors), dtype=np.float64, ndmin=1)
    if ratios.ndim != 1 or ratios.size == 0:
        rule = "it must be (T, 3, 3) or (T, 6), a tensor for each of at least one load"
        raise parameter_error("stress", tensors.shape, rule, finding=f"has shape {tensors.shape}")
    square = tensors.shape[-2:] == (3, 3)
    diagonals = np.diagonal(tensors, axis1=-2, axis2=-1) if square else tensors[..., :3]
    return ratios, np.array(diagonals.mean(axis=-1), ndmin=1)


def _axial_loads(material: Material, axial: AxialStress) -> tuple[Floats, Floats]:
    """Stress ratios of axisymmetric stresses, and the stresses whose sign is that of their mean."""
    given = {name: np.array(values, dtype=np.float64) for name, values in axial.items()}
    ratios = np.array(material.stress_ratio(**given), dtype=np.float64, ndmin=1)
    if ratios.ndim != 1 or ratios.size == 0:
        name, rule = next(iter(given)), "it must be a list of at least one load"
        raise parameter_error(name, ratios.shape, rule, finding=f"has shape {ratios.shape}")
    return ratios, given.get("p", given.get("vertical", ratios))


def _require_compression(mean: Floats) -> None:
    """Refuse a path that is in tension throughout, the mark of the other sign; single loads in tension are no load."""
    if np.all(mean <= 0.0) and np.any(mean < 0.0):
        lowest, rule = float(mean.min()), "a packing in tension carries no load"
        finding = f"is tensile, the mean down to {lowest:g}"
        raise parameter_error("stress", lowest, rule, subject="every stress", finding=finding, remedy="turn_sign")


def load_path(
    material: Material,
    stress_ratio: float | Iterable[float] | None,
    stress: Stress | None,
    loading_rate: float | Iterable[float],
    remix_after: Iterable[int],
    **axial: Unpack[AxialStress],
) -> LoadPath:
    """Check the loads of a run; see `Simulation.run` for the arguments and what is refused."""
    for name in axial:
        if name not in AxialStress.__annotations__:
            raise TypeError(f"there is no keyword {name}")
    if (stress_ratio is not None) + (stress is not None) + bool(axial) != 1:
        finding = "stress_ratio, stress, p with q, or vertical with k0"
        raise parameter_error("stress_ratio", subject="give one kind of load:", finding=finding)
    unit = material.first_crush_stress
    numbers: Floats | None = None
    if stress_ratio is not None:
        ratios = _loads("stress_ratio", stress_ratio)
    elif stress is not None and np.ndim(stress) < 2:
        numbers = _loads("stress", stress)
        ratios = np.asarray(material.stress_ratio(numbers), dtype=np.float64)
    else:
        tensors = np.array(stress, dtype=np.float64) if stress is not None else None
        ratios, mean = _axial_loads(material, axial) if tensors is None else _tensor_loads(material, tensors)
        _require_compression(mean)
    stresses = ratios * unit if numbers is None and unit is not None else numbers
    rates = np.asarray(loading_rate, dtype=np.float64)
    if rates.ndim > 1 or (rates.ndim == 1 and rates.shape != ratios.shape):
        rule = f"it must be one number or one for each of the {ratios.size} loads"
        raise parameter_error("loading_rate", rates.shape, rule, finding=f"has shape {rates.shape}")
    rates = np.broadcast_to(rates, ratios.shape).astype(np.float64)
    if not np.all((rates >= 0.0) & (rates <= 1.0)):
        index = int(np.argmin((rates >= 0.0) & (rates <= 1.0)))
        raise parameter_error(f"loading_rate[{index}]", float(rates[index]), "it must be between 0 and 1")
    return LoadPath(ratios, stresses, rates, _indices("remix_after", remix_after, ratios.size), stress_ratio is None)


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

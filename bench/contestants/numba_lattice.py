"""The event-driven lattice in Numba: the same rule with a binary heap in arrays."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from contestants.model import Floats

# A heap entry is a critical load and a cell. Where loads are equal, random keys of the cells decide; they are read then
# only, so a heap move touches two arrays.


@njit(cache=True, inline="always")
def _before(load_a: float, cell_a: int, load_b: float, cell_b: int, ties: npt.NDArray[np.uint64]) -> bool:
    return load_a < load_b or (load_a == load_b and ties[cell_a] < ties[cell_b])


@njit(cache=True)
def _sift_down(
    loads: Floats, cells: npt.NDArray[np.int64], count: int, place: int, ties: npt.NDArray[np.uint64]
) -> None:
    load, cell = loads[place], cells[place]
    while True:
        child = 2 * place + 1
        if child >= count:
            break
        if child + 1 < count and _before(loads[child + 1], cells[child + 1], loads[child], cells[child], ties):
            child += 1
        if not _before(loads[child], cells[child], load, cell, ties):
            break
        loads[place], cells[place] = loads[child], cells[child]
        place = child
    loads[place], cells[place] = load, cell


@njit(cache=True)
def _sift_up(loads: Floats, cells: npt.NDArray[np.int64], place: int, ties: npt.NDArray[np.uint64]) -> None:
    load, cell = loads[place], cells[place]
    while place > 0:
        parent = (place - 1) >> 1
        if not _before(load, cell, loads[parent], cells[parent], ties):
            break
        loads[place], cells[place] = loads[parent], cells[parent]
        place = parent
    loads[place], cells[place] = load, cell


@njit(cache=True, inline="always")
def _critical(psi: Floats, size: Floats, cell: int, width: float) -> float:
    last = psi.shape[0] - 1
    right = 0 if cell == last else cell + 1
    left = last if cell == 0 else cell - 1
    contrast: float = (psi[cell] - math.log(0.5 * (size[left] + size[right]))) / width
    critical: float = -psi[cell] + 0.5 * contrast * contrast
    return critical


@njit(cache=True)
def load_to(
    psi: Floats,
    size: Floats,
    crushes: npt.NDArray[np.uint32],
    ties: npt.NDArray[np.uint64],
    draws: Floats,
    stress_ratio: float,
    width: float,
) -> int:
    """Load one ring (w = 3, reference size 1) in place; returns the number of crushes.

    `draws` is (cells, n): the uniform numbers of each cell's first n crushes. With n = 0 they come from Numba's
    generator, which is faster.
    """
    cells = psi.shape[0]
    load = math.log(stress_ratio) + 1e-13
    scale = math.expm1(-1.0)
    # Entries go stale when a cell's critical load changes, and are dropped when they come up.
    now = np.empty(cells)
    loads = np.empty(4 * cells + 64)
    places = np.empty(4 * cells + 64, dtype=np.int64)
    count = 0
    for cell in range(cells):
        now[cell] = _critical(psi, size, cell, width)
        if now[cell] <= load:
            loads[count], places[count] = now[cell], cell
            count += 1
    for place in range(count // 2 - 1, -1, -1):
        _sift_down(loads, places, count, place, ties)
    total = 0
    while count > 0:
        weakest, cell = loads[0], places[0]
        count -= 1
        if count > 0:
            loads[0], places[0] = loads[count], places[count]
            _sift_down(loads, places, count, 0, ties)
        if weakest != now[cell]:
            continue
        uniform = draws[cell, crushes[cell]] if draws.shape[1] > 0 else 1.0 - np.random.random()  # noqa: NPY002
        psi[cell] += math.log(-math.log1p(uniform * scale))
        size[cell] = math.exp(psi[cell])
        crushes[cell] += 1
        total += 1
        if count + 3 > loads.shape[0]:
            loads, places = np.append(loads, np.empty(count)), np.append(places, np.empty(count, dtype=np.int64))
        for step in range(-1, 2):
            near = (cell + step) % cells
            now[near] = _critical(psi, size, near, width)
            if now[near] <= load:
                loads[count], places[count] = now[near], near
                _sift_up(loads, places, count, ties)
                count += 1
    return total


@njit(cache=True)
def seed(number: int) -> None:
    """Start Numba's generator."""
    np.random.seed(number)  # noqa: NPY002


class NumbaLattice:
    """One ring."""

    def __init__(self, sizes: Floats, ties: npt.NDArray[np.uint64], draws: Floats, width: float = 0.05) -> None:
        self.psi = np.array([math.log(size) for size in sizes])
        self.size = np.array([math.exp(psi) for psi in self.psi])
        self.crushes = np.zeros(len(sizes), dtype=np.uint32)
        self._ties, self._draws, self._width = ties, draws, width

    def load_to(self, stress_ratio: float) -> int:
        """Weakest cell first, up to a load; returns the number of crushes."""
        return int(load_to(self.psi, self.size, self.crushes, self._ties, self._draws, stress_ratio, self._width))

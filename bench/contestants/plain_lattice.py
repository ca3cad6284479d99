"""The event-driven lattice in plain Python: a heap of the cells that the load crushes, stale entries dropped late."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Sequence

Draw = Callable[[int, int], float]  # ln X for a cell and its crush count


def weibull(uniform: Callable[[int, int], float]) -> Draw:
    """Eq. 4 by inversion."""
    scale = math.expm1(-1.0)
    log, log1p = math.log, math.log1p
    return lambda cell, count: log(-log1p(uniform(cell, count) * scale))


class PlainLattice:
    """One ring for w = 3 and reference size 1."""

    def __init__(self, sizes: Sequence[float], draw: Draw, tie_key: Callable[[int], float], width: float = 0.05):
        self.psi = [math.log(size) for size in sizes]
        self.size = [math.exp(psi) for psi in self.psi]
        self.crushes = [0] * len(self.psi)
        self._draw, self._tie_key, self._width = draw, tie_key, width

    def load_to(self, stress_ratio: float) -> int:
        """Weakest cell first, up to a load; returns the number of crushes."""
        psi, size, crushes, width = self.psi, self.size, self.crushes, self._width
        log, exp, push, pop = math.log, math.exp, heapq.heappush, heapq.heappop
        draw, tie_key = self._draw, self._tie_key
        load = log(stress_ratio) + 1e-13
        last = len(psi) - 1

        def critical(cell: int) -> float:
            mean = log(0.5 * (size[cell - 1] + size[cell + 1 if cell < last else 0]))
            contrast = (psi[cell] - mean) / width
            return -psi[cell] + 0.5 * contrast * contrast

        now = [critical(cell) for cell in range(last + 1)]
        heap = [(value, tie_key(cell), cell) for cell, value in enumerate(now) if value <= load]
        heapq.heapify(heap)
        total = 0
        while heap:
            value, _, cell = pop(heap)
            if value != now[cell]:
                continue
            psi[cell] += draw(cell, crushes[cell])
            size[cell] = exp(psi[cell])
            crushes[cell] += 1
            total += 1
            for near in (cell - 1 if cell else last, cell, cell + 1 if cell < last else 0):
                now[near] = value = critical(near)
                if value <= load:
                    push(heap, (value, tie_key(near), near))
        return total

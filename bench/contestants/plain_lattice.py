"""The lattice in plain Python: event driven with a heap whose stale entries are dropped late, and by passes."""

from __future__ import annotations

import heapq
import math
import random
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


class SweptLattice:
    """The loop that comes first to mind: at each load, pass over all cells until none is active.

    The load rises by a factor. Cells are visited in a random order, since equal cells visited from left to right would
    crush every second one.
    """

    def __init__(self, sizes: Sequence[float], generator: random.Random, load_factor: float, width: float = 0.05):
        self.psi = [math.log(size) for size in sizes]
        self.size = [math.exp(psi) for psi in self.psi]
        self._generator, self._factor, self._width = generator, load_factor, width

    def load_to(self, stress_ratio: float) -> int:
        """Raise the load step by step; returns the number of crushes."""
        psi, size, width = self.psi, self.size, self._width
        log, log1p, exp, uniform = math.log, math.log1p, math.exp, self._generator.random
        scale = math.expm1(-1.0)
        last = len(psi) - 1
        order = list(range(last + 1))
        self._generator.shuffle(order)
        steps = math.ceil(log(stress_ratio) / log(self._factor))
        total = 0
        for step in range(steps + 1):
            load = log(stress_ratio) * step / steps + 1e-13
            before = -1
            while total != before:
                before = total
                for cell in order:
                    here = psi[cell]
                    if -here > load:
                        continue
                    contrast = (here - log(0.5 * (size[cell - 1] + size[cell + 1 if cell < last else 0]))) / width
                    if 0.5 * contrast * contrast - here <= load:
                        psi[cell] = here = here + log(-log1p((1.0 - uniform()) * scale))
                        size[cell] = exp(here)
                        total += 1
        return total

"""One exchange between two rows and the crushing after it, cell by cell: a reference for the column lattice.

Written from the rules alone, with random numbers of NumPy's own: each cell of one row may change places with another
cell of the other row; then, as long as any cell is active, one of them crushes, either any or the weakest.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def critical(sizes: Floats, cell: int, fabric_width: float, weibull_modulus: float) -> float:
    """Give the ln of the critical stress ratio of a cell of a ring (Eq. 2), the reference size being 1."""
    neighbours = 0.5 * (sizes[cell - 1] + sizes[(cell + 1) % sizes.size])
    contrast = math.log(sizes[cell] / neighbours) / fabric_width
    return 0.5 * contrast**2 - 3.0 / weibull_modulus * math.log(sizes[cell])


def exchange(
    rows: tuple[Floats, Floats], probability: float, random: np.random.Generator
) -> tuple[list[int], list[int]]:
    """Swap cells of two rows, each with a partner at random; the places that were swapped."""
    lower, upper = rows
    partners = random.permutation(lower.size)
    swapped = np.flatnonzero(random.random(lower.size) < probability)
    above = partners[swapped]
    lower[swapped], upper[above] = upper[above], lower[swapped]
    return swapped.tolist(), above.tolist()


def settle(
    sizes: Floats,
    touched: list[int],
    log_load: float,
    fabric_width: float,
    weibull_modulus: float,
    random: np.random.Generator,
    *,
    weakest: bool,
) -> int:
    """Crush active cells one after another, uniform fragments of their size; the number of crushes."""
    active = dict[int, float]()

    def look(cell: int) -> None:
        load = critical(sizes, cell, fabric_width, weibull_modulus)
        if load <= log_load + 1e-12:
            active[cell] = load
        else:
            active.pop(cell, None)

    def around(cell: int) -> None:
        for other in (cell - 1, cell, cell + 1):
            look(other % sizes.size)

    for cell in touched:
        around(cell)
    crushes = 0
    while active:
        cells = list(active)
        cell = min(cells, key=active.__getitem__) if weakest else cells[int(random.integers(len(cells)))]
        sizes[cell] *= random.random()
        crushes += 1
        around(cell)
    return crushes

"""Speed of the event-driven lattice against a plain Python loop with a heap, in one run that first checks the answers.

    python bench/lattice.py [CELLS...]

For each start: a ring is loaded to 10^4 by both at a small size, where sizes and crush counts must be equal to the
last bit; then the library alone at the given sizes. Times include drawing the start.
"""

import heapq
import math
import sys
import time
from pathlib import Path

import numpy as np

import comminute as cm

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))
from reference_lattice import FRAGMENT, TIE, PlainRing, bits, tie_key, uniform

LOAD = 1e4
CHECKED = 20_000
STARTS = {
    "monodisperse": cm.monodisperse(1.0),
    "s in [0.9, 1]": cm.uniform_size(0.9, 1.0),
    "gap-graded": cm.gap_graded(1.0, 0.1),
    "power law 2.5": cm.power_law(2.5, 1e-3, 1.0),
}


def heap_load(ring: PlainRing, stress_ratio: float) -> int:
    """Load a plain ring with one global heap; outdated entries are dropped when they come up."""
    count = len(ring.psi)
    origin = bits(ring.stream, TIE, 0, ring.remixes)
    load = math.log(stress_ratio) + 1e-13
    critical = [ring.log_critical(cell) for cell in range(count)]
    heap = [(critical[cell], tie_key(origin, cell), cell) for cell in range(count) if critical[cell] <= load]
    heapq.heapify(heap)
    crushes = 0
    while heap:
        value, _, cell = heapq.heappop(heap)
        if value != critical[cell]:
            continue
        ring.psi[cell] += ring.draw(uniform(ring.stream, FRAGMENT, cell, ring.remixes << 32 | ring.crushes[cell]))
        ring.crushes[cell] += 1
        crushes += 1
        for near in (cell - 1 if cell else count - 1, cell, cell + 1 if cell + 1 < count else 0):
            critical[near] = ring.log_critical(near)
            if critical[near] <= load:
                heapq.heappush(heap, (critical[near], tie_key(origin, near), near))
    return crushes


def checked_rates(grading: cm.Grading) -> tuple[float, float]:
    """Crushes per second of the plain loop and of the library, which must agree."""
    material = cm.Material()
    sizes = np.exp(cm.Lattice(CHECKED, material, grading, seed=1).psi[0])
    plain = PlainRing(sizes, material, seed=2)
    lattice = cm.Lattice.from_sizes(sizes, material, seed=2)
    begin = time.perf_counter()
    crushes = heap_load(plain, LOAD)
    middle = time.perf_counter()
    if lattice.load_to(LOAD) != crushes or not np.array_equal(lattice.psi[0], plain.psi):
        raise SystemExit(f"{grading}: the plain loop and the library differ")
    end = time.perf_counter()
    return crushes / (middle - begin), crushes / (end - middle)


def main(sizes: list[int]) -> None:
    """Print the table."""
    print("start             cells   crushes a cell   seconds   crushes/s   plain Python: crushes/s   ratio")
    for name, grading in STARTS.items():
        plain, _ = checked_rates(grading)
        for cells in sizes:
            begin = time.perf_counter()
            crushes = cm.Lattice(cells, cm.Material(), grading).load_to(LOAD)
            seconds = time.perf_counter() - begin
            rate = crushes / seconds
            print(
                f"{name:13s} {cells:9d} {crushes / cells:16.3f} {seconds:9.3f} {rate:11.3g} "
                f"{plain:25.3g} {rate / plain:7.1f}"
            )


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]] or [10**5, 10**6, 10**7])

"""The event-driven lattice: equal sizes loaded to 10^4, set-up excluded, and replicas on two threads.

The heaps are checked bit for bit: with the library's own random numbers they must end in the same sizes. They are
timed with those of their language, which cost them less. Passes at a finite load factor are another model, and are held
to a distance of the grading curve.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import numpy as np

import comminute as cm
from contestants.model import Floats
from contestants.numba_lattice import NumbaLattice, seed
from contestants.plain_lattice import PlainLattice, SweptLattice, weibull
from harness import OURS, PER_SECOND, Check, Contestant, Goal, Trial, largest_difference

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "reference"))
from reference_lattice import FRAGMENT, TIE, bits, tie_key, uniform

LOAD = 1e4
CHECKED = 2000
SEED = 2
PASSES = "Python passes"
LOAD_FACTOR = 1.5  # of the passes: the coarsest that keeps their grading curve
PASSES_ANSWER = 0.02  # of it, and what chance leaves
STARTS = {
    "equal sizes": cm.monodisperse(1.0),
    "s in [0.9, 1]": cm.uniform_size(0.9, 1.0),
    "gap-graded": cm.gap_graded(1.0, 0.1),
    "power law 2.5": cm.power_law(2.5, 1e-3, 1.0),
}


def _same_bits(grading: cm.Grading) -> list[Check]:
    """Both peers against the library on a small ring, with the library's random numbers."""
    sizes = np.exp(cm.Lattice(CHECKED, cm.Material(), grading, seed=1).psi[0])
    ours = cm.Lattice.from_sizes(sizes, cm.Material(), seed=SEED)
    crushes = ours.load_to(LOAD)
    stream = bits(SEED, 0, 0, 0)
    origin = bits(stream, TIE, 0, 0)
    plain = PlainLattice(
        sizes.tolist(),
        weibull(lambda cell, count: uniform(stream, FRAGMENT, cell, count)),
        lambda cell: tie_key(origin, cell),
    )
    ties = np.array([tie_key(origin, cell) for cell in range(CHECKED)], dtype=np.uint64)
    most = int(ours.crushes.max()) + 1
    draws: Floats = np.array(
        [[uniform(stream, FRAGMENT, cell, count) for count in range(most)] for cell in range(CHECKED)]
    )
    numba = NumbaLattice(sizes, ties, draws)
    return [
        Check("Python heap, crushes", abs(plain.load_to(LOAD) - crushes), 0.0),
        Check("Python heap, sizes", largest_difference(plain.psi, ours.psi[0]), 0.0),
        Check("Numba heap, crushes", abs(numba.load_to(LOAD) - crushes), 0.0),
        Check("Numba heap, sizes", largest_difference(numba.psi, ours.psi[0]), 0.0),
    ]


class _Ring(Protocol):
    """A ring that can be made and loaded again and again."""

    crushes: int

    def before(self) -> None: ...
    def run(self) -> None: ...


class _Ours:
    """A fresh lattice for every run."""

    def __init__(self, cells: int, grading: cm.Grading, replicas: int = 1, threads: int = 1) -> None:
        self._cells, self._grading, self._replicas, self._threads = cells, grading, replicas, threads
        self.crushes = 0

    def before(self) -> None:
        """Make it."""
        self.lattice = cm.Lattice(
            self._cells, cm.Material(), self._grading, replicas=self._replicas, threads=self._threads, seed=SEED
        )

    def run(self) -> None:
        """Load it."""
        self.crushes = self.lattice.load_to(LOAD)


class _Plain:
    """The same start for the Python heap, with Python's random numbers."""

    def __init__(self, cells: int, grading: cm.Grading) -> None:
        self._sizes = np.exp(cm.Lattice(cells, cm.Material(), grading, seed=1).psi[0]).tolist()
        self.crushes = 0

    def before(self) -> None:
        """Make it."""
        generator = random.Random(SEED)
        keys = [generator.random() for _ in self._sizes]
        draw = generator.random
        self.lattice = PlainLattice(self._sizes, weibull(lambda cell, count: 1.0 - draw()), keys.__getitem__)

    def run(self) -> None:
        """Load it."""
        self.crushes = self.lattice.load_to(LOAD)


class _Passes:
    """The same start for passes in Python."""

    def __init__(self, cells: int, grading: cm.Grading) -> None:
        self._sizes = np.exp(cm.Lattice(cells, cm.Material(), grading, seed=1).psi[0]).tolist()
        self.crushes = 0

    def before(self) -> None:
        """Make it."""
        self.lattice = SweptLattice(self._sizes, random.Random(SEED), LOAD_FACTOR)

    def run(self) -> None:
        """Load it."""
        self.crushes = self.lattice.load_to(LOAD)


class _Numba:
    """The same start for Numba, with Numba's random numbers."""

    def __init__(self, cells: int, grading: cm.Grading) -> None:
        self._sizes = np.exp(cm.Lattice(cells, cm.Material(), grading, seed=1).psi[0])
        self._ties = np.random.default_rng(SEED).integers(2**63, size=cells, dtype=np.uint64)
        self.crushes = 0

    def before(self) -> None:
        """Make it."""
        seed(SEED)
        self.lattice = NumbaLattice(self._sizes, self._ties, np.empty((len(self._sizes), 0)))

    def run(self) -> None:
        """Load it."""
        self.crushes = self.lattice.load_to(LOAD)


def _curve(psi: Floats) -> Floats:
    """Grading curve at sizes that lie off the starts' exact ones."""
    return np.searchsorted(np.sort(psi), np.linspace(-9.0, -0.001, 500), "right") / len(psi)


def trial(name: str, cells: int, python_cells: int) -> Trial:
    """One start. The Python loops get a smaller ring, on which they are faster; times a crush are compared."""
    grading = STARTS[name]
    ours, numba = _Ours(cells, grading), _Numba(cells, grading)
    plain, passes = _Plain(python_cells, grading), _Passes(python_cells, grading)
    runs: dict[str, _Ring] = {OURS: ours, "Numba heap": numba, "Python heap": plain, PASSES: passes}
    for run in runs.values():
        run.before()
        run.run()
    curve = _curve(ours.lattice.psi[0])
    checks = _same_bits(grading)
    # With random numbers of their own they agree to what chance leaves.
    for peer, psi, error in (
        ("Numba heap", numba.lattice.psi, 0.0),
        ("Python heap", np.array(plain.lattice.psi), 0.0),
        (PASSES, np.array(passes.lattice.psi), PASSES_ANSWER),
    ):
        limit = error + 2.0 / math.sqrt(len(psi))
        checks.append(Check(f"{peer}, grading curve", largest_difference(_curve(psi), curve), limit))
    goals = [
        Goal("≥ 4·10⁶ crushes a second", OURS, PER_SECOND, least=4e6),
        Goal("≥ 10³ × a plain Python loop", PASSES, OURS, least=1e3),
        Goal("≥ 2 × the Numba heap", "Numba heap", OURS, least=2.0),
    ]
    return Trial(
        case="lattice",
        title=f"Lattice, {name}, M = {cells}, to 10⁴, set-up excluded",
        contestants=[Contestant(peer, run.run, run.before, work=run.crushes) for peer, run in runs.items()],
        checks=checks,
        goals=goals if name == "equal sizes" else [],
        unit="crush",
        note=f"{ours.crushes / cells:.3f} crushes a cell; in Python M = {python_cells}; "
        f"passes raise the load by {LOAD_FACTOR} at a time",
    )


def replicas(cells: int) -> Trial:
    """Four rings on one thread and on two."""
    one, two = (_Ours(cells, STARTS["equal sizes"], replicas=4, threads=threads) for threads in (1, 2))
    for run in (one, two):
        run.before()
        run.run()
    return Trial(
        case="lattice replicas",
        title=f"Lattice, 4 replicas of M = {cells}, to 10⁴",
        contestants=[
            Contestant(OURS, one.run, one.before, work=one.crushes),
            Contestant(f"{OURS}, 2 threads", two.run, two.before, work=two.crushes),
        ],
        checks=[Check("2 threads, sizes", largest_difference(one.lattice.psi, two.lattice.psi), 0.0)],
        goals=[Goal("≥ 1.8 × with 2 threads", OURS, f"{OURS}, 2 threads", least=1.8)],
        unit="crush",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Yield four starts, and replicas."""
    for name in STARTS:
        yield trial(name, 4000, 2000) if short else trial(name, 10**6, 20_000)
    yield replicas(2000 if short else 10**6)

"""A second, plain lattice: one Python loop over all cells for every crush, drawn from the same counters.

Written from the rules alone: find the weakest cell of the whole ring, crush it if the load bears on it, begin again.
Only the random numbers follow the library's recipe (Philox 2x64-10 by cell and crush count, SplitMix64 for ties), so
that the two may be compared bit by bit.
"""

import math
from collections.abc import Callable

import comminute as cm
from reference import Array

MASK = 2**64 - 1
STREAM, START, FRAGMENT, TIE, SHUFFLE, DECISION, FIRST_STRENGTH, STRENGTH = range(8)


def philox(key: int, low: int, high: int) -> tuple[int, int]:
    for _ in range(10):
        product = low * 0xD2B74407B1CE6E93
        low, high = (product >> 64) ^ key ^ high, product & MASK
        key = (key + 0x9E3779B97F4A7C15) & MASK
    return low, high


def bits(stream: int, purpose: int, where: int, when: int) -> int:
    return philox(stream, where | purpose << 56, when)[0]


def uniform(stream: int, purpose: int, where: int, when: int) -> float:
    return ((bits(stream, purpose, where, when) >> 12) + 0.5) * 2.0**-52


def tie_key(origin: int, where: int) -> int:
    z = (origin + (where + 1) * 0x9E3779B97F4A7C15) & MASK
    z = ((z ^ z >> 30) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ z >> 27) * 0x94D049BB133111EB) & MASK
    return z ^ z >> 31


def sampler(law: object) -> Callable[[float], float]:
    """R = ln X by inversion."""
    if isinstance(law, cm.WeibullFragments):
        rate = math.pow(law.scale, -law.shape)
        return lambda p: min(math.log(-math.log1p(p * math.expm1(-rate)) / rate) / law.shape, 0.0)
    assert isinstance(law, cm.PowerLawFragments)
    return lambda p: math.log(p) / law.exponent


class PlainRing:
    """One ring of given sizes, the replica of that number under a seed."""

    def __init__(self, sizes: Array, material: cm.Material, seed: int, replica: int = 0, mean: str = "arithmetic"):
        self.material = material
        self.geometric = mean == "geometric"
        self.psi = [math.log(size / material.reference_size) for size in sizes]
        self.crushes = [0] * len(self.psi)
        self.stream = bits(seed, STREAM, replica, 0)
        self.remixes = 0
        self.avalanches: list[tuple[float, int]] = []
        self.draw = sampler(material.fragments)
        self.log_strength = [self.strength(FIRST_STRENGTH, cell, 0) for cell in range(len(self.psi))]

    def strength(self, purpose: int, cell: int, when: int) -> float:
        """Log of a cell's own factor of its critical load, by inversion of the Weibull law; 0 where none scatters."""
        if not self.material.strength_scatter:
            return 0.0
        return math.log(-math.log1p(-uniform(self.stream, purpose, cell, when))) / self.material.weibull_modulus

    def log_critical(self, cell: int) -> float:
        """Log of Eq. 2, with the cell's own factor."""
        left, right = self.psi[cell - 1], self.psi[(cell + 1) % len(self.psi)]
        mean = 0.5 * (left + right) if self.geometric else math.log(0.5 * (math.exp(left) + math.exp(right)))
        contrast = (self.psi[cell] - mean) / self.material.fabric_width
        strength = self.log_strength[cell] - 3.0 / self.material.weibull_modulus * self.psi[cell]
        return strength + 0.5 * contrast * contrast

    def load_to(self, stress_ratio: float) -> None:
        """Crush the weakest cell of all, again and again, while the load bears on it."""
        origin = bits(self.stream, TIE, 0, self.remixes)
        load = math.log(stress_ratio) + 1e-13
        risen_to = -math.inf
        while True:
            weakest, _, cell = min((self.log_critical(c), tie_key(origin, c), c) for c in range(len(self.psi)))
            if weakest > load:
                return
            if weakest > risen_to:
                risen_to = weakest
                self.avalanches.append((risen_to, 0))
            self.avalanches[-1] = (risen_to, self.avalanches[-1][1] + 1)
            when = self.remixes << 32 | self.crushes[cell]
            self.psi[cell] += self.draw(uniform(self.stream, FRAGMENT, cell, when))
            self.log_strength[cell] = self.strength(STRENGTH, cell, when)
            self.crushes[cell] += 1

    def remix(self) -> None:
        """Fisher-Yates from the far end."""
        self.remixes += 1
        for left in range(len(self.psi), 1, -1):
            other = bits(self.stream, SHUFFLE, left, self.remixes) * left >> 64
            self.psi[left - 1], self.psi[other] = self.psi[other], self.psi[left - 1]
            self.crushes[left - 1], self.crushes[other] = self.crushes[other], self.crushes[left - 1]
            strengths = self.log_strength
            strengths[left - 1], strengths[other] = strengths[other], strengths[left - 1]

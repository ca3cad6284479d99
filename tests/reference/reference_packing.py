"""Packing models written out from their formulas, class by class: references for the tests."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def virtual_packings(size: Floats, share: Floats, packing: Floats) -> Floats:
    """Gamma of each class by the double loop over all others (de Larrard 1999)."""
    found = np.empty(size.size)
    for i in range(size.size):
        lost = 0.0
        for j in range(size.size):
            beta, other = packing[i], packing[j]
            if size[j] > size[i]:
                x = size[i] / size[j]
                b = 1.0 - (1.0 - x) ** 1.50
                lost += (1.0 - beta + b * beta * (1.0 - 1.0 / other)) * share[j]
            elif size[j] < size[i]:
                x = size[j] / size[i]
                a = math.sqrt(1.0 - (1.0 - x) ** 1.02)
                lost += (1.0 - a * beta / other) * share[j]
        found[i] = packing[i] / (1.0 - lost)
    return found


def compaction_index(size: Floats, share: Floats, packing: Floats, solid: float) -> float:
    """K of a solid fraction."""
    gamma = virtual_packings(size, share, packing)
    held = share > 0.0
    return float(np.sum(share[held] / packing[held] / (1.0 / solid - 1.0 / gamma[held])))


def furnas_volume(coarse: float, coarse_volume: float, fine_volume: float) -> float:
    """Specific volume of two sizes that are infinitely far apart."""
    return max(coarse_volume * coarse, coarse + fine_volume * (1.0 - coarse))


def westman_volume(coarse: float, coarse_volume: float, fine_volume: float, ratio: float) -> float:
    """Specific volume of two sizes by Westman's equation, with G of Yu, Standish & McLean (1993); root by bisection."""
    fine = 1.0 - coarse
    g = 1.0 if ratio > 0.824 else 1.0 / (1.355 * ratio**1.566)

    def excess(volume: float) -> float:
        u = (volume - coarse_volume * coarse) / fine_volume
        v = (volume - coarse - fine_volume * fine) / (coarse_volume - 1.0)
        return u * u + 2.0 * g * u * v + v * v - 1.0

    low = max(coarse_volume * coarse, coarse + fine_volume * fine)
    high = coarse * coarse_volume + fine * fine_volume + 1e-12
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)

"""Random close packing of frictionless spheres, by rods on a line: a witness for the other models.

R. S. Farr, R. D. Groot, J. Chem. Phys. 131 (2009) 244104; R. S. Farr, arXiv 1306.1442 (2013).
"""

from __future__ import annotations

import heapq

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
GAP = 0.7654  # f: two neighbours stay apart by this share of the shorter one
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def rod_lengths(size: Floats, share: Floats, count: int) -> Floats:
    """(count,) chords of spheres cut by a line, longest first: sizes weighed by their section, chords evenly spread.

    A sphere of diameter D meets a line with a probability that goes as D**2, and so of a mass as 1 / D; its chord L is
    D sqrt(u), u even in (0, 1).
    """
    order = np.argsort(size)
    weight = np.cumsum(share[order] / size[order])
    place = (np.arange(count) + 0.5) / count
    diameter = size[order][np.searchsorted(weight, place * weight[-1])]
    chord = np.modf(0.5 + GOLDEN * np.arange(count))[0]
    return np.sort(diameter * np.sqrt(chord))[::-1]


def rods_fraction(size: Floats, share: Floats, count: int) -> float:
    """Solid fraction of spheres: rods go, longest first, each into the largest gap; the line grows where it must."""
    lengths = rod_lengths(size, share, count).tolist()
    gaps = [-GAP * lengths[0]]  # negative, since the heap has its smallest first
    for length in lengths[1:]:
        left = -gaps[0] - (1.0 + GAP) * length
        gap = GAP * length
        heapq.heapreplace(gaps, -gap)
        heapq.heappush(gaps, -max(left, gap))
    solid = sum(lengths)
    return float(solid / (solid - sum(gaps)))

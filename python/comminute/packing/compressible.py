"""The compressible packing model, and the linear one that it tends to.

F. de Larrard, Concrete Mixture Proportioning (1999); T. Stovall, F. de Larrard, M. Buil, Powder Technol. 48 (1986) 1.
The constants 1.02 and 1.50 and the compactions were taken from later accounts of these works, and not checked against
the originals.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from comminute.packing.classes import SizeClasses

Floats = npt.NDArray[np.float64]
COMPACTIONS = {"poured": 4.1, "rodded": 4.5, "vibrated": 4.75, "vibrated under 10 kPa": 9.0}
NEWTON_STEPS = 100
ENOUGH = 4e-16  # relative step of the specific volume at which the search ends


def loosening(ratio: Floats) -> Floats:
    """Loosening of coarse grains by finer ones at a size ratio in [0, 1]: 0 for much finer ones, 1 for equal ones."""
    return np.sqrt(1.0 - (1.0 - ratio) ** 1.02)


def wall(ratio: Floats) -> Floats:
    """Wall effect of coarse grains on finer ones, of a size ratio in [0, 1]: 0 at a wall, 1 for equal grains."""
    return np.asarray(1.0 - (1.0 - ratio) ** 1.50)


def virtual_packings(classes: SizeClasses, packing: Floats) -> Floats:
    """(N,) virtual packing of all classes were each the one that decides.

    Equal packings of single sizes, on evenly spaced classes, make it two convolutions.
    """
    sizes, shares = classes.all_sizes, classes.all_shares
    even = classes.size.size
    if even and np.all(packing == packing[0]):
        beta = float(packing[0])
        lost = np.empty(sizes.size)
        ratio = np.exp(-classes.spacing * np.arange(even))
        walls, loose = (1.0 - beta) * (1.0 - wall(ratio)), 1.0 - loosening(ratio)
        # the loss of class i by coarser classes i + k, and by finer ones i - k
        lost[:even] = np.convolve(classes.share[::-1], walls)[:even][::-1] + np.convolve(classes.share, loose)[:even]
        others = slice(even, None)
        lost[:even] += _losses(classes.size, sizes[others], shares[others], beta)
        lost[others] = _losses(sizes[others], sizes, shares, beta)
        return beta / (1.0 - lost)
    coarser = sizes[None, :] > sizes[:, None]
    ratio = np.minimum(sizes[None, :], sizes[:, None]) / np.maximum(sizes[None, :], sizes[:, None])
    own, other = packing[:, None], packing[None, :]
    by_coarser = 1.0 - own + wall(ratio) * own * (1.0 - 1.0 / other)
    by_finer = 1.0 - loosening(ratio) * own / other
    lost = np.where(coarser, by_coarser, np.where(sizes[None, :] < sizes[:, None], by_finer, 0.0)) @ shares
    return np.asarray(packing / (1.0 - lost))


def _losses(sizes: Floats, others: Floats, shares: Floats, beta: float) -> Floats:
    """(N,) loss of classes by others, all of one packing."""
    ratio = np.minimum(sizes[:, None], others[None, :]) / np.maximum(sizes[:, None], others[None, :])
    walls, loose = (1.0 - beta) * (1.0 - wall(ratio)), 1.0 - loosening(ratio)
    return np.asarray(np.where(others[None, :] > sizes[:, None], walls, loose) @ shares)


def linear_fraction(classes: SizeClasses, packing: Floats) -> float:
    """Solid fraction by the linear packing model: that of the class which decides, among those that hold grains."""
    return float(virtual_packings(classes, packing)[classes.all_shares > 0.0].min())


def compressible_fraction(classes: SizeClasses, packing: Floats, compaction: float) -> float:
    """Solid fraction at a compaction K = sum_i (y_i / beta_i) / (1 / Phi - 1 / gamma_i)."""
    held = classes.all_shares > 0.0
    weight = classes.all_shares[held] / packing[held]
    least = 1.0 / virtual_packings(classes, packing)[held]  # specific volume at which a class jams
    # K falls with the specific volume v: from infinity at the largest of these, and below the target at `above`
    below = float(least.max())
    above = below + float(weight.sum()) / compaction
    v = above
    for _ in range(NEWTON_STEPS):
        terms = weight / (v - least)
        excess = float(terms.sum()) - compaction
        below, above = (v, above) if excess > 0.0 else (below, v)
        # Newton's step on 1 / K, which is nearly linear in v
        total = float(terms.sum())
        slope = float((terms / (v - least)).sum()) / total**2
        step = (1.0 / compaction - 1.0 / total) / slope
        after = v + step
        if not below < after < above:
            after = 0.5 * (below + above)
        if abs(after - v) <= ENOUGH * v:
            break
        v = after
    return 1.0 / v

"""Active share of a cell without error but rounding, in NumPy; `reference.active_share` does it by brute force."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

import reference as ref
from reference import Array, Model


def _kinks(steepness: float, tip: float, distance: float) -> list[float]:
    """Places t of the larger grain where the length covered reaches 0 or 1 of the smaller grain's bin."""
    # Covered is 1/2 - d - t + omega(t), omega^2 = steepness (t - tip): a quadratic in t, squared once.
    places = []
    for covered in (0.0, 1.0):
        c = distance - 0.5 + covered
        half = 0.5 * steepness - c  # t^2 - 2 half t + c^2 + steepness tip = 0
        discriminant = steepness * (0.25 * steepness - c - tip)
        if discriminant >= 0.0:
            places += [half - math.sqrt(discriminant), half + math.sqrt(discriminant)]
    return places


def _share(steepness: float, tip: float, distance: int) -> float:
    """Share of a cell at this distance from the diagonal; lengths in bins, t from the larger grain's centre."""
    begin = max(-0.5, tip)
    if begin >= 0.5:
        return 0.0
    if math.isinf(steepness):  # no fabric: all to the right of the tip
        return 1.0 - (begin + 0.5) ** 2 if distance == 0 else 0.5 - begin
    # d = 0 covers 2 min(omega, t + 1/2), whose kink is where omega = t + 1/2.
    kinks = _kinks(steepness, tip, distance if distance > 0 else 1.0)
    cuts = np.unique(np.clip([begin, *kinks, 0.5], begin, 0.5))
    node, weight = np.polynomial.legendre.leggauss(8)
    total = 0.0
    for left, right in pairwise(cuts):
        # In s = sqrt(t - tip) the piece is a cubic, ds = (right - left) / (s_left + s_right).
        s_left, s_right = math.sqrt(max(left - tip, 0.0)), math.sqrt(max(right - tip, 0.0))
        length = (right - left) / (s_left + s_right)
        step = 0.5 * (1.0 + node) * length
        s, t = s_left + step, left + step * (2.0 * s_left + step)
        omega = math.sqrt(steepness) * s
        covered = np.clip(0.5 - distance - t + omega, 0.0, 1.0)
        if distance == 0:
            covered = 2.0 * np.minimum(omega, t + 0.5)
        total += float((0.5 * length * weight) @ (2.0 * s * covered))
    return total


def active_share(psi: Array, model: Model, stress_ratio: float) -> Array:
    """Share of each cell's area in which the larger of the two grains crushes."""
    share = np.zeros((len(psi), len(psi)))
    log_stress, spacing = ref._log_stress(stress_ratio), ref._spacing(psi)
    if log_stress == -math.inf:
        return share
    curvature = 6.0 * model.fabric_width**2 / model.weibull_modulus  # k of Eq. (15)
    least = math.log(model.reference_size) - model.weibull_modulus / 3.0 * log_stress  # here W = 0
    for m in range(1, len(psi)):
        tip = float(least - psi[m]) / spacing
        for d in range(m + 1):
            share[m, m - d] = share[m - d, m] = _share(curvature / spacing, tip, d)
    share[share > 1.0 - 1e-13] = 1.0  # zones are nested: a cell once full stays full, whatever the rounding
    return share

"""Means over the replicas of a lattice, with their statistical errors."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def mean_and_error(samples: Floats) -> tuple[Floats, Floats]:
    """Mean over the first axis, and its standard error (NaN for a single sample)."""
    count = samples.shape[0]
    mean = np.mean(samples, axis=0)
    if count == 1:
        return mean, np.full_like(mean, math.nan)
    return mean, np.asarray(np.std(samples, axis=0, ddof=1) / math.sqrt(count), dtype=np.float64)

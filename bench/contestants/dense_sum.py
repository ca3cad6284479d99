"""The sum of Eq. 61 as it stands: a kernel of N^4 numbers, assembled for the load and applied to the state."""

from __future__ import annotations

import numpy as np

from contestants.model import Floats, Kind, Problem


class DenseSum:
    """One time step in O(N^4), for a small N."""

    def __init__(self, problem: Problem) -> None:
        bins = problem.bins
        # lines[k] is where unit mass of bin k goes; the fines bin takes what would fall below.
        self._lines = np.zeros((bins, bins))
        for k in range(bins):
            self._lines[k, : k + 1] = problem.fragments[: k + 1][::-1]
            self._lines[k, 0] = problem.below[k]
        self._problem = problem

    def kernel(self, stress_ratio: float, kind: Kind) -> Floats:
        """(N, N, N, N) where unit mass of cell [k, l] goes."""
        bins = self._problem.bins
        ones = np.ones((bins, bins))
        rest, grain, neighbour, both = self._problem.parts(ones, stress_ratio, kind)
        kernel = np.zeros((bins, bins, bins, bins))
        cell = np.arange(bins)
        kernel[cell[:, None], cell, cell[:, None], cell] = rest
        # Row k of a crushing psi keeps its column l, and the other way round: two diagonals, and one full block.
        kernel[:, cell, :, cell] += np.einsum("kl,ki->lki", grain, self._lines)
        kernel[cell, :, cell, :] += np.einsum("kl,lj->klj", neighbour, self._lines)
        if both is not None:
            for k, l_ in np.argwhere(both > 0.0):
                kernel[k, l_] += both[k, l_] * np.outer(self._lines[k], self._lines[l_])
        return kernel

    def step(self, p: Floats, stress_ratio: float, kind: Kind) -> Floats:
        """State after one time step."""
        bins = self._problem.bins
        matrix = self.kernel(stress_ratio, kind).reshape(bins * bins, bins * bins)
        return (p.reshape(-1) @ matrix).reshape(bins, bins)

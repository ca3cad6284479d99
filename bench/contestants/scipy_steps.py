"""Time stepping by separable convolutions in SciPy: what a careful user writes after reading Eqs. 59-63.

`scipy.signal.fftconvolve` transforms the filter anew at every call and each axis of the whole state at once; here the
filter's spectrum is kept and the transforms go block by block, which is the same convolution in less time.
"""

from __future__ import annotations

import numpy as np
from scipy import fft

from contestants.model import Floats, Kind, Problem

BLOCK = 64  # lines transformed at once, so that their spectra stay in the cache


class SciPySteps:
    """One time step of Eq. 61 after the other."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._length = fft.next_fast_len(2 * problem.bins - 1, real=True)
        self._spectrum = np.conj(fft.rfft(problem.fragments, self._length))

    def _spread(self, mass: Floats) -> Floats:
        """Each row spread downwards, what falls off in bin 0."""
        bins = self._problem.bins
        out = np.empty((len(mass), bins))
        for begin in range(0, len(mass), BLOCK):
            lines = slice(begin, begin + BLOCK)
            spectra = fft.rfft(mass[lines], self._length)
            spectra *= self._spectrum
            out[lines] = fft.irfft(spectra, self._length, overwrite_x=True)[:, :bins]
        out[:, 0] = mass.sum(axis=1) - out[:, 1:].sum(axis=1)
        return out

    def step(self, p: Floats, stress_ratio: float, kind: Kind) -> Floats:
        """State after one time step: rest + f *_psi (a + f *_psibar c) + f *_psibar b."""
        return self.step_and_active(p, stress_ratio, kind)[0]

    def step_and_active(self, p: Floats, stress_ratio: float, kind: Kind) -> tuple[Floats, float]:
        """State after one time step, and the mass that was active before it."""
        rest, grain, neighbour, both = self._problem.parts(p, stress_ratio, kind)
        active = 1.0 - float(rest.sum())
        if both is not None:
            grain += self._spread(both)
        rest += self._spread(neighbour)
        # Columns as rows: a transposed copy costs less than transforms across the rows.
        rest += self._spread(np.ascontiguousarray(grain.T)).T
        return rest, active

"""One full convolution step of the exact kernel on a dense state, against its bare transforms, SciPy and the sum."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import comminute as cm
from cases.common import LOAD, grid_of, problem_on, start_on
from contestants.bare_fftw import BareTransforms
from contestants.copies import Copy
from contestants.dense_sum import DenseSum
from contestants.model import Floats
from contestants.scipy_steps import SciPySteps
from harness import OURS, Check, Contestant, Goal, Trial, largest_difference

ANSWER = 1e-14
SUMS_ANSWER = 1e-13
MEASURED = f"{OURS}, measured plans"
SUMS = f"{OURS}, running sums"
# A row hands on what crushes in psibar and what crushes in both, a column what crushes in psi.
LINES_PER_BIN = 3
NAMED = (500, 1000, 2000)  # sizes with a goal


def _bare(bins: int, *, measure: bool) -> tuple[BareTransforms, Check]:
    bare = BareTransforms(bins, LINES_PER_BIN * bins, measure=measure)
    lines: Floats = np.random.default_rng(1).random((BareTransforms.BATCH, bins))
    return bare, Check("bare transforms, there and back", largest_difference(bare.round_trip(lines), lines), ANSWER)


def trial(bins: int, *, with_sum: bool = False) -> Trial:
    """One size."""
    grid, material = grid_of(bins), cm.Material()
    p, out = start_on(grid).probability.copy(), np.empty((bins, bins))
    estimated = cm.FullConvolution(grid, material, "exact", scheme="paper", path="transforms")
    measured = cm.FullConvolution(grid, material, "exact", scheme="paper", path="transforms", effort="measure")
    sums = cm.FullConvolution(grid, material, "exact", scheme="paper", path="sums")
    scipy_steps = SciPySteps(problem_on(grid))
    bare, bare_check = _bare(bins, measure=False)
    bare_measured, bare_measured_check = _bare(bins, measure=True)
    copy = Copy(p)
    after = estimated.step(p, LOAD)
    checks = [
        bare_check,
        bare_measured_check,
        Check("measured plans", largest_difference(measured.step(p, LOAD), after), ANSWER),
        Check("running sums", largest_difference(sums.step(p, LOAD), after), SUMS_ANSWER),
        Check("SciPy", largest_difference(scipy_steps.step(p, LOAD, "exact"), after), ANSWER),
        Check("mass", abs(float(after.sum()) - 1.0), ANSWER),
    ]
    contestants = [
        Contestant(OURS, lambda: estimated.step(p, LOAD, out=out)),
        Contestant(MEASURED, lambda: measured.step(p, LOAD, out=out)),
        Contestant(SUMS, lambda: sums.step(p, LOAD, out=out)),
        Contestant("bare FFTW", bare.run),
        Contestant("bare FFTW, measured plans", bare_measured.run),
        Contestant("SciPy", lambda: scipy_steps.step(p, LOAD, "exact")),
        Contestant("copy", copy.run),
    ]
    if with_sum:
        dense = DenseSum(problem_on(grid))
        checks.append(Check("O(N^4) sum", largest_difference(dense.step(p, LOAD, "exact"), after), ANSWER))
        contestants.append(Contestant("O(N^4) sum", lambda: dense.step(p, LOAD, "exact")))
    goals = [
        Goal("≤ 1.4 × the bare transforms", OURS, "bare FFTW", most=1.4),
        Goal("≤ 1.4 × the bare transforms, both with measured plans", MEASURED, "bare FFTW, measured plans", most=1.4),
        Goal("≥ 1.5 × faster than SciPy", "SciPy", OURS, least=1.5),
        Goal("running sums ≥ 2 × faster than our FFTW step", OURS, SUMS, least=2.0),
    ]
    return Trial(
        case="full convolution step",
        title=f"Full convolution step, exact kernel, dense state, N = {bins}",
        contestants=contestants,
        checks=checks,
        goals=goals if bins in NAMED else [],
        size=bins,
        note=f"bare FFTW: {LINES_PER_BIN} N real lines of length {bare.length}, there and back, in the cache; "
        "comminute needs fewer and shorter ones: two lines to a complex transform, each as short as stays linear. "
        "Running sums are what it takes by itself for these fragments",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Small sizes with the paper's sum, then those of the goals."""
    for bins in (16,) if short else (16, 24, 32, 48):
        yield trial(bins, with_sum=True)
    for bins in (125,) if short else (125, 250, 500, 1000, 1024, 2000):
        yield trial(bins)

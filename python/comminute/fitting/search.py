"""The search for the best parameters, and for intervals by the profile of the likelihood. Needs scipy."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from comminute.fitting.parameters import Parameter

Floats = npt.NDArray[np.float64]
ROUNDS = 3  # most grids that a search goes through, each sized for the best parameters on the one before
MOVED = 0.02  # change of a parameter, on the scale of the search, that asks for a new grid


class Problem(Protocol):
    """Least squares in some parameters, on the scale of the search."""

    best: tuple[float, Floats] | None  # cost and place of the least residuals so far

    @property
    def parameters(self) -> Sequence[Parameter]:
        """(P) numbers that are sought."""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Ends of the parameters."""

    def first(self) -> Floats:
        """(P,) place from which the search starts."""

    def prepare(self, vector: Floats) -> None:
        """Choose what must not change while a search goes on."""

    def residuals(self, vector: Floats) -> Floats:
        """(M,) differences over their errors."""

    def jacobian(self, vector: Floats) -> Floats:
        """(M, P) their derivatives."""


@dataclass
class Found:
    """End of a search.

    Attributes
    ----------
    vector : ndarray (P,)
    cost : float
        Sum of the squares of the residuals.
    costs : list of float
        The same at the end of the search from each start.
    ends : list of ndarray (P,)
        Parameters there.
    interrupted : bool
        Ctrl-C came before the search was done.
    """

    vector: Floats
    cost: float
    costs: list[float]
    ends: list[Floats]
    interrupted: bool = False


def search(problem: Problem, starts: int, seed: int) -> Found:
    """Search from the material's own values and from others, spread evenly over the usual range of each parameter.

    Parameters
    ----------
    problem : Problem
    starts : int
        Starts in all, at least 1.
    seed : int
        Seed of the random spread.

    Returns
    -------
    Found
        The best; on Ctrl-C the best so far.
    """
    from scipy.stats import qmc  # noqa: PLC0415  (scipy is optional)

    vectors = [problem.first()]
    if starts > 1:
        spread = qmc.LatinHypercube(len(problem.parameters), seed=seed).random(starts - 1)
        for row in spread:
            usual = [(one.inner(one.usual_low), one.inner(one.usual_high)) for one in problem.parameters]
            vectors.append(
                np.array([low + share * (high - low) for share, (low, high) in zip(row, usual, strict=True)])
            )
    best: tuple[float, Floats] | None = None
    costs: list[float] = []
    ends: list[Floats] = []
    try:
        for vector in vectors:
            problem.best = None
            cost, at = _descend(problem, vector)
            costs.append(cost)
            ends.append(at)
            if best is None or cost < best[0]:
                best = cost, at
        assert best is not None
        cost, at = _descend(problem, best[1])  # on the grids of the best, which the other starts have replaced
        return Found(at, cost, costs, ends)
    except KeyboardInterrupt:
        candidates = [one for one in (best, problem.best) if one is not None]
        if not candidates:
            raise
        cost, at = min(candidates, key=lambda one: one[0])
        return Found(at, cost, costs, ends, interrupted=True)


def _descend(problem: Problem, vector: Floats) -> tuple[float, Floats]:
    """Least squares from one start, on a new grid wherever the parameters have moved."""
    for _ in range(ROUNDS):
        problem.prepare(vector)
        before = vector
        cost, vector = _least_squares(problem.residuals, problem.jacobian, vector, problem.bounds)
        if np.max(np.abs(vector - before)) < MOVED:
            break
    return cost, vector


def _least_squares(
    residuals: Callable[[Floats], Floats],
    jacobian: Callable[[Floats], Floats],
    vector: Floats,
    bounds: tuple[Floats, Floats],
) -> tuple[float, Floats]:
    from scipy.optimize import least_squares  # noqa: PLC0415  (scipy is optional)

    low, high = bounds
    inside = np.clip(vector, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
    found = least_squares(residuals, inside, jac=jacobian, bounds=bounds, xtol=1e-6, ftol=1e-8, gtol=1e-8, max_nfev=60)
    return 2.0 * float(found.cost), np.asarray(found.x)


def covariance(jacobian: Floats) -> Floats:
    """(P, P) covariance of the parameters, on the scale of the search; infinite where the data say nothing."""
    norms = np.linalg.norm(jacobian, axis=0)
    told = norms > 1e-6 * max(float(norms.max()), 1e-300)
    found = np.full((norms.size, norms.size), 0.0)
    found[np.diag_indices(norms.size)] = np.inf
    if told.any():
        scaled = jacobian[:, told] / norms[told]
        inverse = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12) / np.outer(norms[told], norms[told])
        found[np.ix_(told, told)] = inverse
    return found


def profile(problem: Problem, found: Found, deviations: Floats, rise: float) -> list[tuple[float, float]]:
    """Interval of each parameter in which the best cost with it fixed rises by no more than `rise`.

    Parameters
    ----------
    problem : Problem
    found : Found
        The best parameters.
    deviations : ndarray (P,)
        Standard deviations by the covariance, with which the search for the ends begins.
    rise : float
        Rise of the sum of squares at the ends.

    Returns
    -------
    list of (float, float)
        Ends on the scale of the search; a bound where the cost does not rise that far.
    """
    low, high = problem.bounds
    intervals = []
    for p in range(found.vector.size):
        span = deviations[p] if np.isfinite(deviations[p]) else 0.25 * (high[p] - low[p])
        ends = [
            _end(problem, found, p, side * min(max(span, 1e-4), 0.25 * (high[p] - low[p])), rise)
            for side in (-1.0, 1.0)
        ]
        intervals.append((ends[0], ends[1]))
    return intervals


def _end(problem: Problem, found: Found, p: int, step: float, rise: float) -> float:
    """Place to one side of the best value at which the cost has risen by `rise`, to a hundredth of the interval."""
    low, high = problem.bounds
    others = np.arange(found.vector.size) != p
    rest = found.vector.copy()

    def excess(value: float) -> float:
        """Square root of the rise, nearly linear in the distance, less what is wanted."""
        nonlocal rest

        def whole(part: Floats) -> Floats:
            vector = rest.copy()
            vector[p], vector[others] = value, part
            return vector

        if others.any():
            cost, part = _least_squares(
                lambda part: problem.residuals(whole(part)),
                lambda part: problem.jacobian(whole(part))[:, others],
                rest[others],
                (low[others], high[others]),
            )
            rest = whole(part)
        else:
            residuals = problem.residuals(whole(np.zeros(0)))
            cost = float(residuals @ residuals)
        return math.sqrt(max(cost - found.cost, 0.0)) - math.sqrt(rise)

    best, bound = float(found.vector[p]), float(high[p] if step > 0.0 else low[p])
    near, near_excess = best, -math.sqrt(rise)
    far = best + 2.0 * step
    for _ in range(12):
        far = min(far, bound) if step > 0.0 else max(far, bound)
        far_excess = excess(far)
        if far_excess >= 0.0 or far == bound:
            break
        near, near_excess = far, far_excess
        far = best + 2.0 * (far - best)
    if far_excess < 0.0:
        return bound
    for _ in range(8):  # regula falsi, which knows that the square root is nearly linear
        share = min(max(-near_excess / (far_excess - near_excess), 0.05), 0.95)
        middle = near + share * (far - near)
        value = excess(middle)
        if abs(value) < 0.01 * math.sqrt(rise):
            return middle
        if value < 0.0:
            near, near_excess = middle, value
        else:
            far, far_excess = middle, value
    return near + (far - near) * -near_excess / (far_excess - near_excess)


class FitWarning(UserWarning):
    """Parameters that the data cannot tell apart, or not at all."""

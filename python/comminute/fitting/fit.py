"""Parameters of a material from measured gradings under known stresses. Needs scipy."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from comminute._core import Material
from comminute.fitting.measurements import Measurement, Start, measurements_of
from comminute.fitting.models import FitModel, LatticeModel, Model, Paper, ResolvedLaw
from comminute.fitting.outcome import FitResult
from comminute.fitting.parameters import parameters_of
from comminute.fitting.problem import FitProblem
from comminute.fitting.search import FitWarning, Found, covariance, profile, search
from comminute.util.choices import require_word
from comminute.util.errors import parameter_error, scattered
from comminute.util.keywords import suggests_keywords
from comminute.util.optional import needs

Floats = npt.NDArray[np.float64]
Intervals = Literal["covariance", "profile"]
Loads = Literal["stress", "stress_ratio"]
SAME = 0.95  # correlation beyond which two parameters cannot be told apart
RIVAL = 3.84  # rise of the sum of squares that a confidence of 95 % allows
FAR = 4.0  # standard deviations beyond which another end of the search is another answer
WIDE = 1.5  # standard deviation of ln(value) beyond which a parameter is hardly known


@suggests_keywords
def fit(
    data: Sequence[Measurement | tuple[Any, ...]],
    start: Start | None = None,
    material: Material | None = None,
    free: Sequence[str] = ("fabric_width", "weibull_modulus", "first_crush_stress"),
    *,
    closure: FitModel = "paper",
    error: float = 0.01,
    loads: Loads = "stress",
    starts: int = 4,
    intervals: Intervals = "covariance",
    seed: int = 0,
    cells: int = 100_000,
    threads: int = 1,
) -> FitResult:
    """Find parameters of a material by least squares on the mass finer than the measured sieves.

    Only the measured sieves are read, so that noisy and flat tails are taken as they are. The search goes on the
    logarithms of positive parameters, inside bounds, from several starts.

    Parameters
    ----------
    data : sequence of (float, Grading), (float, Grading, Grading) or Measurement
        Stress and measured grading, with the specimen's own start where it has one. Each specimen was loaded from rest.
    start : Grading or UnknownStart, optional
        Start of all data that name none; without a unit it takes that of the data.
    material : Material, optional
        Values of everything that is not free, and from which the search starts; its reference_size, in the unit of the
        data, is needed.
    free : sequence of str
        Any of "fabric_width", "weibull_modulus", "first_crush_stress", "fragment_scale", "fragment_shape" (of
        WeibullFragments), "loading_rate".
    closure : {"paper", "resolved", "lattice"}
        Model that is fitted. The lattice is run with the same random numbers throughout.
    error : float
        Standard deviation of each mass fraction finer, where a Measurement has no own: 0.01 is the repeatability of
        sieving; a curve read off a figure has 0.01 to 0.02.
    loads : {"stress", "stress_ratio"}
        Kind of the loads of the data.
    starts : int
        Starts of the search, at least 1: the material's values, and a Latin hypercube over usual ranges.
    intervals : {"covariance", "profile"}
        Intervals of 95 %: from the derivatives at the best, or from the profile of the likelihood. Where the fit is
        worse than `error` says, both are widened by the ratio.
    seed : int
        Seed of the starts, and of the lattice.
    cells, threads : int
        Grains and threads of the lattice.

    Returns
    -------
    FitResult

    Raises
    ------
    ParameterError
        For data, names or options that it cannot use; for parameters that no data can tell apart, first_crush_stress
        and reference_size; for more parameters than data.
    ImportError
        Without scipy, naming the extra to install.
    KeyboardInterrupt
        On Ctrl-C before anything was found. Later the result has the best so far, and says so.

    Warns
    -----
    FitWarning
        If two parameters cannot be told apart, if one is hardly known, or if the search was interrupted.

    Examples
    --------
    >>> import comminute as cm
    >>> sieves, start = [2.0, 1.0, 0.5, 0.25, 0.125, 0.063], cm.power_law(2.5, 0.02, 2.0)
    >>> true = cm.Material(reference_size=2.0, fabric_width=0.4, first_crush_stress=3.0)
    >>> run = cm.Simulation(true, start).run(stress=[10.0, 30.0])
    >>> data = [cm.Measurement(s, sieves, run.curve(k).finer_than(sieves)) for k, s in enumerate(run.stress)]
    >>> found = cm.fit(data, start, cm.Material(reference_size=2.0), free=["fabric_width", "first_crush_stress"])
    >>> {name: round(value, 2) for name, value in found.values.items()}
    {'fabric_width': 0.4, 'first_crush_stress': 3.0}
    >>> low, high = found.intervals["fabric_width"]
    >>> low < 0.4 < high
    True
    """
    try:
        import scipy  # noqa: F401, PLC0415  (scipy is optional)
    except ImportError as error_of_import:
        raise needs("fit", "scipy", "fit") from error_of_import
    material = _require_options(material, closure, loads, intervals, starts, cells, threads)
    measured = measurements_of(data, start, error)
    largest = max(datum.stress for datum in measured)
    if isinstance(free, str):
        raise TypeError(f"free is '{free}'; it must be a list of names, ['{free}']")
    by_ratio = loads == "stress_ratio"
    parameters = parameters_of(list(free), material, largest, closure, by_ratio=by_ratio)
    if by_ratio and material.first_crush_stress is not None:
        rule = "loads are stress ratios: leave it out"
        raise parameter_error("first_crush_stress", material.first_crush_stress, rule)
    if not by_ratio and material.first_crush_stress is None and "first_crush_stress" not in free:
        rule = "free it, set it on the Material, or give stress ratios and loads='stress_ratio'"
        raise parameter_error("first_crush_stress", "None", rule, finding="is neither set nor free")
    problem = FitProblem(measured, material, parameters, _model(closure, cells, seed, threads))
    found = search(problem, starts, seed)
    interrupted = found.interrupted
    cov = covariance(problem.jacobian(found.vector))
    freedom = problem.count - len(problem.parameters)
    widening = max(1.0, found.cost / freedom) if freedom > 0 else 1.0
    deviations = np.sqrt(np.diag(cov) * widening)
    low, high = problem.bounds
    times = _times(freedom, widening)
    ends = [
        (max(at - times * sd, lo), min(at + times * sd, hi))
        for at, sd, lo, hi in zip(found.vector, deviations, low, high, strict=True)
    ]
    kind: Intervals = "covariance"
    if intervals == "profile" and not interrupted:
        try:
            ends = profile(problem, found, deviations, times * times * widening)
            kind = "profile"
        except KeyboardInterrupt:
            interrupted = True
    result = FitResult.of(problem, found, cov * widening, ends, kind, closure, interrupted=interrupted)
    for text in remarks(problem, result, deviations) + rivals(problem, result, found, deviations):
        warnings.warn(text, FitWarning, stacklevel=3)  # below the wrapper that suggests keywords
    return result


def remarks(problem: FitProblem, result: FitResult, deviations: Floats) -> list[str]:
    """Sentences on what the data cannot tell."""
    found = []
    if result.interrupted:
        found.append("the search was interrupted; the result is the best so far, with intervals by the covariance")
    names = problem.names
    for p, one in enumerate(problem.parameters):
        if one.by_ratio and not deviations[p] < WIDE:
            found.append(f"the data hardly tell {one.name}: fix it, or measure at other stresses or finer sieves")
        low, high = problem.bounds
        if min(found_at := result.vector[p] - low[p], high[p] - result.vector[p]) < 1e-6 * (high[p] - low[p]):
            end = "lower" if found_at < 0.5 * (high[p] - low[p]) else "upper"
            found.append(f"{one.name} ends at its {end} bound, {result.values[one.name]:g}")
        value, (least, most) = result.values[one.name], result.intervals[one.name]
        if result.interval_kind == "profile" and (least <= one.low < value or value < one.high <= most):
            found.append(f"the data do not bound {one.name} on both sides; measure at other stresses or finer sieves")
    for p in range(len(names)):
        for q in range(p):
            correlation = result.correlation[p, q]
            if abs(correlation) > SAME:
                found.append(
                    f"{names[q]} and {names[p]} can hardly be told apart (correlation {correlation:.3f}): "
                    "fix one of them, or measure at other stresses"
                )
    return found


def rivals(problem: FitProblem, result: FitResult, found: Found, deviations: Floats) -> list[str]:
    """Sentences on other ends of the search that fit as well, far outside the intervals."""
    widening = max(1.0, found.cost / max(result.freedom, 1))
    for cost, end in zip(found.costs, found.ends, strict=True):
        near = cost - found.cost < RIVAL * widening
        if near and np.any(np.abs(end - found.vector) > FAR * np.maximum(deviations, 1e-3)):
            values = ", ".join(f"{name} {value:.3g}" for name, value in problem.values(end).items())
            return [f"other values fit as well: {values}; measure at other stresses, or fix a parameter that is known"]
    return []


def _times(freedom: int, widening: float) -> float:
    """Count the standard deviations to an end of an interval: Student's where the data had to say their error."""
    from scipy.stats import norm, t  # noqa: PLC0415  (scipy is optional)

    return float(t.ppf(0.975, freedom) if widening > 1.0 else norm.ppf(0.975))


def _model(closure: FitModel, cells: int, seed: int, threads: int) -> Model:
    if closure == "paper":
        return Paper()
    if closure == "resolved":
        return ResolvedLaw()
    return LatticeModel(cells=cells, seed=seed, threads=threads)


def _require_options(
    material: Material | None, closure: str, loads: str, intervals: str, starts: int, cells: int, threads: int
) -> Material:
    """Raise for options that are none; the material."""
    require_word("closure", closure, FitModel)
    require_word("loads", loads, Loads)
    require_word("intervals", intervals, Intervals)
    if not isinstance(material, Material):
        raise TypeError(
            f"material is a {type(material).__name__}; it must be a Material, whose reference_size says to which size "
            "first_crush_stress belongs"
        )
    if closure == "paper" and material.strength_scatter:
        raise scattered("the paper's closure")
    if closure != "paper" and not math.isfinite(material.fabric_width):
        raise parameter_error("fabric_width", material.fabric_width, f"closure '{closure}' needs it finite")
    for name, value in (("starts", starts), ("cells", cells), ("threads", threads)):
        if value < 1:
            raise parameter_error(name, value, "it must be at least 1")
    return material

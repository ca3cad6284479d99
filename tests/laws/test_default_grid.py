"""The default grid resolves what it is given, and a warning is given where a grid does not."""

import math
import os
import warnings
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from packets import gradings

import comminute as cm

Floats = npt.NDArray[np.float64]
Draw = Callable[[np.random.Generator, int], Floats]
LOADS = [1.5, 8.0, 100.0]
PACKETS = 4_000_000 if os.environ.get("COMMINUTE_HYPOTHESIS") == "long" else 400_000
NOISE = 1.95 / math.sqrt(PACKETS)  # exceeded by the distance of Kolmogorov and Smirnov once in a thousand
GOAL = 2e-3

TOP = 1.18


def _single(rng: np.random.Generator, count: int) -> Floats:
    return -math.log(TOP) * rng.random(count)


def _uniform(rng: np.random.Generator, count: int) -> Floats:
    return np.log(0.95 + 0.05 * rng.random(count))


def _normal(rng: np.random.Generator, count: int) -> Floats:
    drawn = rng.normal(0.0, 0.02, 2 * count)
    below: Floats = drawn[drawn <= 0.08][:count]
    return below


def _equal(rng: np.random.Generator, count: int) -> Floats:
    return np.zeros(count)


STARTS: dict[str, tuple[cm.Grading, Draw]] = {
    "single fraction": (cm.Grading.from_sieves([1.0, 1.0 / TOP], [100, 0]), _single),
    "uniform 0.95-1": (cm.uniform_size(0.95, 1.0), _uniform),
    "lognormal 0.02": (cm.lognormal(1.0, 0.02), _normal),
    "equal": (cm.monodisperse(1.0), _equal),
}


def _weibull(rng: np.random.Generator, count: int) -> Floats:
    return np.log(-np.log1p(-rng.random(count) * -math.expm1(-1.0)))


def _narrow(rng: np.random.Generator, count: int) -> Floats:
    return rng.normal(math.log(0.5), 0.02, count)


def distance(curve: cm.SizeCurve, sizes: Floats, smallest: float) -> float:
    """Largest difference between a curve and the packets' own, above a size."""
    at = sizes[sizes > smallest][:: max(1, sizes.size // 20_000)]
    finer = curve.finer_than(at)
    below, including = np.searchsorted(sizes, at, "left"), np.searchsorted(sizes, at, "right")
    gap = np.maximum(below / sizes.size - finer, finer - including / sizes.size)
    return float(gap.max())


@pytest.mark.parametrize("name", STARTS)
@pytest.mark.parametrize(
    ("law", "step"),
    [(cm.WeibullFragments(), _weibull), (cm.LogNormalFragments(math.log(0.5), 0.02), _narrow)],
    ids=["weibull", "narrow law"],
)
@pytest.mark.parametrize("n", [0.02, 1.0])
def test_the_default_grid_follows_start_and_fragments(
    name: str, law: cm.WeibullFragments | cm.LogNormalFragments, step: Draw, n: float
) -> None:
    grading, draw = STARTS[name]
    material = cm.Material(fabric_width=n, fragments=law)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = cm.Simulation(material, grading).run(stress_ratio=LOADS, keep_fabrics=[])
    assert result.grid.bins <= 4001
    packets = gradings(draw, step, LOADS, fabric_width=n, packets=PACKETS)
    for k in range(len(LOADS)):
        assert distance(result.curve(k), packets[k], result.edge_size[1]) < GOAL + NOISE


def test_an_ordinary_grid_is_as_wide_as_ever() -> None:
    sand = cm.Grading.from_sieves([2, 1, 0.5, 0.25, 0.125, 0.063], [100, 80, 50, 30, 10, 2])
    for grading in (sand, cm.fuller(1.0), cm.power_law(2.5, 1e-3, 1.0), cm.monodisperse(1.0)):
        grid = cm.fitting_grid(grading, cm.Material(), 100.0)
        assert grid.spacing == pytest.approx(0.02, rel=0.02)
        assert cm.needed_spacing(cm.Material(), grading) > 0.02
    assert cm.fitting_grid(sand, cm.Material(), 100.0, spacing=0.05).spacing == pytest.approx(0.05, rel=0.05)


def test_a_grid_too_coarse_warns_with_the_error_to_expect() -> None:
    narrow = cm.uniform_size(0.95, 1.0)
    with pytest.warns(cm.ResolutionWarning, match=r"bins are 0\.03 wide .* need 0\.0029: expect errors of about 0\.2"):
        coarse = cm.Simulation(cm.Material(), narrow, grid=cm.LogGrid(-6.0, 0.0, 201)).run(stress_ratio=[2.0])
    exact = cm.Simulation(cm.Material(), narrow).run(stress_ratio=[2.0])
    at = np.linspace(0.9, 1.0, 500)
    error = float(np.abs(coarse.curve(0).finer_than(at) - exact.curve(0).finer_than(at)).max())
    assert 0.02 < error < 0.4  # the warning has the order of it
    assert coarse.resume(stress_ratio=4.0).warnings[0] == coarse.warnings[0]
    halving = cm.Material(fragments=cm.LogNormalFragments(math.log(0.5), 1e-8))
    with pytest.warns(cm.ResolutionWarning, match=r"expect errors up to 0\.5"):
        cm.Simulation(halving, cm.monodisperse(1.0)).run(stress_ratio=[2.0], keep_fabrics=[])

"""Which kernels have one solve, and answers in closed form where the fabric is off."""

import math
from typing import Literal

import numpy as np
import pytest

import comminute as cm
import reference_quasi_static as qs
from reference import Array

GRID = cm.LogGrid(-12.0, 0.0, 121)


def cdf_difference(a: Array, b: Array) -> float:
    return float(np.abs(np.cumsum((a - b).sum(axis=1))).max())


# --- abelian, and not ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", ["conservative", "paper"])
@pytest.mark.parametrize("rate", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("n", [0.05, 0.7])
def test_slow_blend_and_fast_forget_the_steps(n: float, rate: float, scheme: qs.Scheme) -> None:
    grid, material = cm.LogGrid(-6.0, 0.0, 61), cm.Material(fabric_width=n)
    start = cm.mixed_fabric(cm.power_law(2.5, 0.02, 1.0), grid)
    solver = cm.QuasiStatic(grid, material, scheme, rate)
    once, crushed = solver.solve(start, 300.0), solver.report.crushed
    fabric, counted = start, 0.0
    for load in np.geomspace(0.5, 300.0, 60):
        fabric = solver.solve(fabric, float(load))
        counted += solver.report.crushed
    np.testing.assert_allclose(fabric.probability, once.probability, rtol=0.0, atol=1e-14)
    assert counted == pytest.approx(crushed, rel=1e-13)


def test_the_rate_must_be_constant() -> None:
    start = cm.mixed_fabric(cm.power_law(2.5, 0.02, 1.0), GRID)
    slow, fast = (cm.QuasiStatic(GRID, cm.Material(fabric_width=0.5), loading_rate=rate) for rate in (0.0, 1.0))
    one_way = fast.solve(slow.solve(start, 10.0), 100.0)
    other_way = slow.solve(fast.solve(start, 10.0), 100.0)
    assert cdf_difference(one_way.probability, other_way.probability) > 1e-2


def test_the_exact_kernel_remembers_the_steps_and_auto_never_solves_it() -> None:
    start = cm.mixed_fabric(cm.power_law(2.5, 0.05, 1.0), GRID)
    sim = cm.Simulation(cm.Material(), start, scheme="paper")
    loads = (1e4 * np.geomspace(1e-3, 1.0, 40)).tolist()
    many, one = sim.run(stress_ratio=loads, kind="exact"), sim.run(stress_ratio=1e4, kind="exact")
    assert many.engine == one.engine == "full-convolution"
    assert np.abs(many.cdf[-1] - one.cdf[-1]).max() > 1e-3
    slow, slow_once = sim.run(stress_ratio=loads), sim.run(stress_ratio=1e4)
    assert slow.engine == "quasi-static"
    np.testing.assert_allclose(slow.cdf[-1], slow_once.cdf[-1], rtol=0.0, atol=1e-14)
    kinds: tuple[Literal["fast", "blend", "slow"], ...] = ("fast", "blend", "slow")
    for kind in kinds:
        rate = 0.3 if kind == "blend" else 0.0
        assert sim.run(stress_ratio=2.0, kind=kind, loading_rate=rate).engine == "quasi-static"
    assert sim.run(stress_ratio=2.0, steps_per_load=2).engine == "slow-update"
    with pytest.raises(cm.ParameterError, match="no solve"):
        sim.run(stress_ratio=2.0, kind="exact", engine="quasi-static")


# --- fabric off ---------------------------------------------------------------------------------------------
#
# X uniform: settled sizes are s/s_c ~ U(0, 1), s_c = s_max sigma*^(-w/3), and a grain that starts at s_max has crushed
# 1 + Poisson(ln(s_max/s_c)) times. Slow: the larger of the two crushes, so that both settle like that.


def settled(
    bins: int, n: float, w: float, stress_ratio: float, scheme: qs.Scheme = "conservative"
) -> tuple[cm.Fabric, float]:
    grid = cm.LogGrid(-16.0, 0.3, bins)
    material = cm.Material(weibull_modulus=w, fabric_width=n, fragments=cm.PowerLawFragments(1.0))
    solver = cm.QuasiStatic(grid, material, scheme)
    after = solver.solve(cm.mixed_fabric(cm.monodisperse(1.0), grid), stress_ratio)
    assert solver.report.crushed == pytest.approx(solver.report.crushed_neighbour, rel=1e-12)
    return after, solver.report.crushed


def errors(
    bins: int, n: float, w: float, stress_ratio: float, scheme: qs.Scheme = "conservative"
) -> tuple[float, float]:
    """Error of the cdf, at sizes further than a coarse bin from s_c, and of the mean number of crushes."""
    after, crushed = settled(bins, n, w, stress_ratio, scheme)
    critical = -w / 3.0 * math.log(stress_ratio)
    edges, finer = after.grid.edges[1:], after.cdf()
    away = (np.abs(edges - critical) > 0.15) & (edges < -0.15)
    exact = np.exp(np.minimum(edges - critical, 0.0))
    return float(np.abs(finer - exact)[away].max()), crushed - (1.0 - critical)


@pytest.mark.parametrize("n", [math.inf, 100.0, 300.0])
@pytest.mark.parametrize(("w", "stress_ratio"), [(3.0, 8.0), (3.0, 20.0), (6.0, 5.0), (1.5, 300.0)])
def test_without_fabric_sizes_are_uniform_and_crushes_poisson(n: float, w: float, stress_ratio: float) -> None:
    of_fabric = 0.0 if n == math.inf else 20.0 / n**2  # what a wide fabric still does: (ln s)^2 / n^2
    for bins in (129, 257, 513, 1025):
        h = 16.3 / (bins - 1)
        cdf, count = errors(bins, n, w, stress_ratio)
        assert cdf < 0.2 * h**2 + of_fabric
        assert abs(count) < 0.3 * h**2 + 5.0 * of_fabric


def test_the_centre_test_is_of_first_order_there() -> None:
    worst = [
        max(errors(bins, math.inf, 3.0, load, "paper")[0] for load in (7.0, 8.0, 9.0)) for bins in (257, 513, 1025)
    ]
    for bins, error in zip((257, 513, 1025), worst, strict=True):
        assert error > 0.2 * 16.3 / (bins - 1)


def test_settled_sizes_without_fabric_are_independent_of_the_neighbour() -> None:
    after, _ = settled(513, math.inf, 3.0, 8.0)
    p = after.probability
    np.testing.assert_allclose(p, p.T, rtol=0.0, atol=1e-15)
    far = after.grid.edges[1:] < -math.log(8.0) - 0.15
    product = np.outer(p.sum(axis=1), p.sum(axis=0))
    assert np.abs((p - product)[np.ix_(far, far)]).max() < 1e-5 * product.max()

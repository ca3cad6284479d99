"""Answers known in closed form."""

import math
from itertools import pairwise

import numpy as np
import pytest

import comminute as cm
from reference import Array


def crushed_by_all_passes(law: cm.WeibullFragments | cm.PowerLawFragments, spacing: float, passes: int) -> Array:
    """Grainsize pmf by depth in bins after every cell has crushed `passes` times from a point at the top."""
    depth = 40.0  # so deep that the fines bin stays empty: e^-40
    bins = round(depth / spacing) + 1
    grid = cm.LogGrid(-depth, 0.0, bins)
    p = np.zeros((bins, bins))
    p[-1, -1] = 1.0
    engine = cm.FullConvolution(grid, cm.Material(fragments=law), "fast", scheme="conservative")
    engine.settle(p, math.inf, steps=passes, out=p)
    assert p.sum(axis=0) == pytest.approx(p.sum(axis=1), abs=1e-15)  # separable and symmetric
    return np.asarray(p.sum(axis=1)[::-1], dtype=np.float64)


def moments(pmf: Array, spacing: float) -> tuple[float, float, float]:
    """Mean, variance and third central moment of the drop in psi."""
    drop = spacing * np.arange(pmf.size)
    mean = float(pmf @ drop)
    return mean, float(pmf @ (drop - mean) ** 2), float(pmf @ (drop - mean) ** 3)


@pytest.mark.parametrize("passes", [1, 3])
def test_uniform_reductions_have_the_moments_of_a_gamma_law(passes: int) -> None:
    """-psi ~ Gamma(passes, 1). Hat-weighted deposits keep the mean and widen the variance by O(h^2)."""
    excess = []
    for spacing in (0.2, 0.1, 0.05):
        mean, variance, _ = moments(crushed_by_all_passes(cm.PowerLawFragments(1.0), spacing, passes), spacing)
        assert mean == pytest.approx(passes, abs=1e-12)
        excess.append(variance - passes)
    assert excess[0] / excess[1] == pytest.approx(4.0, rel=0.01)
    assert excess[1] / excess[2] == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize("passes", [1, 2, 3])
def test_gamma_law_itself(passes: int) -> None:
    """Largest CDF error at the upper edges falls fourfold a halving: second order."""
    worst = []
    for spacing in (0.2, 0.1, 0.05):
        pmf = crushed_by_all_passes(cm.PowerLawFragments(1.0), spacing, passes)
        depth = spacing * (np.arange(1, 200) - 0.5)  # upper edges of the bins below the first
        tail = sum(np.exp(-depth) * depth**q / math.factorial(q) for q in range(passes))
        finer = 1.0 - np.cumsum(pmf)[: depth.size]
        worst.append(np.abs(finer - tail).max())
    assert worst[0] / worst[1] == pytest.approx(4.0, rel=0.15)
    assert worst[1] / worst[2] == pytest.approx(4.0, rel=0.15)


def test_truncated_exponential_moments_add_over_crushes() -> None:
    """Eq. 4: E R, Var R and skewness; mean and variance add over independent crushes."""
    exact = (1.2602020108, 1.2316466670, 1.6782 * 1.2316466670**1.5)
    spacing = 0.1
    coarse = moments(crushed_by_all_passes(cm.WeibullFragments(), 2 * spacing, 1), 2 * spacing)
    fine = moments(crushed_by_all_passes(cm.WeibullFragments(), spacing, 1), spacing)
    for before, after, value in zip(coarse, fine, exact, strict=True):
        extrapolated = after + (after - before) / 3.0  # second order: Richardson leaves O(h^4)
        assert extrapolated == pytest.approx(value, abs=2e-4)
    mean, variance, _ = moments(crushed_by_all_passes(cm.WeibullFragments(), spacing, 4), spacing)
    assert mean == pytest.approx(4 * fine[0], abs=1e-9)  # 1e-9: what the fines bin at depth 40 holds
    assert variance == pytest.approx(4 * fine[1], abs=1e-9)


def test_a_monodisperse_packing_crushes_by_half_at_its_closed_threshold() -> None:
    grid, material = cm.LogGrid(-6.0, 1.0, 351), cm.Material()
    start = cm.mixed_fabric(cm.monodisperse(1.0), grid, points="binned")
    engine = cm.SlowUpdate(grid, material, scheme="paper")
    engine.step(start.probability, 1.0)
    assert engine.report.crushed == 0.5
    engine.step(start.probability, 1.0 - 1e-9)
    assert engine.report.crushed == 0.0


def test_critical_stress_is_eq_2_and_g_crosses_g_star_there() -> None:
    material = cm.Material(weibull_modulus=5.0, fabric_width=0.2, reference_size=2.0)
    size, neighbour = np.array([0.3, 1.0, 2.0, 3.0]), np.array([0.4, 0.9, 2.0, 2.5])
    critical = cm.critical_stress_ratio(material, size, neighbour)
    by_hand = (size / 2.0) ** -0.6 * np.exp(np.log(size / neighbour) ** 2 / 0.08)
    np.testing.assert_allclose(critical, by_hand, rtol=1e-13)
    g = cm.stress_function(material, np.log(size), np.log(neighbour))
    np.testing.assert_allclose(cm.logspace_load(material, critical), g, rtol=0.0, atol=1e-14)
    assert material.k == pytest.approx(6 * 0.04 / 5)


@pytest.mark.parametrize("bins", [326, 651, 1301])
def test_without_fabric_only_size_decides(bins: int) -> None:
    """Fabric off, uniform fragments: s/s_c ~ U(0, 1), s_c = s_max sigma*^(-w/3), and 1 + ln(s/s_c) crushes.

    With s_c on a bin edge the sizes are exact on the grid. The count is not, since bins speak for their mass by
    their centre: the mean drop to the first fragments is (h/2) / sinh(h/2) instead of 1, and that of the settled
    sizes below s_c is (h/2) coth(h/2).
    """
    h = 13.0 / (bins - 1)
    grid = cm.LogGrid(-13.0 + h / 2, h / 2, bins)
    material = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(1.0))
    start = cm.mixed_fabric(cm.monodisperse(math.exp(h / 2)), grid)
    result = cm.Simulation(material, start).run(stress_ratio=math.exp(3.0))  # w = 3: ln s_c = -3
    below = result.edge_size <= math.exp(-3.0) * (1 + 1e-9)
    assert below.sum() == (bins - 1) * 10 / 13
    np.testing.assert_allclose(result.cdf[0][below], result.edge_size[below] * math.exp(3.0), rtol=0.0, atol=1e-13)
    expected = 1.0 + 3.0 + h / 2 - (h / 2) / math.sinh(h / 2) + (h / 2) / math.tanh(h / 2)
    assert result.crushes[0] == pytest.approx(expected, abs=math.exp(-10.0))  # what lies in the fines bin


@pytest.mark.parametrize("engine", [cm.FullConvolution, cm.SlowUpdate])
def test_without_fabric_grains_crush_1_plus_poisson_times(
    engine: type[cm.FullConvolution] | type[cm.SlowUpdate],
) -> None:
    """Fabric off, uniform fragments: from s_max to rest a grain crushes 1 + Poisson(ln(s_max / s_c)) times.

    A step crushes every active grain once, so that the mass still active after t steps is that of more than t crushes.
    The neighbours lie among the fines and never crush; s_c is a bin edge, where the centre test is exact.
    """
    drop, load = 3.0, math.exp(3.0)  # w = 3: ln s_c = -3
    more_than = 1.0 - np.cumsum([math.exp(-drop) * drop**k / math.factorial(k) for k in range(14)])

    def error(bins_above: int) -> tuple[float, float]:
        h = drop / (bins_above - 0.5)
        grid = cm.LogGrid(-h * (2 * bins_above), 0.0, 2 * bins_above + 1)
        material = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(1.0))
        p = np.zeros((grid.bins, grid.bins))
        p[-1, 0] = 1.0
        count = cm.QuasiStatic(grid, material)
        count.solve(p, load)
        steps, active = engine(grid, material, scheme="conservative"), []
        for _ in more_than:
            p = steps.step(p, load)
            active.append(p[-bins_above:].sum())
        # The mean number of crushes, of one solve, is the sum of the chances of more than 0, 1, 2, ...
        assert count.report.crushed == pytest.approx(1.0 + sum(active), abs=1e-5)  # more than 14 crushes
        return h, float(np.abs(np.array(active) - more_than).max())

    errors = [error(bins_above) for bins_above in (16, 32, 64, 128)]
    for (wide, coarse), (narrow, fine) in pairwise(errors):
        assert math.log(coarse / fine) / math.log(wide / narrow) == pytest.approx(2.0, abs=0.01)

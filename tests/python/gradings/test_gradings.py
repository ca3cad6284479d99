"""Ideal gradings against their formulas, and what they say of themselves."""

import math
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import comminute as cm

SIZES = np.geomspace(1e-3, 4.0, 50)


def test_uniform_in_size_and_in_its_log() -> None:
    uniform, log_uniform = cm.uniform_size(0.2, 2.0), cm.log_uniform(0.2, 2.0)
    np.testing.assert_allclose(uniform.finer(SIZES), np.clip((SIZES - 0.2) / 1.8, 0, 1), rtol=0, atol=1e-15)
    expected = np.clip(np.log(SIZES / 0.2) / math.log(10), 0, 1)
    np.testing.assert_allclose(log_uniform.finer(SIZES), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("exponent", [0.4, 0.5, 1.0])
def test_fuller_and_talbot(exponent: float) -> None:
    curve = cm.fuller(2.0, exponent)
    np.testing.assert_allclose(curve.finer(SIZES), np.minimum((SIZES / 2.0) ** exponent, 1.0), rtol=1e-14)
    assert curve.smallest() == 0.0
    assert curve.finer(curve.smallest(0.05)) == pytest.approx(0.05, rel=1e-12)


def test_lognormal_is_the_normal_law_of_ln_size_cut_and_rescaled() -> None:
    law = NormalDist(math.log(0.5), 0.4)
    curve = cm.lognormal(0.5, 0.4, largest=1.5)
    whole = law.cdf(math.log(1.5))
    expected = [min(law.cdf(math.log(size)) / whole, 1.0) for size in SIZES]
    np.testing.assert_allclose(curve.finer(SIZES), expected, rtol=0, atol=1e-14)
    assert curve.notes == ()
    assert "cut off 4 standard deviations above its median" in cm.lognormal(0.5, 0.4).notes[0]
    assert cm.lognormal(0.5, 0.4).largest == pytest.approx(0.5 * math.exp(1.6))


def test_rosin_rammler_is_a_weibull_law_of_size_cut_and_rescaled() -> None:
    curve = cm.rosin_rammler(0.8, 1.3, largest=2.0)
    weibull = 1.0 - np.exp(-((SIZES / 0.8) ** 1.3))
    expected = np.minimum(weibull / (1.0 - math.exp(-((2.0 / 0.8) ** 1.3))), 1.0)
    np.testing.assert_allclose(curve.finer(SIZES), expected, rtol=1e-12)
    free = cm.rosin_rammler(0.8, 1.3)
    assert math.exp(-((free.largest / 0.8) ** 1.3)) == pytest.approx(1e-4)
    assert "cut off where 0.01 % would be coarser" in free.notes[0]


GRADINGS = [
    cm.monodisperse(1.0),
    cm.gap_graded(1.0, 0.1),
    cm.power_law(2.5, 1e-3, 1.0),
    cm.uniform_size(0.0, 1.0),
    cm.fuller(1.0),
    cm.lognormal(0.3, 0.5),
    cm.rosin_rammler(0.3, 0.9),
    cm.Grading.from_sieves([1.0, 0.5, 0.2], [100, 40, 7]),
]


@pytest.mark.parametrize("grading", GRADINGS, ids=repr)
@given(load=st.floats(0.0, 1e4), w=st.floats(1.0, 9.0))
def test_a_fitting_grid_holds_the_grading_and_keeps_clear_of_the_zone(
    grading: cm.Grading, load: float, w: float
) -> None:
    material = cm.Material(weibull_modulus=w)
    grid = cm.fitting_grid(grading, material, load, spacing=0.05)
    pmf = grading.on_grid(grid)
    assert pmf.sum() == pytest.approx(1.0, abs=1e-12)
    assert pmf[0] <= 2e-3
    assert grid.bins <= 2001
    assert cm.CrushZones(grid, material, load).distrusted_below == -math.inf
    on_centre = grid.sizes[-1] == pytest.approx(grading.largest, rel=1e-12)
    on_edge = grid.edge_sizes[-1] == pytest.approx(grading.largest, rel=1e-12)
    assert on_centre if grading in GRADINGS[:2] else on_edge


def test_fragments_of_new_laws_crush_and_keep_mass() -> None:
    for law in (
        cm.LogNormalFragments(-1.2, 0.7),
        cm.TabulatedFragments([0.1, 0.3, 0.6, 1.0], [0.05, 0.3, 0.3, 1.0]),
    ):
        result = cm.Simulation(cm.Material(fragments=law), cm.power_law(2.5, 1e-2, 1.0)).run(stress_ratio=[2, 100])
        assert np.abs(result.mass_error).max() < 1e-13
        assert result.crushes[1] > result.crushes[0] > 0.0

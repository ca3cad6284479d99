"""Weibull moduli from single grains."""

import numpy as np
import pytest
from scipy.stats import linregress

import comminute as cm


def test_a_slope_by_size_is_that_of_a_regression() -> None:
    rng = np.random.default_rng(0)
    size = np.geomspace(0.1, 10.0, 12)
    strength = 30.0 * size**-0.75 * np.exp(0.1 * rng.standard_normal(12))
    line = linregress(np.log(size), np.log(strength))
    found = cm.strength_slope(strength, size)
    assert found.weibull_modulus == pytest.approx(-3.0 / line.slope)
    assert found.standard_error == pytest.approx(3.0 * line.stderr / line.slope**2)


def test_scatter_finds_the_modulus_within_its_error() -> None:
    rng = np.random.default_rng(1)
    found = [cm.strength_slope(20.0 * rng.weibull(3.0, 200)) for _ in range(40)]
    moduli = np.array([one.weibull_modulus for one in found])
    assert abs(moduli.mean() / 3.0 - 1.0) < 0.06  # the slope of ranked strengths is a little low
    assert 0.7 < np.mean([one.standard_error for one in found]) / moduli.std(ddof=1) < 1.4


@pytest.mark.parametrize(
    ("strength", "size", "words"),
    [
        ([1.0, 2.0], None, "give at least three that differ"),
        ([2.0, 2.0, 2.0], None, "give at least three that differ"),
        ([1.0, -2.0, 3.0], None, r"strength\[1\] is -2"),
        ([1.0, 2.0], [1.0], "give one for each strength"),
        ([1.0, 2.0], [1.0, 1.0], "at least two different ones"),
        ([1.0, 2.0], [1.0, 2.0], "strength must fall with size"),
    ],
)
def test_strengths_that_say_nothing_are_refused(strength: list[float], size: list[float] | None, words: str) -> None:
    with pytest.raises(cm.ParameterError, match=words):
        cm.strength_slope(strength, size)

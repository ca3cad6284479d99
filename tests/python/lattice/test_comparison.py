"""Runs held against each other: distances, the errors of both sides, and what noise alone would do."""

import math
import os

import numpy as np
import pytest

import comminute as cm

LONG = os.environ.get("COMMINUTE_HYPOTHESIS") == "long"
MATERIAL = cm.Material()
STARTS = {"monodisperse": cm.monodisperse(1.0), "gap-graded": cm.gap_graded(1.0, 0.1)}
NULL_GRID = cm.LogGrid(-8.0, 0.1, 163)


def test_continuum_and_lattice_are_compared_load_by_load() -> None:
    """The M = 2 reduction on a gap-graded start: some hundredths off; on a monodisperse one 0.06 to 0.07."""
    loads = [2.0, 8.0, 100.0]
    for start, least, most in [("gap-graded", 0.010, 0.030), ("monodisperse", 0.05, 0.075)]:
        continuum = cm.Simulation(MATERIAL, STARTS[start]).run(stress_ratio=loads)
        lattice = cm.Lattice(50_000, MATERIAL, STARTS[start], replicas=4)
        found = cm.compare(continuum, lattice.run(stress_ratio=loads, grid=continuum.grid))
        assert found.distance.shape == found.standard_error.shape == found.size.shape == (3,)
        assert (found.standard_error < 0.002).all()
        assert (found.distance > least).all()
        assert (found.distance < most).all()
        np.testing.assert_array_equal(found.stress_ratio, loads)
        assert (found.p_value < 1e-3).all()


def test_a_comparison_is_the_same_in_either_order_and_has_the_errors_of_both_sides() -> None:
    start, loads = STARTS["gap-graded"], [2.0, 8.0]
    continuum = cm.Simulation(MATERIAL, start).run(stress_ratio=loads)
    few, many = (
        cm.Lattice(5_000, MATERIAL, start, replicas=count, seed=count).run(stress_ratio=loads, grid=continuum.grid)
        for count in (3, 6)
    )
    for one, other in [(continuum, few), (few, many)]:
        found, turned = cm.compare(one, other), cm.compare(other, one)
        np.testing.assert_array_equal(found.distance, turned.distance)
        np.testing.assert_array_equal(found.size, turned.size)
        np.testing.assert_array_equal(found.each_error, turned.each_error[::-1])
        np.testing.assert_array_equal(found.p_value, turned.p_value)
        np.testing.assert_allclose(found.standard_error, np.hypot(*found.each_error))
        at = np.searchsorted(other.edge_size, found.size)
        np.testing.assert_array_equal(found.each_error[1], other.cdf_error[[0, 1], at])
    assert cm.compare(continuum, few).each_error[0].tolist() == [0.0, 0.0]
    assert cm.compare(continuum, continuum).p_value.tolist() == [1.0, 1.0]
    single = cm.Lattice(500, MATERIAL, start).run(stress_ratio=loads, grid=continuum.grid)
    assert np.isnan(cm.compare(single, continuum).p_value).all()


@pytest.mark.parametrize("replicas", [2, 4, 8])
def test_p_values_of_equal_laws_are_as_small_as_they_say(replicas: int) -> None:
    """A curve of few cells in one replica has the noise of many, so small lattices will do."""
    pairs = 2000 if LONG else 300
    start = cm.log_uniform(0.05, 1.0)

    def drawn(seed: int) -> cm.LatticeResult:
        rings = cm.Lattice(1000, cm.Material(fabric_width=0.3), start, replicas=replicas, seed=seed)
        return rings.run(stress_ratio=[3.0], grid=NULL_GRID, keep_fabrics=[])

    found = [cm.compare(drawn(2 * k), drawn(2 * k + 1)) for k in range(pairs)]
    p = np.array([float(one.p_value[0]) for one in found])
    ratio = np.array([float(one.distance[0] / one.standard_error[0]) for one in found])
    for level in (0.02, 0.1, 0.3):
        share = float(np.mean(p < level))
        noise = math.sqrt(level * (1.0 - level) / pairs)
        assert share < level + 3.3 * noise, level
    assert np.mean(p < 0.3) > 0.1  # and not much smaller than that
    assert np.mean(ratio > 2.0) > 0.25  # which two standard errors are not

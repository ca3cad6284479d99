"""Curves at exact sizes: the user's own numbers, the largest grain, and sieves of a measured start."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm

MATERIAL = cm.Material(fabric_width=0.2, fragments=cm.PowerLawFragments(1.5), first_crush_stress=2.0)
SAND = cm.Grading.from_sieves([1.5, 1.0, 0.5, 0.2], [100, 60, 20, 3], unit="mm")
SIEVES = [63.0, 31.5, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.063]
PASSING = [100.0, 100.0, 92.0, 71.0, 55.0, 40.0, 31.0, 22.0, 15.0, 9.0, 4.0]


def passing(result: cm.Result) -> npt.NDArray[np.float64]:
    """(T, M) per cent passing SIEVES after each load."""
    return np.array([result.curve(k).to_sieves(SIEVES).percent_finer for k in range(result.stress_ratio.size)])


@pytest.mark.filterwarnings("ignore:bins are .* wide")  # one grid is coarse on purpose
def test_no_size_above_the_largest_grain_is_read() -> None:
    gap = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[0.5, 2.0, 100.0])
    np.testing.assert_array_equal(gap.percentile(100), [1.0, 1.0, 1.0])
    sand = cm.Simulation(MATERIAL, SAND).run(stress_ratio=[1.0, 8.0])
    np.testing.assert_array_equal(sand.percentile(100), 1.5)
    coarse_grid = cm.Simulation(MATERIAL, SAND, grid=cm.LogGrid(-6.0, 0.63, 66)).run(stress_ratio=1.0)
    np.testing.assert_array_equal(coarse_grid.percentile(100), 1.5)  # inside a bin of the user's grid
    stepped = cm.Simulation(MATERIAL, SAND).run(stress_ratio=[1.0], engine="slow-update", remix_after=[0])
    np.testing.assert_array_equal(stepped.percentile(100), 1.5)
    for result in (gap, sand, coarse_grid, stepped):
        for k in range(result.stress_ratio.size):  # inf{d : F(d) >= 1}
            assert result.curve(k).percentile(100) == result.percentile(100)[k]
            assert result.curve(k).finer_than(result.start.largest) == 1.0


def test_crushed_equal_grains_end_at_their_own_size() -> None:
    result = cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1.0)
    curve = result.curve()
    assert curve.finer_than(1.0) == 1.0
    table = curve.to_sieves([1.0, 0.5])
    assert table.percent_finer[0] == 100.0
    assert table.percent_retained[1] > 50.0  # the grains that are left, and fragments above half their size


@settings(deadline=None, max_examples=200)
@given(st.floats(1e-6, 1e6))
def test_a_curve_counts_grains_of_exactly_the_size_asked_for(size: float) -> None:
    equal = cm.Simulation(cm.Material(reference_size=size), cm.monodisperse(size)).run(stress_ratio=0.0)
    assert equal.curve().finer_than(size) == 1.0
    assert equal.curve().finer_than(np.nextafter(size, 0.0)) == 0.0
    np.testing.assert_array_equal(equal.curve().to_sieves([size]).percent_finer, [100.0])


def test_exact_sizes_keep_the_number_of_the_user() -> None:
    gap = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[0.0, 0.5], remix_after=[0])
    for k in range(2):
        assert gap.curve(k).finer_than(0.1) == 0.5
        assert cm.fines_share(gap.curve(k), 0.1) == 0.5
        np.testing.assert_array_equal(gap.curve(k).to_sieves([1.0, 0.1]).percent_finer, [100.0, 50.0])
    assert [point.size for point in gap.points[1]] == [0.1, 1.0]


def test_unloaded_sieve_data_give_back_their_own_table() -> None:
    start = cm.Grading.from_sieves(SIEVES, PASSING)
    for grid in (None, cm.LogGrid(-8.0, 4.3, 200)):
        sim = cm.Simulation(cm.Material(reference_size=16.0), start, grid=grid)
        result = sim.run(stress_ratio=[0.0, 1e-3])
        for k in range(2):
            np.testing.assert_allclose(result.curve(k).to_sieves(SIEVES).percent_finer, PASSING, rtol=0.0, atol=1e-12)
        for percent in (10.0, 30.0, 50.0, 60.0, 90.0):
            assert result.percentile(percent)[0] == pytest.approx(start.percentile(percent), rel=1e-12)


def test_sieve_data_bend_where_little_has_crushed() -> None:
    start = cm.Grading.from_sieves(SIEVES, PASSING)
    result = cm.Simulation(cm.Material(reference_size=16.0), start).run(stress_ratio=[0.5, 1.0, 2.0])
    finer = passing(result)
    assert np.all(finer >= np.array(PASSING) - 1e-9)  # crushing makes finer, at every sieve
    assert np.all(np.diff(finer, axis=0) >= -1e-9)
    fine = cm.Simulation(cm.Material(reference_size=16.0), start, grid=cm.LogGrid(-8.0, 4.2, 3001)).run([0.5, 1.0, 2.0])
    exact = passing(fine)
    np.testing.assert_allclose(finer, exact, rtol=0.0, atol=0.02)


def test_a_lattice_keeps_its_exact_sizes(tmp_path: Path) -> None:
    equal = cm.Lattice(1000, cm.Material(), cm.monodisperse(0.1), replicas=4).run(stress_ratio=[0.0, 1e3])
    assert equal.percentile(1)[0] == equal.percentile(99)[0] == 0.1
    assert equal.start_curve.finer_than(0.1) == 1.0
    assert equal.start_curve.finer_than(0.0999999) == 0.0
    np.testing.assert_array_equal(equal.percentile(100), 0.1)
    rings = cm.Lattice(1000, cm.Material(), cm.gap_graded(1.0, 0.1), replicas=4)
    gap = rings.run(stress_ratio=[0.0, 8.0])
    intact = (rings.psi == 0.0) & (rings.crushes == 0)
    assert gap.points[1][-1].size == 1.0
    assert gap.points[1][-1].mass == pytest.approx(float(np.mean(intact)), rel=1e-12)
    without, including = gap.curve(1).finer[gap.curve(1).size == 1.0]
    assert including - without == pytest.approx(gap.points[1][-1].mass, rel=1e-12)
    gap.save(tmp_path / "gap.nc")
    assert cm.open_result(tmp_path / "gap.nc") == gap
    broad = cm.Lattice(1000, cm.Material(), cm.power_law(2.5, 0.01, 1.0)).run(stress_ratio=0.0)
    assert broad.points == ((),)  # a thousand sizes make no steps
    given = cm.Lattice.from_sizes(np.tile([0.3, 0.1], 50), cm.Material()).run(stress_ratio=0.0)
    np.testing.assert_array_equal(given.curve(0).finer_than([0.1, 0.3]), [0.5, 1.0])


@pytest.mark.parametrize("intervals", [100, 137, 400])
def test_own_fragments_are_smaller_than_the_grains_they_come_from(intervals: int) -> None:
    grid = cm.LogGrid(-8.0, 0.0, intervals + 1)
    equal = cm.Simulation(cm.Material(), cm.monodisperse(1.0), grid=grid)
    # Half of the mass is intact after the first load, a quarter of that has two intact neighbours, and either of two
    # equal sizes may crush: .5 + 1/16, whatever the bins.
    twice = equal.run(stress_ratio=[1.0, 1.0], remix_after=[0])
    assert twice.crushes[1] == pytest.approx(0.5 + 0.0625, abs=1e-12)
    # With the fabric off each grain of the critical size crushes once, and none of its fragments.
    off = cm.Simulation(cm.Material(fabric_width=np.inf), cm.monodisperse(1.0), grid=grid)
    assert off.run(stress_ratio=1.0).crushes[0] == pytest.approx(1.0, abs=1e-12)
    nearly = cm.Simulation(cm.Material(fabric_width=1e6), cm.monodisperse(1.0), grid=grid)
    assert nearly.run(stress_ratio=1.0).crushes[0] < 1.0 + 1e-6


@pytest.mark.parametrize(
    ("start", "loads"),
    [(cm.monodisperse(1.0), [8.0, 2.0, 4.0]), (cm.gap_graded(1.0, float(np.exp(-2.0))), [8.0, 32.0])],
    ids=["equal", "gap-graded"],
)
def test_exact_sizes_after_a_remixing_are_second_order(start: cm.Grading, loads: list[float]) -> None:
    def crushes(intervals: int) -> float:
        sim = cm.Simulation(cm.Material(), start, grid=cm.LogGrid(-8.0, 0.0, intervals + 1))
        return float(sim.run(stress_ratio=loads, remix_after=[0], keep_fabrics=[]).crushes[-1])

    limit = crushes(4000)
    for intervals in (200, 400, 800):  # where the tip lies in its bin scatters the error, within h^2
        assert abs(crushes(intervals) - limit) < 0.5 * (8.0 / intervals) ** 2

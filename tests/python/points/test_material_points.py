"""Material points as a host's author meets them: against runs, cut steps, bad points, bytes, clones."""

import copy
import pickle

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm

MATERIAL = cm.Material(reference_size=2.0)
SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100, 70, 20, 0], unit="mm")
GRID = cm.fitting_grid(SAND, MATERIAL, 100.0, bins=48)
CYCLES = (50.0, 5.0, 50.0, 5.0, 50.0)
KINDS = [("states", "float64"), ("gradings", "float64"), ("states", "float32"), ("gradings", "float32")]
pytestmark = pytest.mark.filterwarnings("ignore::comminute.ResolutionWarning")  # of the runs on so few bins
ROUNDING = {"float64": 1e-14, "float32": 3e-7}


def points_of(
    count: int = 3, keep: str = "states", dtype: str = "float64", grid: cm.LogGrid = GRID
) -> cm.MaterialPoints:
    return cm.MaterialPoints(MATERIAL, SAND, count, grid, dtype=dtype, keep=keep)  # type: ignore[arg-type]


@pytest.mark.parametrize(("keep", "dtype"), KINDS)
@pytest.mark.parametrize("bins", [58, 108, 502])
def test_unloading_and_reloading_give_the_run(bins: int, keep: str, dtype: str) -> None:
    grid = cm.fitting_grid(SAND, MATERIAL, 100.0, bins=bins)
    loads = np.array([10.0, *CYCLES, 80.0])
    run = cm.Simulation(MATERIAL, SAND, grid=grid).run(stress_ratio=loads, keep_fabrics=())
    points = points_of(2, keep, dtype, grid)
    crushes = 0.0
    for k, load in enumerate(loads):
        assert not points.update([load, 0.3]).any()
        np.testing.assert_allclose(points.gradings()[0], run.pmf[k], rtol=0.0, atol=ROUNDING[dtype])
        crushes += float(points.crushed[0])
        assert crushes == pytest.approx(run.crushes[k], abs=1e-6 if dtype == "float32" else 1e-13)
        assert points.settled_at.tolist() == [loads[: k + 1].max(), 0.3]
        assert points.shares_start(1)
    assert points.curve(0).percentile(50) == pytest.approx(run.curve(-1).percentile(50), rel=1e-6)


@pytest.mark.parametrize(("keep", "dtype"), KINDS)
def test_mixing_between_cycles_gives_the_run(keep: str, dtype: str) -> None:
    run = cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=CYCLES, remix_after=[1, 3], keep_fabrics=())
    points = points_of(1, keep, dtype)
    for k, load in enumerate(CYCLES):
        points.update(load, remix=k in (2, 4))
        np.testing.assert_allclose(points.gradings()[0], run.pmf[k], rtol=0.0, atol=ROUNDING[dtype])
    assert points.crushed[0] > 0.0


def test_points_that_keep_gradings_are_runs_to_the_bit() -> None:
    run = cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=CYCLES, remix_after=[2], keep_fabrics=())
    points = points_of(1, "gradings")
    for k, load in enumerate(CYCLES):
        points.update(load, remix=k == 3)
        np.testing.assert_array_equal(points.gradings()[0], run.pmf[k])


@pytest.mark.parametrize("keep", ["states", "gradings"])
def test_a_loading_rate_is_that_of_the_run(keep: str) -> None:
    run = cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=[20.0, 60.0], loading_rate=0.3, keep_fabrics=())
    points = points_of(2, keep)
    for k, load in enumerate((20.0, 60.0)):
        points.update(load, loading_rate=[0.3, 0.0])
        np.testing.assert_allclose(points.gradings()[0], run.pmf[k], rtol=0.0, atol=1e-14)
    assert np.abs(points.gradings()[1] - run.pmf[1]).max() > 1e-4


Steps = list[tuple[list[float], list[bool]]]


@st.composite
def steps(draw: st.DrawFn, count: int = 4) -> Steps:
    load = st.one_of(st.floats(0.0, 300.0), st.sampled_from([0.0, 1.0, 50.0]))
    loads = st.lists(load, min_size=count, max_size=count)
    remix = st.lists(st.booleans(), min_size=count, max_size=count)
    return draw(st.lists(st.tuples(loads, remix), min_size=1, max_size=4))


@settings(max_examples=40, deadline=None)
@given(path=steps(), kind=st.sampled_from(KINDS))
def test_mass_is_kept_and_the_largest_load_remembered(path: Steps, kind: tuple[str, str]) -> None:
    points = points_of(4, *kind)
    settled = np.zeros(4)
    for loads, remix in path:
        before = points.pack()
        points.trial(loads, remix)
        assert points.pack() == before
        points.commit()
        settled = np.maximum(np.where(remix, 0.0, settled), loads)
        np.testing.assert_array_equal(points.settled_at, settled)
        gradings = points.gradings()
        np.testing.assert_allclose(gradings.sum(axis=1), 1.0, rtol=0.0, atol=1e-14)
        assert gradings.min() >= 0.0
        assert (points.crushed >= 0.0).all()


@settings(max_examples=30, deadline=None)
@given(loads=st.lists(st.floats(0.0, 300.0), min_size=2, max_size=5), kind=st.sampled_from(KINDS[:2]))
def test_the_order_of_loads_does_not_matter(loads: list[float], kind: tuple[str, str]) -> None:
    one, other = points_of(1, *kind), points_of(1, *kind)
    for load in loads:
        one.update(load)
    other.update(max(loads))
    np.testing.assert_allclose(one.gradings(), other.gradings(), rtol=0.0, atol=1e-14)


def test_gradings_alone_are_those_of_states_but_for_rounding() -> None:
    rng = np.random.default_rng(5)
    states, gradings = points_of(20), points_of(20, "gradings")
    for _ in range(6):
        loads, remix = rng.uniform(0.0, 200.0, 20), rng.random(20) < 0.3
        for points in (states, gradings):
            points.update(loads, remix)
        np.testing.assert_allclose(states.gradings(), gradings.gradings(), rtol=0.0, atol=1e-14)
        for i in (0, 7):
            a, b = states.fabric(i), gradings.fabric(i)
            np.testing.assert_allclose(a.probability, b.probability, rtol=0.0, atol=1e-14)
            assert (a.settled_at, a.largest, a.mean) == (b.settled_at, b.largest, b.mean)
    assert gradings.nbytes < states.nbytes / 10


def test_threads_and_company_change_no_bit() -> None:
    rng = np.random.default_rng(1)
    one, many, alone = points_of(300), points_of(300), points_of(1)
    for _ in range(3):
        loads = rng.uniform(0.0, 200.0, 300)
        one.update(loads)
        many.update(loads, threads=4)
        alone.update(loads[123])
    assert one == many
    np.testing.assert_array_equal(one.gradings()[123], alone.gradings()[0])


def test_a_bad_point_is_told_and_spoils_no_other() -> None:
    points, good = points_of(), points_of()
    status = points.update([np.nan, 20.0, -2.0])
    assert status.tolist() == [1, 0, 1]
    assert status.dtype == np.uint8
    good.update([0.0, 20.0, 0.0])
    assert points == good
    assert points.message(0) == "stress_ratio[0] is nan; it must be a number of at least 0 (0 is no load)"
    assert points.message(1) == ""
    assert points.update(30.0, loading_rate=[0.0, 2.0, 0.0]).tolist() == [0, 2, 0]
    assert points.message(1) == "loading_rate[1] is 2; it must be between 0 and 1"


@pytest.mark.parametrize(("keep", "dtype"), KINDS)
def test_points_go_on_where_they_were_packed(keep: str, dtype: str) -> None:
    points = points_of(3, keep, dtype)
    points.update([0.4, 20.0, 50.0])
    again = [
        cm.MaterialPoints.unpack(points.pack(), "mm"),
        pickle.loads(pickle.dumps(points)),
        copy.copy(points),
        copy.deepcopy(points),
        points.copy(),
    ]
    for other in again:
        assert other == points
        assert (other.unit, other.dtype, other.keep, len(other)) == ("mm", dtype, keep, 3)
        assert (other.grid, other.material, other.scheme) == (points.grid, points.material, points.scheme)
    points.update([80.0, 20.0, 10.0], [True, False, True])
    for other in again:
        assert other != points
        other.update([80.0, 20.0, 10.0], [True, False, True])
        assert other.pack() == points.pack()
    elsewhere = points_of(1, keep, dtype)
    elsewhere.unpack_point(0, points.pack_point(1))
    np.testing.assert_array_equal(elsewhere.gradings()[0], points.gradings()[1])


def test_merged_points_have_the_mass_of_both() -> None:
    for keep in ("states", "gradings"):
        points = points_of(3, keep)
        points.update([10.0, 100.0, 0.2])
        before = points.gradings()
        points.merge(0, 1, (1.0, 3.0))
        np.testing.assert_allclose(points.gradings()[0], 0.25 * before[0] + 0.75 * before[1], rtol=0.0, atol=1e-15)
        assert points.settled_at.tolist() == [10.0 if keep == "states" else 0.0, 100.0, 0.2]
        points.merge(2, 1, (0.0, 1.0), settled_at="never")
        np.testing.assert_allclose(points.gradings()[2], before[1], rtol=0.0, atol=1e-15)
        assert points.settled_at[2] == 0.0


def test_a_merged_point_that_was_at_rest_crushes_a_little_again() -> None:
    # The choice of the smaller load has a price: mass in cells that the larger zone's edge cuts is tested again.
    points = points_of(2)
    points.update([60.0, 100.0])
    points.merge(0, 1, (0.0, 1.0))
    assert points.settled_at[0] == 60.0
    points.update(100.0)
    again = points.crushed[0]
    points = points_of(2)
    points.update([60.0, 100.0])
    fresh = points.crushed[0]
    assert 0.0 < again < 0.2 * fresh


Call = tuple[str, type[Exception], object]


@pytest.mark.parametrize(
    ("message", "call"),
    [
        ("count is 0; it must be at least 1", lambda: points_of(0)),
        ('dtype is "float16"', lambda: points_of(1, dtype="float16")),
        ('keep is "marginals"', lambda: points_of(1, keep="marginals")),
        ("largest is 0; it must be greater than 0", lambda: cm.MaterialPoints(MATERIAL, SAND, 1, largest=0.0)),
        ("threads is 0; it must be at least 1", lambda: points_of().update(1.0, threads=0)),
        ("stress_ratio has shape (2,)", lambda: points_of().update([1.0, 2.0])),
        ("i is 3; it must be an index of a point", lambda: points_of().message(3)),
        ("i is 3; it must be an index of a point", lambda: points_of().fabric(3)),
        ("j is 1; it must be another point than i", lambda: points_of().merge(1, 1, (1.0, 1.0))),
        ('settled_at is "larger"', lambda: points_of().merge(0, 1, (1.0, 1.0), settled_at="larger")),  # type: ignore[arg-type]
        ("bytes are no set of material points", lambda: cm.MaterialPoints.unpack(b"points? no, and long enough")),
        ("start has been loaded", lambda: cm.MaterialPoints(MATERIAL, loaded(), 1, keep="gradings")),
    ],
)
def test_what_is_refused_says_why(message: str, call: object) -> None:
    with pytest.raises((cm.ParameterError, cm.ShapeError)) as caught:
        call()  # type: ignore[operator]
    assert message.replace('"', "'") in str(caught.value).replace('"', "'")


def loaded() -> cm.Fabric:
    return cm.QuasiStatic(GRID, MATERIAL).solve(cm.mixed_fabric(SAND, GRID), 10.0)


def test_points_may_start_from_a_fabric_that_was_loaded() -> None:
    points = cm.MaterialPoints(MATERIAL, loaded(), 2)
    assert points.settled_at.tolist() == [10.0, 10.0]
    points.update([5.0, 40.0])
    assert points.shares_start(0)
    expected: npt.NDArray[np.float64] = cm.QuasiStatic(GRID, MATERIAL).solve(loaded(), 40.0).grainsize()
    np.testing.assert_allclose(points.gradings()[1], expected, rtol=0.0, atol=1e-15)


def test_exact_sizes_go_into_bins() -> None:
    start = cm.mixed_fabric(cm.gap_graded(2.0, 0.2), GRID)
    points = cm.MaterialPoints(MATERIAL, start, 1)
    points.update(30.0)
    run = cm.QuasiStatic(GRID, MATERIAL).solve(start.binned(), 30.0)
    np.testing.assert_allclose(points.gradings()[0], run.grainsize(), rtol=0.0, atol=1e-15)

"""Laws that every engine obeys: mass, positivity, fining, rest, and what the order of loads may not change."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm
from reference import Array
from strategies import Case, cases


def engine_of(case: Case) -> cm.FullConvolution | cm.SlowUpdate:
    if case.kind == "slow" and case.rule == "conservative":
        return cm.SlowUpdate(case.grid, case.material, scheme=case.rule)
    return cm.FullConvolution(case.grid, case.material, case.kind, loading_rate=case.loading_rate, scheme=case.rule)


def means(p: Array, psi: Array) -> tuple[float, float]:
    return float(p.sum(axis=1) @ psi), float(p.sum(axis=0) @ psi)


@given(case=cases(), steps=st.integers(1, 60))
def test_mass_is_kept_nothing_is_negative_and_grains_only_get_finer(case: Case, steps: int) -> None:
    engine = engine_of(case)
    p = case.p.copy()
    before = means(p, case.psi)
    rng = np.random.default_rng(steps)
    for load in case.stress_ratio * rng.uniform(0.2, 1.0, steps):
        engine.step(p, float(load), out=p)
        after = means(p, case.psi)
        assert after[0] <= before[0] + 1e-13
        assert after[1] <= before[1] + 1e-13
        before = after
    assert math.fsum(p.ravel()) == pytest.approx(2.0, abs=2e-13)
    assert p.min() >= 0.0  # the full convolution cleans its noise, the slow update makes none


@given(case=cases(max_bins=60))
def test_full_convolution_and_slow_update_agree_over_a_load_path(case: Case) -> None:
    update = cm.SlowUpdate(case.grid, case.material, scheme=case.rule)
    convolution = cm.FullConvolution(case.grid, case.material, scheme=case.rule, path="transforms")
    p, q = case.p.copy(), case.p.copy()
    for load in np.geomspace(0.1, 1.0, 12) * case.stress_ratio:
        update.step(p, load, out=p)
        convolution.step(q, load, out=q)
        np.testing.assert_allclose(p, q, rtol=0.0, atol=1e-13)
        assert update.report.crushed == pytest.approx(convolution.report.crushed, abs=1e-13)


@settings(max_examples=20)
@given(case=cases(max_bins=60), share=st.floats(0.0, 1.0))
def test_a_settled_state_forgets_the_steps_that_led_to_it(case: Case, share: float) -> None:
    """Slow, fast and blend: many loads and one load end in the same state (rest tolerance 1e-18)."""
    rate = share if case.kind == "blend" else 0.0
    kind = "slow" if case.kind == "exact" else case.kind
    engine = cm.FullConvolution(case.grid, case.material, kind, loading_rate=rate, scheme=case.rule)
    p = case.p.copy()
    for load in np.geomspace(0.05, 1.0, 15) * case.stress_ratio:
        engine.settle(p, load, out=p)
    np.testing.assert_allclose(p, engine.settle(case.p, case.stress_ratio), rtol=0.0, atol=1e-13)


def test_the_exact_kernel_does_remember_the_steps() -> None:
    grid, material = cm.LogGrid(-12.0, 0.0, 121), cm.Material()
    start = cm.mixed_fabric(cm.power_law(2.5, 0.05, 1.0), grid).probability
    engine = cm.FullConvolution(grid, material, "exact", scheme="paper")
    many = start.copy()
    for load in np.geomspace(0.05, 1.0, 60) * 1e4:
        engine.settle(many, load, out=many)
    one = engine.settle(start, 1e4)
    assert np.abs(np.cumsum((many - one).sum(axis=1))).max() > 1e-3


@given(case=cases())
def test_a_settled_state_is_at_rest(case: Case) -> None:
    engine = cm.SlowUpdate(case.grid, case.material, scheme=case.rule)
    p = engine.settle(case.p, case.stress_ratio)
    active = cm.crush_zones(case.grid, case.material, case.stress_ratio) > 0
    assert p[active].sum() <= 2e-18
    again = engine.step(p, 0.5 * case.stress_ratio)
    np.testing.assert_allclose(again[~active], p[~active], rtol=0.0, atol=2e-18)  # what is left in the zone, at most


def test_in_place_and_out_of_place_are_the_same_to_the_bit() -> None:
    grid, material = cm.LogGrid(-6.0, 0.5, 64), cm.Material(fabric_width=0.3)
    p = np.random.default_rng(1).dirichlet(np.ones(64 * 64)).reshape(64, 64)
    kept = p.copy()
    for engine in (
        cm.SlowUpdate(grid, material, scheme="paper"),
        cm.FullConvolution(grid, material, "exact", scheme="paper"),
    ):
        out = engine.step(p, 30.0)
        np.testing.assert_array_equal(p, kept)
        target = np.full_like(p, np.nan)
        assert engine.step(p, 30.0, out=target) is target
        in_place = p.copy()
        assert engine.step(in_place, 30.0, out=in_place) is in_place
        np.testing.assert_array_equal(out, target)
        np.testing.assert_array_equal(out, in_place)


@given(
    bins=st.integers(8, 80),
    mean=st.sampled_from(["arithmetic", "geometric"]),
    dimension=st.floats(1.0, 3.5),
    gap=st.booleans(),
)
def test_remixing_a_mixed_fabric_changes_nothing(bins: int, mean: str, dimension: float, gap: bool) -> None:
    grid = cm.LogGrid(-7.0, 0.1, bins)
    grading = cm.gap_graded(1.0, 0.07, 0.3) if gap else cm.power_law(dimension, 0.01, 1.0)
    fabric = cm.mixed_fabric(grading, grid, mean=mean)  # type: ignore[arg-type]
    assert cm.remix(fabric) == fabric
    assert fabric.settled_at is None


def test_remixing_keeps_the_sizes_and_forgets_the_load() -> None:
    sim = cm.Simulation(cm.Material(), cm.power_law(2.5, 1e-2, 1.0))
    crushed = sim.run(stress_ratio=100.0).fabric(0)
    again = cm.remix(crushed)
    np.testing.assert_array_equal(again.grainsize(), crushed.grainsize())
    assert crushed.settled_at == 100.0
    assert again.settled_at is None
    sizes = again.grid.sizes
    assert again.neighbourhood() @ sizes == pytest.approx(again.grainsize() @ sizes, rel=1e-14)

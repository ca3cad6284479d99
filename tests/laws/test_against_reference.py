"""Every number of the core against the NumPy reference, which is written from the equations alone."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm
import reference as ref
from reference import HAND_CASE, Kind
from strategies import Case, cases, laws, log_uniform

KINDS: tuple[Kind, ...] = ("exact", "slow", "fast", "blend")


@given(case=cases(), path=st.sampled_from(["automatic", "transforms"]))
def test_full_convolution_agrees_with_the_reference(case: Case, path: Literal["automatic", "transforms"]) -> None:
    engine = cm.FullConvolution(
        case.grid, case.material, case.kind, loading_rate=case.loading_rate, scheme=case.rule, path=path
    )
    expected = ref.step(case.p, case.psi, case.model, case.stress_ratio, case.kind, case.loading_rate, case.rule)
    np.testing.assert_allclose(engine.step(case.p, case.stress_ratio), expected, rtol=0.0, atol=1e-13)


@given(case=cases())
def test_slow_update_agrees_with_the_reference(case: Case) -> None:
    engine = cm.SlowUpdate(case.grid, case.material, scheme=case.rule)
    expected = ref.step(case.p, case.psi, case.model, case.stress_ratio, "slow", 0.0, case.rule)
    np.testing.assert_allclose(engine.step(case.p, case.stress_ratio), expected, rtol=0.0, atol=1e-13)


@given(case=cases(max_bins=40), cell=st.tuples(st.floats(0.0, 0.999), st.floats(0.0, 0.999)))
def test_cell_kernel_agrees_with_the_reference(case: Case, cell: tuple[float, float]) -> None:
    i, j = (int(place * case.grid.bins) for place in cell)
    kernel = cm.cell_kernel(
        case.grid,
        case.material,
        case.stress_ratio,
        i,
        j,
        case.kind,
        loading_rate=case.loading_rate,
        scheme=case.rule,
    )
    expected = ref.cell_kernel(case.psi, case.model, case.stress_ratio, i, j, case.kind, case.loading_rate, case.rule)
    np.testing.assert_allclose(kernel, expected, rtol=0.0, atol=1e-14)


@given(case=cases())
def test_zones_agree_with_the_reference(case: Case) -> None:
    found = cm.crush_zones(case.grid, case.material, case.stress_ratio)
    np.testing.assert_array_equal(found, ref.zones(case.psi, case.model, case.stress_ratio))


@settings(max_examples=20)
@given(case=cases(max_bins=40))
def test_active_share_agrees_with_brute_force_integration(case: Case) -> None:
    found = cm.active_share(case.grid, case.material, case.stress_ratio)
    expected = ref.active_share(case.psi, case.model, case.stress_ratio)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-7)  # the midpoint rule's own error


@given(law=laws(), spacing=log_uniform(1e-3, 1.5), bins=st.integers(8, 300))
def test_fragment_pmf_agrees_with_the_reference(
    law: tuple[cm.WeibullFragments, ref.Law], spacing: float, bins: int
) -> None:
    ours, theirs = law
    for rule in ("paper", "conservative"):
        found = cm.fragment_pmf(ours, spacing, bins, rule)
        np.testing.assert_allclose(found, ref.fragment_pmf(theirs, spacing, bins, rule), rtol=0.0, atol=2e-15)


@given(
    bins=st.integers(8, 96),
    bottom=st.floats(-9.0, -1.0),
    seed=st.integers(0, 2**32 - 1),
    mean=st.sampled_from(["arithmetic", "geometric"]),
)
def test_mixed_state_agrees_with_the_reference(bins: int, bottom: float, seed: int, mean: ref.Mean) -> None:
    grid, psi = cm.LogGrid(bottom, 0.5, bins), ref.centres(bottom, 0.5, bins)
    pmf = np.random.default_rng(seed).dirichlet(np.full(bins, 0.3))
    found = cm.neighbourhood_pmf(grid, pmf, mean=mean)
    np.testing.assert_allclose(found, ref.neighbour_pmf(pmf, psi, mean), rtol=0.0, atol=1e-14)
    fabric = cm.Fabric(grid, np.outer(pmf, np.eye(bins)[-1]), mean=mean)
    np.testing.assert_allclose(cm.remix(fabric).probability, ref.mixed(pmf, psi, mean), rtol=0.0, atol=1e-14)


@given(dimension=st.floats(0.5, 4.0), smallest=log_uniform(1e-3, 0.2), bins=st.integers(8, 200))
def test_power_law_grading_agrees_with_the_reference(dimension: float, smallest: float, bins: int) -> None:
    grid, psi = cm.LogGrid(-6.0, 0.1, bins), ref.centres(-6.0, 0.1, bins)
    found = cm.power_law(dimension, smallest, 1.0).on_grid(grid)
    np.testing.assert_allclose(found, ref.power_law_pmf(psi, dimension, smallest, 1.0), rtol=0.0, atol=1e-12)


@given(seed=st.integers(0, 2**32 - 1), points=st.integers(2, 12), bins=st.integers(8, 200))
def test_sieve_grading_agrees_with_the_reference(seed: int, points: int, bins: int) -> None:
    rng = np.random.default_rng(seed)
    size = np.sort(np.exp(rng.uniform(-5.0, 0.0, points)))
    finer = np.cumsum(rng.exponential(size=points) + 0.05)
    finer = np.append(finer[:-1] / finer[-1], 1.0)
    grid, psi = cm.LogGrid(-8.0, 0.1, bins), ref.centres(-8.0, 0.1, bins)
    order = rng.permutation(points)
    grading = cm.Grading.from_sieves(size[order].tolist(), (100 * finer[order]).tolist())
    np.testing.assert_allclose(grading.on_grid(grid), ref.sieve_pmf(psi, size, finer), rtol=0.0, atol=1e-13)


@given(seed=st.integers(0, 2**32 - 1), bins=st.integers(8, 100), percent=st.floats(1.0, 99.0))
def test_percentile_agrees_with_the_reference(seed: int, bins: int, percent: float) -> None:
    grid = cm.LogGrid(-4.0, 0.5, bins)
    pmf = np.append(0.0, np.random.default_rng(seed).dirichlet(np.ones(bins - 1)))
    cdf = np.cumsum(pmf)
    expected = ref.percentile(cdf, grid.edges[1:], percent)
    assert cm.percentile(grid, cdf, percent) == pytest.approx(expected, rel=1e-9)


def hand_case_on_eight_bins() -> tuple[cm.LogGrid, cm.Material, ref.Array]:
    """Return the hand case as the lowest four of eight bins; what happens there never involves the others."""
    model = HAND_CASE.model
    assert isinstance(model.law, ref.PowerLaw)
    material = cm.Material(
        weibull_modulus=model.weibull_modulus,
        fabric_width=model.fabric_width,
        reference_size=model.reference_size,
        fragments=cm.PowerLawFragments(model.law.exponent),
    )
    p = np.zeros((8, 8))
    p[:4, :4] = HAND_CASE.p
    return cm.LogGrid(-3.0, 4.0, 8), material, p


def test_zones_of_the_hand_case() -> None:
    grid, material, _ = hand_case_on_eight_bins()
    zones = cm.crush_zones(grid, material, HAND_CASE.stress_ratio)
    np.testing.assert_array_equal(zones[:4, :4], HAND_CASE.zones)


@pytest.mark.parametrize("kind", KINDS)
def test_step_of_the_hand_case(kind: Kind) -> None:
    grid, material, p = hand_case_on_eight_bins()
    rate = HAND_CASE.loading_rate if kind == "blend" else 0.0
    after = cm.FullConvolution(grid, material, kind, loading_rate=rate, scheme="paper").step(p, HAND_CASE.stress_ratio)
    np.testing.assert_allclose(after[:4, :4], getattr(HAND_CASE, kind), rtol=0.0, atol=1e-15)
    assert after[4:, :].sum() + after[:, 4:].sum() == 0.0


def test_slow_update_of_the_hand_case() -> None:
    grid, material, p = hand_case_on_eight_bins()
    after = cm.SlowUpdate(grid, material, scheme="paper").step(p, HAND_CASE.stress_ratio)
    np.testing.assert_allclose(after[:4, :4], HAND_CASE.slow, rtol=0.0, atol=1e-15)

"""Checks of the reference against hand work, closed forms and other routes to the same number."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import get_args

import numpy as np
import pytest

import reference as ref
from reference import HAND_CASE, Array, Kind, Law, Mean, Model, PowerLaw, Rule, Weibull

KINDS: tuple[Kind, ...] = get_args(Kind)
RULES: tuple[Rule, ...] = get_args(Rule)
MEANS: tuple[Mean, ...] = get_args(Mean)
LAWS: list[Law] = [
    Weibull(),
    Weibull(0.4, 1.7),
    Weibull(0.1, 4.0),
    Weibull(3.0, 0.6),
    PowerLaw(),
    PowerLaw(0.3),
    PowerLaw(2.5),
]
MODELS = [
    Model(),
    Model(6.0, 0.3, 2.0),
    Model(2.0, 2.0, 0.5),
    Model(1.0, 20.0, 1.0),
    Model(3.0, math.inf, 1.0),
]


def integral(function: Callable[[Array], Array], edges: Array) -> float:
    """Gauss quadrature of a function over the panels between edges."""
    node, weight = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)
    return math.fsum(float(h * (weight @ function(a + h * (1.0 + node)))) for a, h in zip(edges, half, strict=False))


def grainsize(p: Array, psi: Array) -> float:
    """Mean size of a pmf whose bins are points at their centres."""
    return float(p @ np.exp(psi))


# --- fragments ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("scale", "shape"), [(1.0, 1.0), (0.4, 1.7), (0.1, 4.0), (3.0, 0.6), (50.0, 2.0)])
def test_weibull_cdf_is_the_integral_of_eq_3(scale: float, shape: float) -> None:
    def density(x: Array) -> Array:
        u = x / scale
        norm = 1.0 - math.exp(-(scale**-shape))
        return np.asarray(shape / scale * u ** (shape - 1.0) * np.exp(-(u**shape)) / norm)

    law = Weibull(scale, shape)
    r = np.array([-7.0, -3.0, -1.0, -0.2, -0.01, 0.0])
    # Panels shrinking towards x = 0, where the density of shape < 1 is singular.
    panels = np.concatenate([[0.0], np.exp(np.linspace(-80.0, 0.0, 801))])
    found = [integral(density, math.exp(at) * panels) for at in r]
    np.testing.assert_allclose(law.cdf(r), found, rtol=2e-12, atol=0.0)
    np.testing.assert_allclose(law.pdf(r), np.exp(r) * density(np.exp(r)), rtol=2e-12)


def test_truncated_exponential_is_eq_4_and_has_its_moments() -> None:
    r = np.linspace(-8.0, 0.0, 33)
    np.testing.assert_allclose(Weibull().pdf(r), np.exp(r - np.exp(r)) / (1.0 - math.exp(-1.0)), rtol=1e-14)
    edges = np.linspace(-60.0, 0.0, 601)
    mean = integral(lambda r: r * Weibull().pdf(r), edges)
    assert mean == pytest.approx(-1.2602020108, abs=1e-10)
    variance = integral(lambda r: (r - mean) ** 2 * Weibull().pdf(r), edges)
    assert variance == pytest.approx(1.2316466670, abs=1e-10)


@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("spacing", [0.01, 0.2, 1.0])
def test_fragment_masses_follow_from_the_cdf(law: Law, spacing: float) -> None:
    bins = 40
    edge: Array = np.asarray(-spacing * np.arange(bins + 1), dtype=np.float64)
    paper = ref.fragment_pmf(law, spacing, bins, "paper")
    assert paper[0] == 0.0
    np.testing.assert_allclose(paper[1:], law.cdf(edge[:-2]) - law.cdf(edge[1:-1]), rtol=0.0, atol=2e-15)
    assert paper.sum() + law.cdf(edge[bins - 1 : bins])[0] == pytest.approx(1.0, abs=4e-15)

    # Integrated by parts, f_m is a difference of bin means of the cdf, and so is all that is left out.
    mean = [integral(law.cdf, np.linspace(low, high, 9)) / (high - low) for high, low in pairwise(edge)]
    conservative = ref.fragment_pmf(law, spacing, bins, "conservative")
    np.testing.assert_allclose(conservative, -np.diff(mean, prepend=1.0), rtol=0.0, atol=2e-15)
    assert conservative.sum() + mean[-1] == pytest.approx(1.0, abs=4e-15)
    assert (paper >= 0.0).all()
    assert (conservative >= 0.0).all()


@pytest.mark.parametrize("exponent", [0.3, 1.0, 2.5])
def test_fragment_masses_of_a_power_law_in_closed_form(exponent: float) -> None:
    spacing, m = 0.07, np.arange(1, 60)
    decay, a = np.exp(-exponent * spacing * m), exponent * spacing
    law = PowerLaw(exponent)
    np.testing.assert_allclose(ref.fragment_pmf(law, spacing, 60, "paper")[1:], decay * math.expm1(a), rtol=2e-14)
    conservative = ref.fragment_pmf(law, spacing, 60, "conservative")
    np.testing.assert_allclose(conservative[1:], decay * 4.0 * math.sinh(a / 2) ** 2 / a, rtol=2e-14)
    assert conservative[0] == pytest.approx(1.0 + math.expm1(-a) / a, abs=2e-15)


def test_mean_reduction_is_kept_by_the_conservative_rule_and_biased_by_the_paper_rule() -> None:
    spacing, bins = 0.05, 1200
    moved = spacing * np.arange(bins)
    assert moved @ ref.fragment_pmf(Weibull(), spacing, bins, "conservative") == pytest.approx(1.2602020108, abs=1e-10)
    bias = moved @ ref.fragment_pmf(Weibull(), spacing, bins, "paper") - 1.2602020108
    assert bias == pytest.approx(spacing / 2, rel=0.02)


def test_unknown_names_and_loads_are_refused() -> None:
    with pytest.raises(ValueError, match="rule"):
        ref.fragment_pmf(Weibull(), 0.1, 5, "exact")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="kernel"):
        ref.shares(HAND_CASE.zones, "paper", 0.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="mean"):
        ref.neighbour_pmf(np.ones(3) / 3, HAND_CASE.psi[:3], "harmonic")  # type: ignore[arg-type]
    for load in (-1.0, math.nan):
        with pytest.raises(ValueError, match="stress ratio"):
            ref.zones(HAND_CASE.psi, Model(), load)


# --- crush zones --------------------------------------------------------------------------------------------


def critical_ratio(size: float, neighbour: float, model: Model) -> float:
    """Stress ratio at which a grain crushes, Eq. (2)."""
    shielding = math.log(size / neighbour) ** 2 / (2.0 * model.fabric_width**2)
    if shielding > 700.0:
        return math.inf
    return float((size / model.reference_size) ** (-3.0 / model.weibull_modulus) * math.exp(shielding))


def test_zones_of_the_hand_case() -> None:
    found = ref.zones(HAND_CASE.psi, HAND_CASE.model, HAND_CASE.stress_ratio)
    assert found.dtype == np.uint8
    np.testing.assert_array_equal(found, HAND_CASE.zones)


@pytest.mark.parametrize("model", MODELS, ids=repr)
@pytest.mark.parametrize("stress_ratio", [0.3, 1.7, 40.0, 1e4])
def test_zones_follow_eq_2_are_symmetric_and_crush_the_larger_first(model: Model, stress_ratio: float) -> None:
    psi = ref.centres(-5.03, 1.01, 41)
    zone = ref.zones(psi, model, stress_ratio)
    expected = [
        [
            2 * (stress_ratio >= critical_ratio(s, t, model)) + (stress_ratio >= critical_ratio(t, s, model))
            for t in np.exp(psi)
        ]
        for s in np.exp(psi)
    ]
    expected[0][0] = 0
    np.testing.assert_array_equal(zone, expected)
    np.testing.assert_array_equal(zone.T, np.array([0, 2, 1, 3], dtype=np.uint8)[zone])
    assert not np.tril(zone == 1).any()
    assert not np.triu(zone == 2).any()


def test_zones_grow_with_the_load_and_vanish_without_it() -> None:
    psi = ref.centres(-6.0, 1.0, 50)
    loads = [0.0, 0.4, 1.0, 2.0, 30.0, 1e4, 1e12]
    active = [ref.zones(psi, Model(), load) > 0 for load in loads]
    assert not active[0].any()
    for before, after in pairwise(active):
        assert (before <= after).all()
        assert (before < after).any()
    assert not active[-1][0, 0]


def test_zones_do_not_depend_on_the_unit_of_size() -> None:
    psi = ref.centres(-4.0, 1.0, 37)
    for load in (0.5, 7.3, 900.0):
        metres = ref.zones(psi, Model(5.0, 0.2, 1.3), load)
        millimetres = ref.zones(psi + math.log(1000.0), Model(5.0, 0.2, 1300.0), load)
        np.testing.assert_array_equal(metres, millimetres)


def test_zones_are_closed_whatever_the_rounding_of_the_bin_centres() -> None:
    for bins in range(8, 700, 23):
        psi = ref.centres(-6.0, 1.0, bins)
        for i in {1, bins // 3, bins - 1}:
            at_rest = Model(reference_size=math.exp(psi[i]))
            assert ref.zones(psi, at_rest, 1.0)[i, i] == 3
            for n in (0.005, 0.05, 1.0):
                # A neighbour d bins smaller, with the gap written without the rounding of the two centres.
                for d in {1, i}:
                    critical = (d * 7.0 / (bins - 1)) ** 2 / (2.0 * n**2)
                    if critical < 700.0:
                        model = Model(fabric_width=n, reference_size=math.exp(psi[i]))
                        assert ref.zones(psi, model, math.exp(critical))[i, i - d] == (2 if d else 3)


def test_without_fabric_size_alone_decides() -> None:
    psi, model = ref.centres(-5.0, 0.0, 21), Model(6.0, math.inf, 1.0)
    large = psi >= -2.1  # least size at sigma = e^1.05 is e^(-1.05 w/3)
    expected = 2 * large[:, None] + large[None, :]
    np.testing.assert_array_equal(ref.zones(psi, model, math.exp(1.05)), expected)


def share_by_count(psi: Array, model: Model, stress_ratio: float, i: int, j: int, points: int) -> float:
    """Share of a lattice of points in cell (i, j) at which one of the two grains crushes, Eq. (15)."""
    place = (psi[1] - psi[0]) * ((np.arange(points) + 0.5) / points - 0.5)
    x, y = (psi[i] + place)[:, None], (psi[j] + place)[None, :]
    larger = np.maximum(x, y) - math.log(model.reference_size)
    resistance = (x - y) ** 2 / (2.0 * model.fabric_width**2) - 3.0 / model.weibull_modulus * larger
    return float(np.mean(math.log(stress_ratio) >= resistance))


def share_over_gap(psi: Array, model: Model, stress_ratio: float, i: int, j: int) -> float:
    """Active share of cell (i, j), i >= j, integrated over the gap u between the grains."""
    spacing = float(psi[1] - psi[0])
    xlo, ylo = float(psi[i]) - spacing / 2, float(psi[j]) - spacing / 2
    bend = model.weibull_modulus / (6.0 * model.fabric_width**2)  # 1/k
    base = math.log(model.reference_size) - model.weibull_modulus / 3.0 * math.log(stress_ratio)

    def length(u: Array) -> Array:
        low = np.maximum(np.maximum(xlo, ylo + u), base + bend * u**2)
        return np.asarray(np.maximum(np.minimum(xlo, ylo + u) + spacing - low, 0.0))

    # The length is a piecewise quadratic in u; these are the places where its pieces meet.
    corners = [(k + i - j) * spacing for k in (-1, 0, 1)]
    for slope, edge in ((0.0, xlo), (0.0, xlo + spacing), (1.0, ylo), (1.0, ylo + spacing)):
        root = slope**2 - 4.0 * bend * (base - edge)
        if root > 0.0:
            corners += [(slope - math.sqrt(root)) / (2.0 * bend), (slope + math.sqrt(root)) / (2.0 * bend)]
    lowest = max(corners[0], 0.0)
    edges = np.unique(np.clip(corners, lowest, corners[2]))
    return integral(length, edges) / spacing**2 * (2.0 if i == j else 1.0)


@pytest.mark.parametrize("model", MODELS, ids=repr)
@pytest.mark.parametrize("stress_ratio", [0.9, 3.3, 200.0])
def test_active_share_is_a_count_of_points(model: Model, stress_ratio: float) -> None:
    psi = ref.centres(-2.6, 0.4, 9)
    share = ref.active_share(psi, model, stress_ratio)
    counted = [[share_by_count(psi, model, stress_ratio, i, j, 200) for j in range(len(psi))] for i in range(len(psi))]
    counted[0][0] = 0.0
    np.testing.assert_allclose(share, counted, rtol=0.0, atol=0.01)
    np.testing.assert_array_equal(share, share.T)


@pytest.mark.parametrize("model", [m for m in MODELS if m.fabric_width < math.inf], ids=repr)
@pytest.mark.parametrize("stress_ratio", [0.7, 1.0, 3.3, 200.0, 1e4])
def test_active_share_in_the_other_order_of_integration(model: Model, stress_ratio: float) -> None:
    psi = ref.centres(-3.0, 0.4, 17)
    share = ref.active_share(psi, model, stress_ratio)
    for i in range(1, len(psi)):
        for j in range(i + 1):
            assert share[i, j] == pytest.approx(share_over_gap(psi, model, stress_ratio, i, j), abs=2e-8)


def test_active_share_without_fabric_in_closed_form() -> None:
    psi = ref.centres(-2.0, 0.0, 5)
    least = -1.15  # 0.2 of a bin below the centre of bin 2, that is, 0.3 above its lower edge
    share = ref.active_share(psi, Model(3.0, math.inf, 1.0), math.exp(-least))
    assert share[2, 0] == share[0, 2]
    np.testing.assert_allclose(share[2, :3], [0.8, 0.8, 1.0 - 0.2**2], atol=1e-8)
    np.testing.assert_allclose(share[3], 1.0, atol=1e-12)
    assert not share[:2, :2].any()


@pytest.mark.parametrize("omega", [0.3, 0.9, 1.6, 3.2])
def test_active_share_of_a_narrow_fabric_is_that_of_a_band_of_constant_width(omega: float) -> None:
    # k -> 0 at fixed W = omega h: the gap of two sizes, uniform in their bins, has a triangular density.
    psi, n = ref.centres(-0.1, 0.0, 11), 1e-3
    share = ref.active_share(psi, Model(3.0, n, 1.0), math.exp((0.01 * omega) ** 2 / (2.0 * n**2)))
    assert share[10, 10] == pytest.approx(1.0 - max(1.0 - omega, 0.0) ** 2, abs=2e-4)
    for d in range(1, 6):
        gap = min(max(omega - d, -1.0), 1.0)
        expected = 0.5 * (1.0 + gap) ** 2 if gap < 0.0 else 1.0 - 0.5 * (1.0 - gap) ** 2
        assert share[10, 10 - d] == pytest.approx(expected, abs=2e-4)


def test_active_share_grows_with_the_load() -> None:
    psi = ref.centres(-3.0, 0.5, 29)
    before = np.zeros((29, 29))
    assert not ref.active_share(psi, Model(), 0.0).any()
    for load in (0.2, 0.9, 1.0, 5.0, 1e3, 1e6):
        after = ref.active_share(psi, Model(), load, points=2000)
        assert (after >= before - 1e-12).all()
        assert after.max() <= 1.0 + 1e-12
        assert after[0, 0] == 0.0
        before = after


# --- one step -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_step_of_the_hand_case(kind: Kind) -> None:
    case = HAND_CASE
    expected: Array = getattr(case, kind)
    assert case.p.sum() == pytest.approx(1.0, abs=1e-15)
    assert expected.sum() == pytest.approx(1.0, abs=1e-15)
    found = ref.step(case.p, case.psi, case.model, case.stress_ratio, kind, case.loading_rate)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-15)


def test_shares_of_the_hand_case() -> None:
    zone = HAND_CASE.zones
    for kind in KINDS:
        total = sum(ref.shares(zone, kind, 0.3))
        np.testing.assert_allclose(total, zone > 0, rtol=0.0, atol=1e-15)
    psi_only, psibar_only, both = ref.shares(zone, "slow", 0.3)
    assert (psi_only[2, 1], psibar_only[2, 1], psi_only[1, 2], psibar_only[1, 2]) == (1.0, 0.0, 0.0, 1.0)
    assert psi_only[1, 1] == psibar_only[1, 1] == 0.5
    assert not both.any()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rule", RULES)
def test_step_is_the_sum_of_cell_kernels_that_keep_mass_and_never_grow_a_grain(kind: Kind, rule: Rule) -> None:
    psi, model = ref.centres(-3.0, 0.5, 12), Model(3.0, 0.4, 1.0)
    p = np.random.default_rng(7).random((12, 12))
    total = np.zeros_like(p)
    for i, j in np.ndindex(p.shape):
        kernel = ref.cell_kernel(psi, model, 9.0, i, j, kind, 0.2, rule)
        assert kernel.min() >= 0.0
        assert kernel.sum() == pytest.approx(1.0, abs=1e-15)
        assert not kernel[i + 1 :].any()
        assert not kernel[:, j + 1 :].any()
        total += p[i, j] * kernel
    found = ref.step(p, psi, model, 9.0, kind, 0.2, rule)
    np.testing.assert_allclose(found, total, rtol=1e-14, atol=1e-15)
    assert found.sum() == pytest.approx(p.sum(), rel=1e-14)


@pytest.mark.parametrize(("kind", "stay"), [("exact", 2), ("slow", 1), ("fast", 2)])
def test_one_conservative_step_keeps_the_mass_that_does_not_leave_its_cell(kind: Kind, stay: int) -> None:
    psi, model = ref.centres(-3.0, 0.0, 31), Model()
    f0 = ref.fragment_pmf(model.law, 0.1, 1, "conservative")[0]
    kernel = ref.cell_kernel(psi, model, 50.0, 20, 20, kind, rule="conservative")
    assert kernel[20, 20] == pytest.approx(f0**stay, rel=1e-12)


def test_blend_mixes_the_slow_and_the_fast_step() -> None:
    psi, p = HAND_CASE.psi, HAND_CASE.p
    slow = ref.step(p, psi, HAND_CASE.model, 30.0, "slow")
    fast = ref.step(p, psi, HAND_CASE.model, 30.0, "fast")
    for rate in (0.0, 0.4, 1.0):
        blend = ref.step(p, psi, HAND_CASE.model, 30.0, "blend", rate)
        np.testing.assert_allclose(blend, (1.0 - rate) * slow + rate * fast, rtol=0.0, atol=1e-15)


def test_nothing_moves_without_load() -> None:
    for kind in KINDS:
        found = ref.step(HAND_CASE.p, HAND_CASE.psi, HAND_CASE.model, 0.0, kind, 0.5, "conservative")
        np.testing.assert_array_equal(found, HAND_CASE.p)


def test_when_all_crush_reductions_add_up_to_a_gamma_law() -> None:
    # Uniform X: -psi after t crushes is Gamma(t, 1), of mean and variance t.
    psi = ref.centres(-40.0, 0.0, 81)
    p = np.zeros((81, 81))
    p[-1, -1] = 1.0
    model, steps = Model(law=PowerLaw()), 3
    for _ in range(steps):
        p = ref.step(p, psi, model, math.inf, "exact", rule="conservative")
    marginal = p.sum(axis=1)
    np.testing.assert_allclose(p, np.outer(marginal, p.sum(axis=0)), rtol=0.0, atol=1e-15)
    mean = -(marginal @ psi)
    assert mean == pytest.approx(steps, abs=1e-10)
    # Sharing a reduction between two bins, at place u between them, adds u (1 - u) h^2, on average h^2 / 6.
    assert marginal @ (psi + mean) ** 2 == pytest.approx(steps * (1.0 + 0.25 / 6.0), rel=0.01)


# --- states and gradings ------------------------------------------------------------------------------------


@pytest.mark.parametrize("mean", MEANS)
def test_neighbours_have_the_mean_of_the_grains(mean: Mean) -> None:
    psi = ref.centres(-3.3, 0.7, 48)
    pmf = np.random.default_rng(3).dirichlet(np.ones(48))
    neighbour = ref.neighbour_pmf(pmf, psi, mean)
    assert neighbour.min() >= 0.0
    assert neighbour.sum() == pytest.approx(1.0, abs=1e-14)
    if mean == "arithmetic":
        assert grainsize(neighbour, psi) == pytest.approx(grainsize(pmf, psi), rel=1e-14)
    else:
        assert neighbour @ psi == pytest.approx(pmf @ psi, abs=1e-14)
    state = ref.mixed(pmf, psi, mean)
    np.testing.assert_allclose(state.sum(axis=1), pmf, atol=1e-15)
    np.testing.assert_allclose(state.sum(axis=0), neighbour, atol=1e-15)


def test_neighbours_of_a_gap_graded_pair_by_hand() -> None:
    # Sizes 1, 2, 4, 8 and shares 1/4 of size 1, 3/4 of size 8: means 1 (1/16), 4.5 (6/16), 8 (9/16).
    psi, pmf = np.log([1.0, 2.0, 4.0, 8.0]), np.array([0.25, 0.0, 0.0, 0.75])
    expected = np.array([1.0, 0.0, 6.0 * 7.0 / 8.0, 9.0 + 6.0 / 8.0]) / 16.0
    np.testing.assert_allclose(ref.neighbour_pmf(pmf, psi), expected, rtol=0.0, atol=1e-15)
    # Geometric: sqrt(8) lies half-way between the centres 2 and 4 in psi.
    expected = np.array([1.0, 3.0, 3.0, 9.0]) / 16.0
    np.testing.assert_allclose(ref.neighbour_pmf(pmf, psi, "geometric"), expected, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("mean", MEANS)
def test_equal_grains_are_their_own_neighbours(mean: Mean) -> None:
    psi = ref.centres(-6.0, 1.0, 29)
    for i in range(29):
        pmf = np.eye(29)[i]
        np.testing.assert_array_equal(ref.neighbour_pmf(pmf, psi, mean), pmf)


@pytest.mark.parametrize("dimension", [1.0, 2.5, 3.0, 3.2])
def test_power_law_masses(dimension: float) -> None:
    psi = ref.centres(-4.0, 0.5, 46)
    pmf = ref.power_law_pmf(psi, dimension, 0.01, 1.0)
    assert pmf.sum() == pytest.approx(1.0, abs=1e-15)
    assert pmf.min() >= 0.0
    size = np.clip(np.exp(psi + 0.05), 0.01, 1.0)
    if dimension == 3.0:
        expected = np.log(size / 0.01) / math.log(100.0)
    else:
        b = 3.0 - dimension
        expected = (size**b - 0.01**b) / (1.0 - 0.01**b)
    np.testing.assert_allclose(np.cumsum(pmf), expected, rtol=0.0, atol=1e-14)
    with pytest.raises(ValueError, match="top bin"):
        ref.power_law_pmf(psi, dimension, 0.01, 2.0)


def test_power_law_is_continuous_at_dimension_three() -> None:
    psi = ref.centres(-4.0, 0.5, 46)
    near = ref.power_law_pmf(psi, 3.0 - 1e-9, 0.01, 1.0)
    np.testing.assert_allclose(near, ref.power_law_pmf(psi, 3.0, 0.01, 1.0), rtol=0.0, atol=1e-9)


def test_sieve_masses() -> None:
    psi = ref.centres(-3.5, 1.5, 6)  # upper edges at -3, -2, -1, 0, 1, 2
    size, finer = np.exp([-2.0, 0.0, 1.0]), np.array([0.1, 0.4, 1.0])
    # F rises fourfold over the two units of ln d between the two finest sieves, so it halves one unit below.
    expected = np.diff([0.0, 0.05, 0.1, 0.25, 0.4, 1.0, 1.0])
    np.testing.assert_allclose(ref.sieve_pmf(psi, size, finer), expected, rtol=0.0, atol=1e-15)
    nothing_below = ref.sieve_pmf(psi, size, np.array([0.0, 0.4, 1.0]))
    np.testing.assert_allclose(nothing_below, [0.0, 0.0, 0.2, 0.2, 0.6, 0.0], rtol=0.0, atol=1e-15)
    with pytest.raises(ValueError, match="top bin"):
        ref.sieve_pmf(psi, size, np.array([0.1, 0.4, 0.9]))


def test_percentiles() -> None:
    edge = np.array([-1.0, 0.0, 1.0, 2.0, 3.0])
    cdf = np.array([0.1, 0.3, 0.3, 0.8, 1.0])
    for percent, psi in [(20, -0.5), (30, 0.0), (80, 2.0), (55, 1.5), (100, 3.0), (10, -1.0), (5, -1.0)]:
        assert ref.percentile(cdf, edge, percent) == pytest.approx(math.exp(psi), rel=1e-14)
    assert ref.percentile(np.array([0.0, 0.0, 1.0]), edge[:3], 1e-9) == pytest.approx(1.0, rel=1e-8)


def test_centres_span_the_range() -> None:
    np.testing.assert_allclose(ref.centres(-6.0, 1.0, 8), np.arange(-6.0, 2.0), rtol=0.0, atol=1e-15)

"""Checks of the quasi-static reference against repeated steps, closed forms and packets followed one by one."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple, get_args

import numpy as np
import pytest

import reference as ref
import reference_quasi_static as qs
from reference import HAND_CASE, Array, Law, Model, PowerLaw, Rule, Weibull
from reference_quasi_static import Atom, LogNormal, Scheme, Tabulated

RULES: tuple[Rule, ...] = get_args(Rule)
SCHEMES: tuple[Scheme, ...] = get_args(Scheme)
TAIL = Tabulated((0.02, 0.1, 0.3, 0.35, 1.0), (0.01, 0.1, 0.6, 0.6, 1.0))
NO_TAIL = Tabulated((0.05, 0.2, 0.7, 1.0), (0.0, 0.3, 0.5, 1.0))
LAWS: list[Law] = [
    LogNormal(),
    LogNormal(-0.5, 0.2),
    LogNormal(2.0, 0.7),
    TAIL,
    NO_TAIL,
    Tabulated((0.5, 1.0), (0.0, 1.0)),
]


def integral_of_cdf(law: Law, low: float, high: float) -> float:
    """Gauss quadrature of the cdf over panels that end at every kink."""
    kinks = law.kinks if isinstance(law, Tabulated) else np.zeros(0)
    cuts = np.unique([*np.linspace(low, high, 17), *kinks[(kinks > low) & (kinks < high)]])
    node, weight = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(cuts)
    return math.fsum(float(h * (weight @ law.cdf(a + h * (1.0 + node)))) for a, h in zip(cuts, half, strict=False))


def random_state(bins: int, seed: int = 1) -> Array:
    """Random masses of total 1, with empty cells."""
    rng = np.random.default_rng(seed)
    p = rng.exponential(size=(bins, bins)) * (rng.random((bins, bins)) < 0.7)
    return np.asarray(p / p.sum())


def normal_pmf(psi: Array, mean: float, sd: float) -> Array:
    """Bin masses of a normal law in psi, what is above the grid in the top bin."""
    cdf = np.array([0.5 * math.erfc((mean - x) / (sd * math.sqrt(2.0))) for x in psi + 0.5 * (psi[1] - psi[0])])
    cdf[-1] = 1.0
    return np.diff(cdf, prepend=0.0)


# --- laws ---------------------------------------------------------------------------------------------------


def test_log_normal_law_in_figures() -> None:
    # Medians: R = -1 without a cut that matters; half of the mass below the cut in the middle of the normal law.
    assert LogNormal(-1.0, 0.1).cdf(np.array([-1.0]))[0] == pytest.approx(0.5, abs=1e-15)
    assert LogNormal(0.0, 2.0).cdf(np.array([-2.0]))[0] == pytest.approx(0.317310507862914, abs=1e-14)
    assert LogNormal(0.0, 2.0).pdf(np.zeros(1))[0] == pytest.approx(1.0 / math.sqrt(2.0 * math.pi), rel=1e-15)
    # Far in the tail of the normal law the cut leaves an exponential law of rate mean / sd^2.
    assert LogNormal(200.0, 10.0).cdf(np.array([-0.5]))[0] == pytest.approx(math.exp(-1.0), rel=5e-3)


def test_tabulated_law_in_figures() -> None:
    r = np.log([0.005, 0.02, math.sqrt(0.02 * 0.1), 0.1, 0.32, 1.0])
    np.testing.assert_allclose(TAIL.cdf(r), [0.01 * 0.25**1.430676558073393, 0.01, 0.055, 0.1, 0.6, 1.0], rtol=1e-14)
    slope = 0.5 / math.log(3.0)
    np.testing.assert_allclose(TAIL.pdf(np.log([0.2, 0.32])), [slope, 0.0], rtol=1e-14)
    np.testing.assert_array_equal(NO_TAIL.cdf(np.log([1e-9, 0.049])), 0.0)
    np.testing.assert_array_equal(NO_TAIL.pdf(np.log([1e-9, 0.049])), 0.0)


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_pdf_is_the_slope_of_the_cdf(law: Law) -> None:
    r, step = -np.linspace(0.0131, 6.1, 57), 1e-5
    np.testing.assert_allclose(law.pdf(r), (law.cdf(r + step) - law.cdf(r - step)) / (2.0 * step), atol=3e-9, rtol=0.0)
    assert law.cdf(np.zeros(1))[0] == 1.0


@pytest.mark.parametrize(
    ("x", "finer"),
    [
        ((1.0,), (1.0,)),
        ((0.5, 0.9), (0.2, 1.0)),
        ((0.5, 1.0), (0.2, 0.9)),
        ((0.5, 0.4, 1.0), (0.2, 0.3, 1.0)),
        ((0.4, 0.5, 1.0), (0.3, 0.2, 1.0)),
        ((0.4, 0.5, 1.0), (0.3, 0.3, 1.0)),
        ((0.0, 1.0), (0.0, 1.0)),
        ((0.5, 1.0), (0.1, 0.2, 1.0)),
        ((math.nan, 1.0), (0.1, 1.0)),
    ],
)
def test_tables_that_are_no_law_are_refused(x: tuple[float, ...], finer: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match=r"x must|cdf"):
        Tabulated(x, finer)


@pytest.mark.parametrize("law", [*LAWS, Weibull(), Weibull(0.3, 2.0), PowerLaw(0.7)], ids=repr)
@pytest.mark.parametrize("spacing", [0.05, 0.31, 1.0])
def test_fragment_masses_follow_from_the_cdf(law: Law, spacing: float) -> None:
    bins = 25
    edge: Array = np.asarray(-spacing * np.arange(bins + 1), dtype=np.float64)
    paper = qs.fragment_masses(law, spacing, bins, "paper")
    np.testing.assert_allclose(paper[1:], -np.diff(law.cdf(edge[:-1])), rtol=0.0, atol=5e-15)
    # Integrated by parts twice, f_m is a second difference of the integral of the cdf: differences of bin means.
    mean = [integral_of_cdf(law, low, high) / spacing for high, low in pairwise(edge)]
    conservative = qs.fragment_masses(law, spacing, bins, "conservative")
    np.testing.assert_allclose(conservative, -np.diff(mean, prepend=1.0), rtol=0.0, atol=5e-15)
    if not isinstance(law, Tabulated):
        for rule in RULES:
            same = ref.fragment_pmf(law, spacing, bins, rule)
            np.testing.assert_allclose(qs.fragment_masses(law, spacing, bins, rule), same, rtol=0.0, atol=1e-15)


def test_lines_keep_all_mass_and_are_those_of_the_reference() -> None:
    psi = ref.centres(-4.0, 0.0, 20)
    for rule in RULES:
        for law in LAWS:
            np.testing.assert_allclose(qs.crush_lines(psi, law, rule).sum(axis=1), 1.0, rtol=1e-14)
        lines = ref._lines(psi, Model(), rule)
        np.testing.assert_allclose(qs.crush_lines(psi, Weibull(), rule), lines, rtol=0.0, atol=1e-15)


# --- one solve and many steps -------------------------------------------------------------------------------

CASES = [
    (Model(3.0, 0.05, 1.0), 8.0),
    (Model(3.0, 0.6, 1.0, LogNormal(-0.7, 0.5)), 5.0),
    (Model(2.0, 1.5, 0.8, TAIL), 20.0),
    (Model(3.0, math.inf, 1.0, PowerLaw(0.8)), 3.0),
    (Model(6.0, 0.3, 2.0), 1e4),
]


class Rest(NamedTuple):
    """State after steps until nothing moves, and the mass that crushed."""

    p: Array
    crushed: float
    crushed_neighbour: float


def step_to_rest(p: Array, psi: Array, model: Model, stress_ratio: float, loading_rate: float, rule: Rule) -> Rest:
    """Repeat the single step of Eq. (67), centre test, until no active mass is left."""
    zone = ref.zones(psi, model, stress_ratio)
    psi_only, psibar_only, both = ref.shares(zone, "blend", loading_rate)
    crushed = crushed_neighbour = 0.0
    while p[zone > 0].sum() > 1e-18:
        crushed += float((p * (psi_only + both)).sum())
        crushed_neighbour += float((p * (psibar_only + both)).sum())
        p = ref.step(p, psi, model, stress_ratio, "blend", loading_rate, rule)
    return Rest(p, crushed, crushed_neighbour)


@pytest.mark.parametrize(("model", "stress_ratio"), CASES, ids=repr)
@pytest.mark.parametrize("loading_rate", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("rule", RULES)
def test_one_sweep_is_many_steps_to_rest(
    model: Model, stress_ratio: float, loading_rate: float, rule: Rule, monkeypatch: pytest.MonkeyPatch
) -> None:
    if isinstance(model.law, Tabulated):  # whose kinks cost the quadrature of the reference 1e-3
        monkeypatch.setattr(ref, "fragment_pmf", qs.fragment_masses)
    psi, p = ref.centres(-3.1, 0.9, 16), random_state(16)
    share = qs.fractions(psi, model, stress_ratio, "paper")
    assert share.any()
    lines = qs.crush_lines(psi, model.law, rule)
    found = qs.sweep(p, np.zeros(p.shape), share, share, lines, loading_rate)
    expected = step_to_rest(p, psi, model, stress_ratio, loading_rate, rule)
    np.testing.assert_allclose(found.p, expected.p, rtol=0.0, atol=1e-14)
    assert found[1:] == pytest.approx(expected[1:], rel=1e-13)
    if rule == "paper":
        settled = qs.settle(p, psi, model, stress_ratio, None, "paper", loading_rate)
        np.testing.assert_array_equal(settled.p, found.p)
        assert settled[1:] == found[1:]


@pytest.mark.parametrize("kind", ["slow", "fast", "blend"])
def test_one_solve_is_the_step_of_the_reference_repeated(kind: ref.Kind) -> None:
    case = HAND_CASE
    rate = {"slow": 0.0, "fast": 1.0, "blend": 0.25}[kind]
    p = case.p
    for _ in range(8):  # four bins: at most six moves
        p = ref.step(p, case.psi, case.model, case.stress_ratio, kind, rate)
    settled = qs.settle(case.p, case.psi, case.model, case.stress_ratio, scheme="paper", loading_rate=rate)
    np.testing.assert_allclose(settled.p, p, rtol=0.0, atol=1e-15)  # rounding of eight steps on unit mass
    assert ((p > 0.0) <= (case.zones == 0)).all()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("fabric_width", "loading_rate"), [(0.4, 0.0), (0.05, 0.0), (0.4, 0.3)])
def test_one_solve_is_two_hundred_increments(scheme: Scheme, fabric_width: float, loading_rate: float) -> None:
    psi, p = ref.centres(-2.6, 0.9, 12), random_state(12)
    model, loads = Model(3.0, fabric_width, 1.0), np.geomspace(0.2, 9.0, 200)
    path = qs.settle_path(p, psi, model, [float(load) for load in loads], None, scheme, loading_rate)
    once = qs.settle(p, psi, model, 9.0, None, scheme, loading_rate)
    np.testing.assert_allclose(path[-1].p, once.p, rtol=0.0, atol=1e-14)
    assert path[-1][1:] == pytest.approx(once[1:], rel=1e-13)
    assert once.p.sum() == pytest.approx(1.0, abs=1e-14)
    assert (once.p >= 0.0).all()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_only_the_largest_load_counts(scheme: Scheme) -> None:
    psi, p, model = ref.centres(-3.0, 0.6, 14), random_state(14), Model(3.0, 0.3, 1.0)
    loads = [0.0, 4.0, 1.0, 0.0, 4.0, 3.9, 7.0]
    path = qs.settle_path(p, psi, model, loads, scheme=scheme)
    assert len(path) == len(loads)
    np.testing.assert_array_equal(path[0].p, p)
    assert path[0].crushed == 0.0
    for k in (2, 3, 4, 5):
        np.testing.assert_array_equal(path[k].p, path[1].p)
        assert path[k][1:] == path[1][1:]
    resumed = qs.settle_path(path[1].p, psi, model, [1.0, 7.0], 4.0, scheme)
    np.testing.assert_array_equal(resumed[-1].p, path[-1].p)
    for load in (-1.0, math.nan):
        with pytest.raises(ValueError, match="stress ratio"):
            qs.settle(p, psi, model, load, 2.0, scheme)


def test_unknown_schemes_are_refused() -> None:
    with pytest.raises(ValueError, match="scheme"):
        qs.fractions(HAND_CASE.psi, HAND_CASE.model, 2.0, "centre")  # type: ignore[arg-type]


def test_settled_mass_crushes_by_the_share_newly_covered() -> None:
    # One cell two bins off the diagonal, half covered at the first load, more at the second.
    psi, model = ref.centres(-4.0, 0.0, 9), Model(3.0, 0.8, 1.0)
    p = np.zeros((9, 9))
    p[6, 4] = 1.0
    low, high = (float(qs.fractions(psi, model, load, "conservative")[6, 4]) for load in (6.0, 8.0))
    assert 0.1 < low < high < 0.9
    first = qs.settle(p, psi, model, 6.0)
    assert first.p[6, 4] == pytest.approx(1.0 - low)
    second = qs.settle(first.p, psi, model, 8.0, settled_at=6.0)
    assert second.p[6, 4] == pytest.approx(1.0 - high)


@pytest.mark.parametrize("alpha", [0.0, 0.3, 1.0])
def test_what_stays_in_its_cell_crushes_again(alpha: float) -> None:
    bins, (i, j) = 8, (5, 3)
    lines = qs.crush_lines(ref.centres(-3.5, 0.0, bins), Weibull(), "conservative")
    stay, none = lines[bins - 1, bins - 1], np.zeros((bins, bins))
    both = (1.0 - alpha) * stay + alpha * stay**2
    cases = [((i, j), 1.0, both), ((j, i), 0.0, both), ((i, i), 0.5, both), ((i, 0), 1.0, stay), ((0, j), 0.0, stay)]
    for cell, larger, stays in cases:
        p, active = none.copy(), none.copy()
        p[cell] = active[cell] = 1.0
        _, crushed, crushed_neighbour = qs.sweep(none, p, active, active, lines, alpha)
        assert crushed == pytest.approx(((1.0 - alpha) * larger + alpha) / (1.0 - stays), rel=1e-13)
        assert crushed_neighbour == pytest.approx(((1.0 - alpha) * (1.0 - larger) + alpha) / (1.0 - stays), rel=1e-13)


# --- closed forms -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("loading_rate", [0.0, 1.0])
@pytest.mark.parametrize("bins", [18, 36, 72])
def test_without_fabric_settled_sizes_are_uniform_and_crushes_poisson(bins: int, loading_rate: float) -> None:
    # X uniform. s_c = 1 / sigma on a bin edge, and a start in one cell, its centre at s_max = 1.
    top, spacing = 9, 9.0 / bins
    psi: Array = np.asarray((np.arange(bins) - (bins - top)) * spacing, dtype=np.float64)
    edge = psi + 0.5 * spacing
    above = 5  # bins above s_c
    critical = -(above - 0.5) * spacing
    p = np.zeros((bins, bins))
    p[bins - top, bins - top] = 1.0
    model = Model(3.0, math.inf, 1.0, PowerLaw(1.0))
    settled = qs.settle(p, psi, model, math.exp(-critical), loading_rate=loading_rate)
    if loading_rate == 0.0:
        expected = np.minimum(np.exp(edge - critical), 1.0)
        np.testing.assert_allclose(np.cumsum(settled.p.sum(axis=1)), expected, rtol=0.0, atol=3e-7)
        np.testing.assert_allclose(settled.p, settled.p.T, rtol=0.0, atol=1e-15)
        # 1 + ln(s_max / s_c) + h^2 / 12 - h^4 / 720 + ...: the bins add up h coth(h/2) / 2 - 1.
        half = 0.5 * spacing
        count = 1.0 - critical + half / math.tanh(half) - 1.0
        assert settled.crushed == pytest.approx(count, rel=3e-7)
        assert settled.crushed_neighbour == pytest.approx(count, rel=3e-7)
    else:  # both crush as long as either is above s_c, so those below it are crushed on
        assert settled.crushed > 1.0 - critical
    assert settled.p[psi > critical, :].sum() < 1e-6
    assert settled.p[:, psi > critical].sum() < 1e-6


# --- packets, grids ever finer ------------------------------------------------------------------------------


def reductions(law: Law, count: int, rng: np.random.Generator) -> Array:
    """Sample of R by inversion of its cdf."""
    r = np.linspace(-30.0, 0.0, 30001)
    return np.interp(rng.random(count), law.cdf(r), r)


def follow_packets(
    start: tuple[Array, Array], model: Model, stress_ratio: float, loading_rate: float
) -> tuple[Array, float, float]:
    """Packets of equal mass crushed one by one until each is at rest, no grid: psi, and crushes per packet."""
    rng = np.random.default_rng(3)
    place = np.stack(start, axis=1)
    crushes, moving = np.zeros(2), np.arange(len(place))
    while len(moving):
        larger, gap = place[moving].max(axis=1), place[moving, 0] - place[moving, 1]
        load = math.log(stress_ratio) + 3.0 / model.weibull_modulus * (larger - math.log(model.reference_size))
        active = load >= gap**2 / (2.0 * model.fabric_width**2)  # Eq. (2) of the larger grain
        moving, gap = moving[active], gap[active]
        which = np.where(gap != 0.0, gap > 0.0, rng.random(len(gap)) < 0.5)
        hit = np.stack([which, ~which], axis=1) | (rng.random((len(gap), 1)) < loading_rate)
        place[moving] += hit * reductions(model.law, 2 * len(gap), rng).reshape(-1, 2)
        crushes += hit.sum(axis=0)
    return place[:, 0], float(crushes[0] / len(place)), float(crushes[1] / len(place))


def smooth_start_settled(bins: int, model: Model, loading_rate: float) -> tuple[Array, qs.Settled]:
    """Upper edges, and a log-normal start at rest at a stress ratio of 8, whose zone ends on a bin edge."""
    # Without that, the place of the zone's tip in its bin would change from grid to grid, and the error with it.
    tip, spacing = -math.log(8.0) * model.weibull_modulus / 3.0, 4.0 / bins
    psi = ref.centres(tip - 1.5 + 0.5 * spacing, tip + 2.5 - 0.5 * spacing, bins)
    p = np.outer(normal_pmf(psi, -1.0, 0.4), normal_pmf(psi, -1.2, 0.3))
    return psi + 0.5 * spacing, qs.settle(p, psi, model, 8.0, loading_rate=loading_rate)


@pytest.mark.parametrize("loading_rate", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("fabric_width", [0.05, 0.2, 1.0])
def test_the_conservative_scheme_is_second_order(fabric_width: float, loading_rate: float) -> None:
    cdfs = []
    for bins in (24, 48, 96):
        _, settled = smooth_start_settled(bins, Model(3.0, fabric_width, 1.0), loading_rate)
        assert settled.p.sum() == pytest.approx(1.0, abs=1e-13)
        cdfs.append(np.cumsum(settled.p.sum(axis=1))[bins // 24 - 1 :: bins // 24])
    coarse, fine = (float(np.abs(a - b).max()) for a, b in pairwise(cdfs))
    if fabric_width == 0.05:  # the zone is at most two bins wide on the finest grid: no order yet, but small
        assert max(coarse, 4.0 * fine) < 1.2e-3
    else:
        assert 1.9 < math.log2(coarse / fine) < 2.1
        assert fine < 1.5e-3


@pytest.mark.parametrize("loading_rate", [0.0, 0.3])
@pytest.mark.parametrize(
    "model",
    [
        Model(3.0, 0.05, 1.0),
        Model(3.0, 1.0, 1.0),
        Model(3.0, 0.4, 1.0, LogNormal(-0.6, 0.5)),
        Model(3.0, 0.4, 1.0, TAIL),
    ],
    ids=repr,
)
def test_packets_settle_where_the_grid_says(model: Model, loading_rate: float, monkeypatch: pytest.MonkeyPatch) -> None:
    edge, settled = smooth_start_settled(96, model, loading_rate)
    rng = np.random.default_rng(2)
    start = rng.normal(-1.0, 0.4, 200_000), rng.normal(-1.2, 0.3, 200_000)
    place, *crushes = follow_packets(start, model, 8.0, loading_rate)
    cdf = np.searchsorted(np.sort(place), edge) / len(place)
    np.testing.assert_allclose(np.cumsum(settled.p.sum(axis=1)), cdf, rtol=0.0, atol=5e-3)  # noise 1e-3
    assert settled[1:] == pytest.approx(crushes, abs=1e-2)


# --- atoms --------------------------------------------------------------------------------------------------


def test_atoms_crush_whole_or_not_at_all_and_the_zone_is_closed() -> None:
    psi, model = ref.centres(-6.0, 1.0, 36), Model()
    mono = Atom(0.0, 0.0, 1.0)
    assert qs.atom_crushes(mono, psi, model, 1.0)
    assert not qs.atom_crushes(mono, psi, model, 1.0 - 1e-12)
    assert not qs.atom_crushes(mono, psi, model, 0.0)
    width = math.sqrt(6.0 * 0.05**2 / 3.0 * math.log(4.0))  # W at psi = 0 and a stress ratio of 4: g* = k ln 4
    for near, far in (((0.0, -0.999 * width), (0.0, -1.001 * width)), ((-0.999 * width, 0.0), (-1.001 * width, 0.0))):
        assert qs.atom_crushes(Atom(*near, 1.0), psi, model, 4.0)
        assert not qs.atom_crushes(Atom(*far, 1.0), psi, model, 4.0)
    assert not qs.atom_crushes(Atom(-5.9, -5.9, 1.0), psi, model, 1e9)  # fines among fines


def test_an_atom_is_spread_by_the_cdf_of_its_fragments_and_stays_in_place_on_average() -> None:
    psi, law, (a, b) = ref.centres(-3.0, 0.0, 31), LogNormal(-0.8, 0.4), (-0.43, -0.97)
    edge = psi + 0.05
    for cell, in_psi in (((a, b), True), ((b, a), False)):
        spread, crushed, crushed_neighbour = qs.spread_atom(Atom(*cell, 0.7), psi, law, 0.0)
        assert (crushed, crushed_neighbour) == ((0.7, 0.0) if in_psi else (0.0, 0.7))
        moved, kept = (spread.sum(axis=1), spread.sum(axis=0)) if in_psi else (spread.sum(axis=0), spread.sum(axis=1))
        np.testing.assert_allclose(np.cumsum(moved), 0.7 * law.cdf(np.minimum(edge - a, 0.0)), rtol=0.0, atol=1e-15)
        assert kept @ psi == pytest.approx(0.7 * b, abs=1e-15)
        assert np.count_nonzero(kept) == 2
    spread, *crushes = qs.spread_atom(Atom(a, b, 0.7), psi, law, 0.25)
    assert crushes == pytest.approx([0.7, 0.175], abs=1e-15)
    assert spread.sum() == pytest.approx(0.7, abs=1e-15)
    with pytest.raises(ValueError, match="above the top bin"):
        qs.spread_atom(Atom(0.06, b, 1.0), psi, law, 0.0)


@pytest.mark.parametrize("fabric_width", [0.05, 1.0])
def test_of_equal_grains_exactly_half_crush_at_a_stress_ratio_of_one(fabric_width: float) -> None:
    # The atom sits on the upper edge of the top bin, so that no bin reaches beyond it.
    bins, spacing = 40, 0.15
    psi = ref.centres((0.5 - bins) * spacing, -0.5 * spacing, bins)
    edge = psi + 0.5 * spacing
    for other in (0.0, 4e-16, -4e-16):  # equal but for rounding
        settled = qs.settle_atoms(np.zeros((bins, bins)), [(0.0, other, 1.0)], psi, Model(3.0, fabric_width, 1.0), 1.0)
        assert settled.atoms == []
        assert settled[2:] == pytest.approx((0.5, 0.5), abs=1e-15)
        # Half of the mass is fragments of a first crush, the other half beside them is whole.
        finer = np.cumsum(settled.p.sum(axis=1))[:-1]
        np.testing.assert_allclose(finer, 0.5 * Weibull().cdf(edge[:-1]), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("fabric_width", "stress_ratio", "tolerance"),
    [(0.05, 1.0, 5e-3), (0.05, 1.5, 4e-3), (0.05, 1e4, 4e-3), (1.0, 1.0, 6e-2), (1.0, 1.5, 5e-3), (1.0, 8.0, 5e-3)],
)
def test_atoms_settle_where_packets_do(fabric_width: float, stress_ratio: float, tolerance: float) -> None:
    # On a bin centre. Close to first crushing a wide zone gives the tolerance: its tip is as sharp as a square
    # root, and the half of the fragments' cells that lies beyond the atom is taken to be inside.
    psi, model = ref.centres(-6.4, 0.4, 35), Model(3.0, fabric_width, 1.0)
    found = qs.settle_atoms(np.zeros((35, 35)), [(0.0, 0.0, 1.0)], psi, model, stress_ratio)
    place, *crushes = follow_packets((np.zeros(200_000), np.zeros(200_000)), model, stress_ratio, 0.0)
    cdf = np.searchsorted(np.sort(place), psi + 0.1) / len(place)
    np.testing.assert_allclose(np.cumsum(found.p.sum(axis=1)), cdf, rtol=0.0, atol=tolerance)
    assert found[2:] == pytest.approx(crushes, abs=2.0 * tolerance)
    assert found.p.sum() == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("loading_rate", [0.0, 0.3])
def test_gap_graded_atoms_in_increments_and_in_one_solve(scheme: Scheme, loading_rate: float) -> None:
    # Ratio 10, half by mass, psibar the arithmetic mean of two neighbours: six atoms. Some mass on the grid, too.
    psi, model = ref.centres(-4.0, 0.2, 15), Model(3.0, 0.5, 1.0)
    neighbours = ((1.0, 0.25), (0.55, 0.5), (0.1, 0.25))
    atoms = [(math.log(s), math.log(t), 0.4 * share) for s in (1.0, 0.1) for t, share in neighbours]
    start = 0.2 * random_state(15)
    once = qs.settle_atoms(start, atoms, psi, model, 6.0, None, scheme, loading_rate)
    left: list[tuple[float, float, float]] = atoms
    p, before, crushed, crushed_neighbour = start, 0.0, 0.0, 0.0
    for load in (0.5, 1.0, 1.7, 3.0, 2.0, 6.0):
        p, left_now, more, more_neighbour = qs.settle_atoms(p, left, psi, model, load, before, scheme, loading_rate)
        left, before = [*left_now], max(before, load)
        crushed, crushed_neighbour = crushed + more, crushed_neighbour + more_neighbour
    np.testing.assert_allclose(p, once.p, rtol=0.0, atol=1e-14)
    assert left == once.atoms
    assert (crushed, crushed_neighbour) == pytest.approx(once[2:], rel=1e-13)
    # Equal coarse grains and coarse ones beside a mean of 0.55 have crushed; the others are as they were.
    assert left == [atoms[k] for k in (2, 3, 4, 5)]
    assert p.sum() + sum(atom[2] for atom in left) == pytest.approx(1.0, abs=1e-14)

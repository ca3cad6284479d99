"""Older models against their exact answers."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm
from comminute import comparators

scipy_stats = pytest.importorskip("scipy.stats")
special = pytest.importorskip("scipy.special")
integrate = pytest.importorskip("scipy.integrate")

UNIFORM = cm.PowerLawFragments(1.0)
ONE = cm.monodisperse(1.0)
STARTS = {
    "one size": ONE,
    "power law": cm.power_law(2.4, 0.01, 1.0),
    "two": cm.gap_graded(1.0, 0.1),
    "measured": cm.Grading.from_sieves([1.0, 0.5, 0.2], [100, 40, 10], unit="mm"),
}


@pytest.mark.parametrize(("generations", "distance"), [(1, 0.159), (5, 0.0595), (20, 0.0297), (100, 0.0133)])
def test_generations_of_uniform_fragments_are_gamma_distributed(generations: int, distance: float) -> None:
    curve = comparators.independent(ONE, UNIFORM, crushes=generations)
    y = -np.log(curve.size)
    assert np.abs(curve.finer - scipy_stats.gamma.sf(y, generations)).max() < 5e-6
    normal = scipy_stats.norm.sf((y - generations) / math.sqrt(generations))
    assert np.abs(curve.finer - normal).max() == pytest.approx(distance, abs=5e-4)
    middle = 0.5 * (y[1:] + y[:-1])
    assert float(np.diff(curve.finer) @ middle) == pytest.approx(generations, rel=1e-4)
    assert float(np.diff(curve.finer) @ (middle - generations) ** 2) == pytest.approx(generations, rel=1e-3)


@pytest.mark.parametrize("mean", [0.5, 3.0, 20.0])
def test_crushes_at_random_times(mean: float) -> None:
    curve = comparators.independent(ONE, UNIFORM, mean_crushes=mean)

    def density(y: float) -> float:
        root = 2.0 * math.sqrt(mean * y)
        return float(math.exp(-mean - y + root) * math.sqrt(mean / y) * special.ive(1, root))

    for y in (0.05, 0.7, 3.0, 10.0):
        coarser = math.exp(-mean) + integrate.quad(density, 1e-12, y, limit=400)[0]
        assert float(curve.finer_than(math.exp(-y))) == pytest.approx(1.0 - coarser, abs=1e-5)
    assert 1.0 - curve.finer[curve.size == 1.0][0] == pytest.approx(math.exp(-mean), abs=1e-9)
    assert -cm.gradings.breakage.mean_log(curve) == pytest.approx(mean, rel=1e-3)


def test_second_order_in_the_width_of_the_cells() -> None:
    errors = []
    for spacing in (0.04, 0.02):
        curve = comparators.independent(ONE, UNIFORM, crushes=5, spacing=spacing)
        errors.append(np.abs(curve.finer - scipy_stats.gamma.sf(-np.log(curve.size), 5)).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)


def test_no_crush_changes_nothing() -> None:
    for number in ({"crushes": 0}, {"mean_crushes": 0.0}):
        assert comparators.independent(STARTS["measured"], UNIFORM, **number) == cm.SizeCurve.of(STARTS["measured"])


@pytest.mark.parametrize("modulus", [3.0, 6.0])
def test_size_alone(modulus: float) -> None:
    grains = cm.Material(weibull_modulus=modulus, fragments=UNIFORM)
    loads = [1.5, 8.0, 100.0]
    for load, curve in zip(loads, comparators.size_threshold(ONE, grains, loads, spacing=0.005), strict=True):
        largest = load ** (-modulus / 3.0)
        assert curve.size[-1] == pytest.approx(largest, rel=1e-12)
        at = largest * np.array([0.05, 0.3, 0.9])
        assert curve.finer_than(at) == pytest.approx(at / largest, abs=5e-5)  # even in (0, s_c)
    fabric = cm.Simulation(cm.Material(fabric_width=np.inf, fragments=UNIFORM), ONE).run(stress_ratio=[100.0])
    assert fabric.crushes[0] == pytest.approx(1.0 + math.log(100.0), rel=1e-3)


@given(st.floats(0.05, 0.99), st.integers(1, 30), st.floats(1.1, 4.0))
def test_cascade(share: float, levels: int, ratio: float) -> None:
    curve = comparators.cascade(share, levels, ratio=ratio, largest=5.0)
    i = np.arange(levels + 1)
    np.testing.assert_allclose(curve.finer_than(5.0 * ratio ** -i.astype(float) * (1 + 1e-12)), share**i, rtol=1e-13)
    just_below = curve.finer_than(5.0 * ratio ** -i[:-1].astype(float) * (1 - 1e-9))
    np.testing.assert_allclose(just_below, share ** (i[:-1] + 1.0), rtol=1e-13)


def test_the_cascades_dimension() -> None:
    curve = comparators.cascade(0.75, 40)
    found = cm.fractal_dimension(cm.SizeCurve(curve.size[1::2], curve.finer[1::2]), 1e-8, 1.0)
    assert found.dimension == pytest.approx(3.0 + math.log2(0.75), abs=1e-12)
    assert found.dimension == pytest.approx(2.585, abs=5e-4)


@pytest.mark.parametrize("name", STARTS)
def test_breakage_mechanics(name: str) -> None:
    start = STARTS[name]
    ratios = [0.5, 1.0, 1.5, 10.0, 1e6]
    theta = cm.breakage_index(start, start).grading_index
    for ratio, curve in zip(ratios, comparators.breakage(start, ratios), strict=True):
        index = cm.breakage_index(start, curve).index
        assert index == pytest.approx(max(ratio - 1.0, 0.0) / max(ratio - theta, 1e-300), abs=1e-6)
        back = (1.0 - theta * index) / (1.0 - index)  # p / p_c of pure breakage
        if ratio < 1e3:
            assert back == pytest.approx(max(ratio, 1.0), rel=1e-4)
    assert comparators.breakage(start, 1.0) == cm.SizeCurve.of(start)
    slope = (cm.breakage_index(start, comparators.breakage(start, 1.0 + 1e-4)).index) / 1e-4
    assert slope == pytest.approx(1.0 / (1.0 - theta), rel=1e-3)


def test_the_compression_line_has_its_slope() -> None:
    void = comparators.normal_compression([20.0, 200.0], 10.0, 0.6, 4.0)
    assert np.log(void[1] / void[0]) / np.log(10.0) == pytest.approx(-4.0 / 6.0, rel=1e-14)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.5])
@pytest.mark.parametrize("name", STARTS)
def test_grinding_is_exact_where_selection_and_breakage_have_one_exponent(name: str, exponent: float) -> None:
    start = STARTS[name]
    before = cm.SizeCurve.of(start)
    for curve, time in zip(
        comparators.batch_grinding(start, cm.PowerLawFragments(exponent), exponent, [0.0, 0.4, 30.0], rate=2.0),
        [0.0, 0.4, 30.0],
        strict=True,
    ):
        expected = 1.0 - (1.0 - before.finer_than(curve.size)) * np.exp(-2.0 * time * curve.size**exponent)
        after_jumps = np.append(np.diff(curve.size) > 0.0, True)
        assert np.abs(curve.finer - expected)[after_jumps].max() < 3e-15 * (1.0 + 60.0 * time)


def gamma_law(size: Any, time: float, exponent: float, breakage: float) -> Any:
    """Self-similar grading P(gamma / a, t x**a)."""
    return special.gammainc(breakage / exponent, time * np.asarray(size) ** exponent)


@pytest.mark.parametrize(("exponent", "breakage"), [(1.0, 2.0), (2.0, 1.0), (0.7, 0.7)])
def test_the_self_similar_law_solves_the_equation_of_grinding(exponent: float, breakage: float) -> None:
    # dF/dt (x) = integral over y > x of S(y) (x / y)**gamma dF(y), by quadrature
    time, s = 1.7, breakage / exponent
    for x in (0.05, 0.4, 1.5):
        rate = x**exponent * (time * x**exponent) ** (s - 1.0) * math.exp(-time * x**exponent) / math.gamma(s)

        def integrand(y: float, x: float = x) -> float:
            density = exponent * time**s * y ** (breakage - 1.0) * math.exp(-time * y**exponent) / math.gamma(s)
            return float(y**exponent * (x / y) ** breakage * density)

        found = integrate.quad(integrand, x, np.inf, epsabs=1e-14, epsrel=1e-13, limit=200)[0]
        assert found == pytest.approx(rate, abs=3e-11)


@pytest.mark.parametrize(("exponent", "breakage"), [(1.0, 2.0), (2.0, 1.0)])
def test_grinding_keeps_to_the_self_similar_law_in_second_order(exponent: float, breakage: float) -> None:
    size = np.exp(np.linspace(math.log(1e-4), math.log(40.0 ** (1 / exponent)), 3000))
    finer = gamma_law(size, 1.0, exponent, breakage)
    finer[-1] = 1.0
    start = cm.SizeCurve(size, finer, tail_slope=breakage)
    errors = []
    for classes in (100, 200, 400):
        curve = comparators.batch_grinding(
            start, cm.PowerLawFragments(breakage), exponent, 3.0, smallest=1e-4, classes=classes
        )
        errors.append(np.abs(curve.finer - gamma_law(curve.size, 4.0, exponent, breakage)).max())
    assert errors[2] < 2e-4
    assert errors[0] / errors[2] == pytest.approx(16.0, rel=0.25)


def test_equal_rates_are_kolmogorovs_case() -> None:
    ground = comparators.batch_grinding(ONE, UNIFORM, 0.0, 3.0, smallest=1e-6, classes=1500)
    random = comparators.independent(ONE, UNIFORM, mean_crushes=3.0)
    at = np.geomspace(1e-4, 0.9, 30)
    assert np.abs(ground.finer_than(at) - random.finer_than(at)).max() < 2e-4


@settings(deadline=None, max_examples=25)
@given(st.floats(0.0, 3.0), st.floats(0.0, 200.0), st.floats(0.3, 3.0))
def test_grinding_keeps_the_mass(exponent: float, time: float, shape: float) -> None:
    curve = comparators.batch_grinding(STARTS["two"], cm.WeibullFragments(1.0, shape), exponent, time, classes=60)
    assert curve.finer[-1] == 1.0
    assert np.all(np.diff(curve.finer) >= 0.0)
    assert -1e-14 < curve.finer[0] <= 1.0


@given(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=4))
def test_mixtures_add_up(weights: list[float]) -> None:
    shares = (np.array(weights) / sum(weights)).tolist()
    gradings = list(STARTS.values())[: len(shares)]
    gradings = [grading.with_unit("mm") for grading in gradings]
    mixed = comparators.mixture(shares, gradings)
    at = np.geomspace(0.003, 2.0, 200)
    parts = [share * cm.SizeCurve.of(g).finer_than(at) for share, g in zip(shares, gradings, strict=True)]
    # between its points a mixture is linear in ln d, as its parts are
    np.testing.assert_allclose(mixed.finer_than(at), np.sum(parts, axis=0), atol=2e-3)
    np.testing.assert_allclose(
        mixed.finer_than(mixed.size),
        np.sum([s * cm.SizeCurve.of(g).finer_than(mixed.size) for s, g in zip(shares, gradings, strict=True)], axis=0),
        atol=1e-12,
    )


def test_only_the_fabric_knows_whether_crushing_came_before_mixing() -> None:
    coarse, fine = cm.uniform_size(0.7, 1.0), cm.uniform_size(0.07, 0.1)
    both = comparators.mixture([0.5, 0.5], [coarse, fine])
    blend = cm.Grading.from_sieves(both.size, 100.0 * both.finer, unit="mm")
    coarse, fine = coarse.with_unit("mm"), fine.with_unit("mm")
    load = 50.0
    grains = cm.Material(fabric_width=0.2, fragments=UNIFORM)

    def distance(one: Any, other: Any) -> float:
        return float(cm.comparators.comparison.largest_difference(one, other))

    def crush(grading: Any) -> dict[str, cm.SizeCurve]:
        return {
            "independent": comparators.independent(grading, UNIFORM, mean_crushes=2.0),
            "size alone": comparators.size_threshold(grading, grains, load, spacing=0.005),
            "grinding": comparators.batch_grinding(grading, UNIFORM, 1.0, 5.0, smallest=1e-4, classes=800),
            "fabric": cm.Simulation(grains, grading).run(stress_ratio=load).curve(),
        }

    mixed, apart = crush(blend), [crush(coarse), crush(fine)]
    for name in ("independent", "size alone", "grinding"):
        after = comparators.mixture([0.5, 0.5], [part[name] for part in apart])
        assert distance(mixed[name], after) < 5e-3, name
    after = comparators.mixture([0.5, 0.5], [part["fabric"] for part in apart])
    assert distance(mixed["fabric"], after) > 0.1


def test_models_beside_a_result() -> None:
    pytest.importorskip("matplotlib")
    loads = [2.0, 20.0]
    run = cm.Simulation(cm.Material(fabric_width=0.2), ONE).run(stress_ratio=loads)
    compared = run.compare_with(
        {"breakage": comparators.breakage(ONE, loads), "start": ONE, "itself": [run.curve(0), run.curve(1)]}
    )
    assert compared.distance("itself").tolist() == [0.0, 0.0]
    assert compared.distance("start") == pytest.approx(
        [float(run.curve(k).finer_than(1 - 1e-9)) for k in (0, 1)], abs=1e-9
    )
    assert compared.table().splitlines()[0].split() == ["stress", "ratio", "breakage", "start", "itself"]
    figure = compared.plot()
    assert [line.get_label() for line in figure.axes[0].lines] == ["fabric model", "breakage", "start", "itself"]
    with pytest.raises(cm.ParameterError, match="has 1 curves; it must have one for each of the 2 loads"):
        run.compare_with({"short": [run.curve(0)]})
    with pytest.raises(cm.ParameterError, match="name is 'x'; it must be one of breakage"):
        compared.distance("x")
    with pytest.raises(cm.ParameterError, match="mm"):
        run.compare_with({"sand": cm.fuller(1.0).with_unit("mm")})


REFUSED = [
    (lambda: comparators.independent(ONE, UNIFORM), "give one of crushes or mean_crushes"),
    (lambda: comparators.independent(ONE, UNIFORM, crushes=-1), "crushes is -1"),
    (lambda: comparators.independent(ONE, UNIFORM, mean_crushes=-0.5), "mean_crushes is -0.5"),
    (lambda: comparators.independent(ONE, UNIFORM, crushes=1, spacing=0.0), "spacing is 0"),
    (lambda: comparators.size_threshold(ONE, cm.Material(), -1.0), "stress_ratio is -1"),
    (lambda: comparators.cascade(1.5, 3), "share is 1.5"),
    (lambda: comparators.cascade(0.5, 0), "levels is 0"),
    (lambda: comparators.cascade(0.5, 3, ratio=1.0), "ratio is 1"),
    (lambda: comparators.cascade(0.5, 3, largest=0.0), "largest is 0"),
    (lambda: comparators.breakage(ONE, math.inf), "stress_ratio is inf"),
    (lambda: comparators.breakage(cm.power_law(2.8, 0.0, 1.0), 2.0), "coarser"),
    (lambda: comparators.normal_compression([1.0], 0.0, 0.6, 3.0), "yield_stress is 0"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, -1.0, 1.0), "selection_exponent is -1"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, 1.0, -1.0), "time is -1"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, 1.0, 1.0, rate=0.0), "rate is 0"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, 1.0, 1e9), "may break 100000 times"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, 1.0, 1.0, smallest=2.0), "smallest is 2"),
    (lambda: comparators.batch_grinding(ONE, UNIFORM, 1.0, 1.0, classes=1), "classes is 1"),
    (lambda: comparators.mixture([0.5, 0.6], [ONE, ONE]), "must be 0 or more and sum to 1"),
    (lambda: comparators.mixture([1.0], [ONE, ONE]), "one for each of the 2 gradings"),
    (lambda: comparators.mixture([0.5, 0.5], [ONE, ONE.with_unit("mm")]), "mm"),
]


@pytest.mark.parametrize(("call", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_is_refused(call: Any, message: str) -> None:
    with pytest.raises(cm.ParameterError, match=message):
        call()

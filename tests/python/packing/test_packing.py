"""Packing models against exact answers, against a double loop, and against each other."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_packing import compaction_index, furnas_volume, westman_volume
from reference_packing import virtual_packings as by_double_loop

import comminute as cm
from comminute import packing
from comminute.packing.classes import SizeClasses, classes_of
from comminute.packing.compressible import virtual_packings
from comminute.packing.linear_mixture import _cubic as cubic_term
from comminute.packing.linear_mixture import _quadratic as quadratic_term

MODELS: tuple[Any, ...] = ("cpm", "lpm", "linear-mixture", "rods")
GRADINGS = {
    "one size": cm.monodisperse(1.0),
    "two": cm.gap_graded(1.0, 0.1, 0.7),
    "Fuller": cm.fuller(16.0),
    "band": cm.uniform_size(0.5, 1.0),
    "measured": cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100.0, 60.0, 25.0, 4.0]),
}


def exact(sizes: list[float], shares: list[float]) -> SizeClasses:
    """Classes of exact sizes alone, also where a grading could not have them."""
    none = np.zeros(0)
    return SizeClasses(none, none, 0.0, np.array(sizes), np.array(shares))


@pytest.mark.parametrize("compaction", [4.1, 4.5, 9.0, 1e9])
@pytest.mark.parametrize("beta", [0.5, 0.64, 0.9])
def test_one_size(beta: float, compaction: float) -> None:
    found = packing.solid_fraction(cm.monodisperse(3.0), packing=beta, compaction=compaction)
    assert found == pytest.approx(beta * compaction / (compaction + 1.0), rel=1e-15)
    assert packing.solid_fraction(cm.monodisperse(3.0), "lpm", packing=beta) == pytest.approx(beta, rel=1e-15)
    assert packing.solid_fraction(cm.monodisperse(3.0), "linear-mixture", packing=beta) == pytest.approx(
        beta, rel=1e-15
    )


def test_one_size_has_the_default_void_ratio() -> None:
    assert packing.void_ratio(cm.monodisperse(1.0)) == pytest.approx(2 / 3, rel=1e-15)


@pytest.mark.parametrize("model", ["cpm", "lpm"])  # the linear-mixture model's third term is not additive
def test_a_class_split_into_equal_sizes_is_one(model: Any) -> None:
    whole = packing.solid_fraction(exact([1.0, 0.3], [0.6, 0.4]), model)
    split = packing.solid_fraction(exact([1.0, 0.3, 0.3, 1.0], [0.5, 0.1, 0.3, 0.1]), model)
    assert split == pytest.approx(whole, rel=2e-15)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", GRADINGS)
def test_the_scale_of_the_sizes_does_not_matter(name: str, model: Any) -> None:
    curve = cm.SizeCurve.of(GRADINGS[name])
    larger = cm.SizeCurve(1000.0 * curve.size, curve.finer, tail_slope=curve.tail_slope)
    if model == "rods" and name in ("Fuller", "measured"):
        curve, larger = (cm.SizeCurve(one.size, one.finer * (one.size > one.size[0])) for one in (curve, larger))
    found = [packing.solid_fraction(one, model, rods=3000) for one in (curve, larger)]
    assert found[0] == pytest.approx(found[1], rel=1e-12 if model != "rods" else 1e-3)


def test_finer_classes_converge_in_second_order() -> None:
    wide = cm.log_uniform(0.01, 1.0)
    found = [packing.solid_fraction(wide, classes=n) for n in (10, 20, 40, 80, 160)]
    assert np.round(found, 5).tolist() == [0.78846, 0.79054, 0.79103, 0.79115, 0.79118]
    steps = np.diff(found)
    assert np.all((steps[:-1] / steps[1:])[:2] > 3.5)
    for beta in (0.6, 0.64):
        mixed = [packing.solid_fraction(wide, "linear-mixture", packing=beta, classes=n) for n in (10, 20, 40, 80)]
        assert np.ptp(mixed) < 1e-3  # a third of what ten classes instead of many are off by in the other model


@pytest.mark.parametrize(("beta", "sizes"), [(0.64, 2), (0.6, 3), (0.7, 4)])
def test_sizes_far_apart_fill_each_others_voids(beta: float, sizes: int) -> None:
    shares = (1.0 - beta) ** np.arange(sizes)
    far = exact([1e-16**k for k in range(sizes)], (shares / shares.sum()).tolist())
    filled = 1.0 - (1.0 - beta) ** sizes
    assert packing.solid_fraction(far, "lpm", packing=beta) == pytest.approx(filled, abs=3e-8)
    assert packing.solid_fraction(far, "linear-mixture", packing=beta) == pytest.approx(filled, abs=1e-12)
    assert packing.solid_fraction(far, packing=beta, compaction=1e9) == pytest.approx(filled, abs=3e-8)


def test_filling_is_approached_as_the_root_of_the_size_ratio() -> None:
    beta, fine = 0.64, 0.36 / 1.36
    missing = [
        0.8704 - packing.solid_fraction(exact([1.0, r], [1 - fine, fine]), "lpm", packing=beta) for r in (1e-4, 1e-6)
    ]
    assert missing[0] / missing[1] == pytest.approx(10.0, rel=0.01)
    assert missing[1] == pytest.approx(0.8704 - 0.8700837, abs=1e-6)


@given(
    st.lists(st.floats(-4.0, 0.0), min_size=1, max_size=8, unique=True),
    st.integers(0, 2**32 - 1),
    st.booleans(),
)
def test_virtual_packings_are_those_of_the_double_loop(logs: list[float], seed: int, one_packing: bool) -> None:
    random = np.random.default_rng(seed)
    share = random.dirichlet(np.ones(20 + len(logs)))
    share[random.integers(0, 20)] = 0.0
    share /= share.sum()
    classes = SizeClasses(np.exp(-5.0 + 0.25 * np.arange(20)), share[:20], 0.25, np.exp(logs), share[20:])
    beta = np.full(share.size, 0.61) if one_packing else random.uniform(0.5, 0.75, share.size)
    found = virtual_packings(classes, beta)
    expected = by_double_loop(classes.all_sizes, classes.all_shares, beta)
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    sizes = classes.all_sizes
    by_size = dict(zip(sizes.tolist(), beta.tolist(), strict=True))
    if len(by_size) == sizes.size:
        solid = packing.solid_fraction(classes, packing=by_size)
        assert compaction_index(sizes, share, beta, solid) == pytest.approx(9.0, rel=1e-9)


def test_equal_packings_by_convolution_equal_the_matrix() -> None:
    curve = classes_of(cm.lognormal(1.0, 0.8), classes=733)
    even = np.full(curve.all_sizes.size, 0.64)
    nudged = even.copy()
    nudged[0] = np.nextafter(0.64, 1.0)  # which takes the other way
    np.testing.assert_allclose(virtual_packings(curve, even), virtual_packings(curve, nudged), rtol=2e-14)


def test_two_sizes_by_all_models() -> None:
    ratios, beta = (2.0, 5.0, 10.0, 20.0, 50.0), 0.6435 * 10 / 9
    two = [cm.gap_graded(1.0, 1.0 / ratio, 0.75) for ratio in ratios]
    cpm = [packing.solid_fraction(one, packing=beta) for one in two]
    mixed = [packing.solid_fraction(one, "linear-mixture", packing=0.6435) for one in two]
    rods = [packing.solid_fraction(one, "rods", rods=200_000) for one in two]
    np.testing.assert_allclose(cpm, [0.689, 0.737, 0.762, 0.780, 0.796], atol=5e-4)
    np.testing.assert_allclose(mixed, [0.673, 0.755, 0.829, 0.848, 0.855], atol=6e-4)
    np.testing.assert_allclose(rods, [0.6817, 0.7831, 0.8267, 0.8445, 0.8521], atol=2e-4)


@pytest.mark.parametrize("coarse", [0.3, 0.5, 0.7, 0.9])
def test_the_linear_mixture_model_agrees_with_westman_and_furnas(coarse: float) -> None:
    alone = 1.0 / 0.6435
    near = 1.0 / packing.solid_fraction(cm.gap_graded(1.0, 0.5, coarse), "linear-mixture", packing=0.6435)
    assert near == pytest.approx(westman_volume(coarse, alone, alone, 0.5), abs=2e-3)
    far = 1.0 / packing.solid_fraction(cm.gap_graded(1.0, 1e-9, coarse), "linear-mixture", packing=0.6435)
    assert far == pytest.approx(furnas_volume(coarse, alone, alone), abs=1e-6)


def test_the_mixing_terms_of_the_linear_mixture_model_end_near_0() -> None:
    end, rho = np.array([0.741]), 0.6
    assert quadratic_term(end)[0] * 10 ** (-1.4566 * rho) == pytest.approx(1e-4, abs=2e-5)
    fourth = -1.3092 + 15.039 * rho - 37.453 * rho**2 + 40.869 * rho**3 - 17.110 * rho**4
    assert fourth * cubic_term(end)[0] == pytest.approx(3e-3, abs=4e-4)
    assert quadratic_term(end + 1e-9)[0] == cubic_term(end + 1e-9)[0] == 0.0


def test_rods_of_one_size_and_of_lognormal_spheres() -> None:
    assert packing.solid_fraction(cm.monodisperse(1.0), "rods", rods=400_000) == pytest.approx(0.64349, abs=5e-5)
    for sd, stated in ((0.1, 0.6469), (0.3, 0.6713), (0.5, 0.7073), (1.0, 0.8014), (1.5, 0.8740)):
        by_number = cm.lognormal(float(np.exp(3.0 * sd**2)), sd)  # median 1 by number
        found = packing.solid_fraction(by_number, "rods", rods=200_000)
        wave = np.cos(2 * np.pi * (1 - np.exp(-0.75 * sd**0.7 - 0.025 * sd**4))) - 1.0
        closed = 1 - 0.57 * np.exp(-sd) + 0.2135 * np.exp(-0.57 * sd / 0.2135) + 0.0019 * wave
        assert found == pytest.approx(stated, abs=2e-4)
        assert found == pytest.approx(closed, abs=2e-4)


def test_narrow_spheres() -> None:
    assert packing.narrow_spheres(cm.monodisperse(1.0)) == pytest.approx(0.634, abs=1e-15)
    # half of the grains, counted, are twice as large: d = 1/3, S = 0
    shares = np.array([8.0, 1.0]) / 9.0
    two = cm.gap_graded(2.0, 1.0, float(shares[0]))
    assert packing.narrow_spheres(two) == pytest.approx(0.634 + 0.0658 / 3, abs=1e-12)


@pytest.mark.parametrize("model", ["cpm", "lpm", "linear-mixture"])
@pytest.mark.parametrize("name", GRADINGS)
def test_calibration_gives_back_what_was_measured(name: str, model: Any) -> None:
    beta = packing.calibrate(GRADINGS[name], 0.31, model)
    assert packing.void_ratio(GRADINGS[name], model, packing=beta) == pytest.approx(0.31, rel=1e-9)
    assert packing.void_ratio(GRADINGS[name], model, packing=beta) <= packing.separated_void_ratio(
        GRADINGS[name], model, packing=beta
    ) * (1.0 + 1e-12)


def test_vanishing_and_empty_classes() -> None:
    plain = packing.solid_fraction(exact([1.0, 0.1], [0.7, 0.3]))
    with_empty = packing.solid_fraction(exact([1.0, 0.5, 0.1], [0.7, 0.0, 0.3]))
    little = packing.solid_fraction(exact([1.0, 0.5, 0.1], [0.7 - 1e-12, 1e-12, 0.3]))
    assert with_empty == pytest.approx(plain, rel=1e-15)
    assert little == pytest.approx(plain, rel=1e-9)
    models: tuple[Any, ...] = ("lpm", "linear-mixture")
    for model in models:
        found = packing.solid_fraction(exact([1.0, 0.5, 0.1], [0.7, 0.0, 0.3]), model)
        assert found == pytest.approx(packing.solid_fraction(exact([1.0, 0.1], [0.7, 0.3]), model), rel=1e-14)
    all_in_one = packing.solid_fraction(exact([1.0, 0.1], [1.0, 0.0]))
    assert all_in_one == pytest.approx(0.6, rel=1e-15)


def test_packing_by_size() -> None:
    two = cm.gap_graded(1.0, 0.01, 0.5)
    one = packing.solid_fraction(two, packing={1.0: 0.66, 0.01: 0.58})
    assert packing.solid_fraction(two, packing=0.58) < one < packing.solid_fraction(two, packing=0.66)
    assert packing.solid_fraction(two, packing={5.0: 0.6}) == packing.solid_fraction(two, packing=0.6)
    apart = packing.separated_void_ratio(two, packing={1.0: 0.66, 0.01: 0.58})
    alone = [packing.void_ratio(cm.monodisperse(1.0), packing=beta) for beta in (0.66, 0.58)]
    assert apart == pytest.approx(np.mean(alone), rel=1e-12)


def test_the_size_of_unresolved_fines_matters_little_where_they_are_few() -> None:
    fine = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100.0, 60.0, 25.0, 4.0])
    assert -0.02 < packing.fines_effect(fine) < 0.0  # the finer they are, the better they fill


REFUSED = [
    (lambda: packing.solid_fraction(cm.fuller(1.0), packing=1.0), "packing is 1; it must be between 0 and 1"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), packing=0.0), "packing is 0"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), packing={-1.0: 0.6}), "sizes must be greater than 0"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), packing={}), "an empty mapping"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), compaction=0.0), "compaction is 0"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), classes=0), "classes is 0"),
    (lambda: packing.solid_fraction(cm.fuller(1.0), "cmp"), "model is 'cmp'"),  # type: ignore[arg-type]
    (
        lambda: packing.solid_fraction(cm.power_law(2.5, 0.0, 1.0), "rods"),
        "dimension 2.5: a line meets infinitely many",
    ),
    (lambda: packing.solid_fraction(cm.fuller(1.0), "rods", rods=1), "rods is 1"),
    (lambda: packing.narrow_spheres(cm.power_law(2.5, 0.0, 1.0)), "has no mean size by number"),
    (
        lambda: packing.calibrate(cm.monodisperse(1.0), 0.1),
        "void_ratio is 0.1, and this grading has 0.111 at the least",
    ),
    (lambda: packing.calibrate(cm.fuller(1.0), -0.5), "void_ratio is -0.5"),
    (lambda: packing.calibrate(cm.fuller(1.0), 0.5, packing=0.6), "it is what is looked for"),
    (lambda: packing.calibrate(cm.fuller(1.0), 0.5, "rods"), "they have no free number"),
]


@pytest.mark.parametrize(("call", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_is_refused(call: Any, message: str) -> None:
    with pytest.raises(cm.ParameterError, match=message):
        call()


@pytest.mark.parametrize(
    ("width", "expected"),
    [
        (0.05, (0.366, 0.359, 0.353, 0.347, 0.339)),
        (0.2, (0.366, 0.337, 0.311, 0.287, 0.252)),
        (0.5, (0.366, 0.300, 0.252, 0.202, 0.124)),
    ],
)
def test_void_ratios_of_the_papers_parameters(width: float, expected: tuple[float, ...]) -> None:
    run = cm.Simulation(cm.Material(fabric_width=width), cm.monodisperse(1.0)).run([1.0, 2.0, 10.0, 100.0, 1e4])
    np.testing.assert_allclose(run.void_ratio(packing=2 / 3), expected, atol=6e-4)  # to their three digits
    assert run.void_ratio(initial=2 / 3) == pytest.approx(run.void_ratio(packing=2 / 3), abs=1e-9)


def test_void_ratios_of_a_narrow_start() -> None:
    grains = cm.Material(fabric_width=0.2, reference_size=2.0)
    run = cm.Simulation(grains, cm.lognormal(1.0, 0.2)).run([0.0, 1.0, 2.0, 10.0, 100.0, 1e4])
    expected = [0.579, 0.579, 0.533, 0.338, 0.298, 0.258]
    np.testing.assert_allclose(run.void_ratio(packing=2 / 3), expected, atol=6e-4)


def test_a_fabric_switched_off_keeps_its_void_ratio() -> None:
    grains = cm.Material(fabric_width=np.inf, fragments=cm.PowerLawFragments(1.0))
    run = cm.Simulation(grains, cm.monodisperse(1.0)).run(stress_ratio=[2.0, 10.0, 100.0])
    assert np.ptp(run.void_ratio()) < 1e-3
    even = packing.void_ratio(cm.power_law(2.0, 0.0, 1.0))  # what is left is U(0, s_c)
    assert run.void_ratio() == pytest.approx(even, abs=1.5e-3)
    wide = cm.Simulation(cm.Material(fabric_width=5.0), cm.monodisperse(1.0)).run(stress_ratio=[10.0, 100.0])
    assert wide.void_ratio(packing=2 / 3) == pytest.approx(0.321, abs=6e-4)


def test_plots_of_compression() -> None:
    pytest.importorskip("matplotlib")
    sand = cm.Material(fabric_width=0.3, first_crush_stress=5.0)
    run = cm.Simulation(sand, cm.lognormal(1.0, 0.2)).run(stress=np.geomspace(1.0, 100.0, 12))
    figure = run.plot_compression(0.7, measured=([0.0, 10.0, 30.0], [0.7, 0.65, 0.6]), log_void_ratio=True)
    axes = figure.axes[0]
    assert re.match("stress", axes.get_xlabel())
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), run.void_ratio(0.7))
    assert np.size(axes.lines[2].get_xdata()) == 2  # a load of 0 has no place on a log axis
    with pytest.raises(cm.ParameterError, match="give one of initial or packing"):
        run.void_ratio(0.7, packing=0.6)

"""Indices against independent oracles, published formulas and numbers worked by hand; and what units may not change."""

import math
from collections.abc import Callable
from itertools import pairwise

import fluids.particle_size_distribution as oracle
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate

import comminute as cm
from comminute.gradings import breakage

CEN = cm.Grading.from_sieves([2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1], unit="mm")
FINE = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25, 0.063, 0.02], [100, 90, 66, 40, 12, 0], unit="mm")


def area_under(f: Callable[[float], float], low: float, high: float) -> float:
    return float(integrate.quad(f, low, high, epsabs=1e-12)[0])


@st.composite
def curves(draw: st.DrawFn, bottom: float = 0.0) -> cm.SizeCurve:
    count = draw(st.integers(2, 12))
    steps = draw(st.lists(st.floats(0.05, 1.5), min_size=count, max_size=count))
    shares = np.array(draw(st.lists(st.floats(0.01, 1.0), min_size=count, max_size=count)))
    shares[0] = bottom
    finer = 100 * np.cumsum(shares) / shares.sum()
    finer[-1] = 100.0
    return cm.SizeCurve.of(cm.Grading.from_sieves(list(0.01 * np.exp(np.cumsum(steps))), list(finer), "mm"))


def test_sieve_series_agree_with_a_table_of_others() -> None:
    for name, theirs in (("ISO R20/3", oracle.ISO_3310_1_R20_3), ("ISO R40/3", oracle.ISO_3310_1_R40_3)):
        np.testing.assert_allclose(cm.sieve_sizes(name, "m"), [sieve.opening for sieve in theirs], rtol=1e-12)
    openings = sorted(sieve.opening for sieve in oracle.ASTM_E11_sieves.values())
    np.testing.assert_allclose(sorted(cm.sieve_sizes("ASTM E11", "m")), openings, rtol=1e-12)
    for sieve in oracle.ASTM_E11_sieves.values():
        old = sieve.old_designation
        if old and "." not in old:
            assert cm.sieve_size(old) == pytest.approx(1e3 * sieve.opening, rel=1e-12), old
    with pytest.raises(cm.ParameterError, match=r"series is 'Tyler'; it must be one of 'ISO R20/3', 'ISO R40/3'"):
        cm.sieve_sizes("Tyler")


def test_rosin_rammler_percentiles_have_a_closed_form() -> None:
    law = cm.rosin_rammler(0.8, 1.3, largest=50.0)
    for percent in (1, 10, 50, 90):
        closed = 0.8 * (-math.log(1 - percent / 100)) ** (1 / 1.3)
        assert law.percentile(percent) == pytest.approx(closed, rel=1e-12)


def test_percentiles_agree_with_the_oracle_on_a_lognormal_grading() -> None:
    theirs = oracle.PSDLognormal(d_characteristic=0.5, s=0.4)
    ours = cm.lognormal(0.5, 0.4, largest=50.0)
    for percent in (5, 16, 50, 84, 95):
        assert ours.percentile(percent) == pytest.approx(theirs.dn(percent / 100), rel=1e-8)


def test_coefficients_by_hand() -> None:
    # CEN sand, linear in ln d between its sieves
    d10 = 0.08 * 2 ** (9 / 12)
    d30 = 0.16 * (0.5 / 0.16) ** (17 / 20)
    d60 = 0.5 * 2 ** (27 / 34)
    assert cm.uniformity(CEN) == pytest.approx(d60 / d10, rel=1e-13)
    assert cm.curvature(CEN) == pytest.approx(d30**2 / d10 / d60, rel=1e-13)
    assert CEN.percentile(100) == 2.0
    assert CEN.percentile(93) == 1.6
    with pytest.raises(cm.ParameterError, match=r"D0\.5 lies below the finest sieve, 0\.08 mm, which 1 % are finer"):
        CEN.percentile(0.5)
    assert CEN.percentile(0.5, extrapolate=True) == pytest.approx(0.08 * 0.5 ** (math.log(2) / math.log(13)))
    assert cm.fines_share(CEN, 0.5) == 0.33
    gap = cm.gap_graded(1.0, 0.1)
    assert gap.percentile(50) == 0.1  # the lower end of the plateau
    assert cm.SizeCurve.of(gap).percentile(50) == 0.1


def test_folk_and_ward_by_their_own_formulas() -> None:
    # uniform in phi between -1 and 3: phi_x = -1 + 4 x / 100
    sand = cm.Grading.from_sieves([2.0, 0.125], [100, 0], unit="mm")
    found = cm.folk_ward(sand)
    assert found.mean == pytest.approx(1.0)
    assert found.sorting == pytest.approx(4 * 0.68 / 4 + 4 * 0.9 / 6.6)
    assert found.skewness == pytest.approx(0.0, abs=1e-12)
    assert found.kurtosis == pytest.approx(0.9 / (2.44 * 0.5))
    metric = cm.folk_ward(sand, scale="metric")
    assert metric.mean == pytest.approx(0.5)
    # the geometric measures of GRADISTAT: P_x is the size that x per cent are finer than
    p5, p16, p50, p84, p95 = (CEN.percentile(x) for x in (5, 16, 50, 84, 95))
    metric = cm.folk_ward(CEN, scale="metric")
    assert metric.mean == pytest.approx(math.exp((math.log(p16) + math.log(p50) + math.log(p84)) / 3))
    spread = math.log(p84 / p16) / 4 + math.log(p95 / p5) / 6.6
    assert metric.sorting == pytest.approx(math.exp(spread))
    skew = (math.log(p16) + math.log(p84) - 2 * math.log(p50)) / (2 * (math.log(p84) - math.log(p16)))
    skew += (math.log(p5) + math.log(p95) - 2 * math.log(p50)) / (2 * (math.log(p95) - math.log(p5)))
    assert metric.skewness == pytest.approx(-skew)
    assert cm.folk_ward(CEN).skewness == pytest.approx(-skew)


def test_folk_and_ward_of_a_beach_sand_as_another_program_has_them() -> None:
    # sample WN2 of the tests of grainsizeR 0.3 (C.-S. G. Chang), with the numbers printed there
    openings = [2, 1, 0.5, 0.25, 0.125, 0.0625, 0.047256696, 0.034866183, 0.022853437, 0.013330233]
    retained = [0.006241215, 0.009783525, 0.015799831, 0.191003655, 0.268428451, 0.364970481, 0.02396214]
    retained += [0.041933746, 0.035943211, 0.01198107]
    pan = 0.029952675
    passing = 100.0 * (1.0 - np.cumsum(retained) / (sum(retained) + pan))
    sand = cm.Grading.from_sieves([4.0, *openings], [100.0, *passing], unit="mm")
    found = cm.folk_ward(sand)
    theirs = (2.883519, 1.210441, -0.049325, 1.075632)
    np.testing.assert_allclose((found.mean, found.sorting, found.skewness, found.kurtosis), theirs, atol=6e-7)
    metric = cm.folk_ward(sand, scale="metric")
    assert 1e3 * metric.mean == pytest.approx(135.511, abs=6e-4)
    assert metric.sorting == pytest.approx(2.0**1.210441, rel=1e-6)  # GRADISTAT's geometric sorting is 2**sorting
    assert (metric.skewness, metric.kurtosis) == pytest.approx((found.skewness, found.kurtosis))


def test_a_percentile_beyond_empty_sieves_as_another_program_has_it() -> None:
    # sample Q3 of G2Sd (R. K. Gallon, J. Fournier, after GRADISTAT), whose D95 the tests of grainsizeR quote
    openings = [25000, 20000, 16000, 12500, 10000, 8000, 6300, 5000, 4000, 2500, 2000, 1600, 1250, 1000]
    openings += [800, 630, 500, 400, 315, 250, 200, 160, 125, 100, 80, 63, 50, 40]
    retained = [0, 0, 0, 0, 2.2, 0, 0, 0, 0, 0.3, 0.1, 0.4, 1.0, 1.3]
    retained += [1.6, 1.7, 2.45, 2.1, 2.3, 2.7, 2.6, 2.7, 2.4, 2.1, 2.1, 1.3, 0.7, 0.1]
    passing = 100.0 * (1.0 - np.cumsum(retained) / (sum(retained) + 1.9))
    sand = cm.Grading.from_sieves(openings, list(np.where(np.cumsum(retained) == 0.0, 100.0, passing)), unit="um")
    assert sand.percentile(95) == pytest.approx(10517.56, abs=6e-3)


@pytest.mark.parametrize("curve", [CEN, FINE, cm.fuller(16.0).with_unit("mm"), cm.lognormal(0.5, 1.0).with_unit("mm")])
def test_hardin_against_quadrature(curve: cm.Grading) -> None:
    # by parts: B_p = b_p(top) - the integral of F d b_p
    top = curve.largest
    steps = [0.074, *[s for s in (0.08, 0.16, 0.25, 0.5, 1.0, 1.6) if s < top], top]
    area = sum(area_under(lambda x: curve.finer(math.exp(x)), math.log(a), math.log(b)) for a, b in pairwise(steps))
    exact = math.log10(top / 0.074) - area / math.log(10)
    assert cm.breakage_potential(curve) == pytest.approx(exact, rel=2e-7)


def test_hardin_by_hand() -> None:
    coarse = cm.Grading.from_sieves([7.4, 0.74], [100, 0], unit="mm")  # b_p even between 1 and 2
    half = cm.Grading.from_sieves([0.74, 0.0074], [100, 0], unit="mm")  # half of it below 0.074 mm
    assert cm.breakage_potential(coarse) == pytest.approx(1.5)
    assert cm.breakage_potential(half) == pytest.approx(0.25)
    assert cm.relative_breakage(coarse, half) == pytest.approx(1.25 / 1.5)
    with pytest.raises(cm.ParameterError, match="unit is ''; Hardin's breakage potential needs sizes in a known unit"):
        cm.breakage_potential(cm.fuller(16.0))


@pytest.mark.parametrize("smallest", [0.0, 0.01])
def test_einav_against_quadrature(smallest: float) -> None:
    before, after = CEN, FINE
    top = 2.0

    def ultimate(d: float) -> float:
        return float(max(d**0.4 - smallest**0.4, 0.0) / (top**0.4 - smallest**0.4))

    cuts = np.log([1e-12, 1e-6, 0.01, 0.02, 0.063, 0.08, 0.16, 0.25, 0.5, 1.0, 1.6, 2.0])

    def area(f: cm.Grading | None) -> float:
        def g(x: float) -> float:
            d = math.exp(x)
            return (ultimate(d) if f is None else f.finer(d)) - before.finer(d)

        return sum(area_under(g, a, b) for a, b in pairwise(cuts))

    found = cm.breakage_index(before, after, smallest=smallest)
    assert found.index == pytest.approx(area(after) / area(None), rel=1e-4)
    assert (found.smallest, found.largest, found.fractal_dimension) == (smallest, 2.0, 2.6)

    def square(f: cm.Grading) -> float:
        return 4.0 - sum(area_under(lambda d: 2 * d * f.finer(d), a, b) for a, b in pairwise(np.exp(cuts)))

    law = cm.power_law(2.6, smallest, 2.0)
    assert found.grading_index == pytest.approx(1 - square(law) / square(before), rel=1e-9)


def test_einav_may_exceed_one_and_refuses_what_has_no_meaning() -> None:
    start = cm.monodisperse(1.0)
    assert cm.breakage_index(start, cm.monodisperse(0.01)).index > 1.0
    with pytest.raises(cm.ParameterError, match="fractal_dimension is 3; it must be less than 3"):
        cm.breakage_index(start, start, fractal_dimension=3.0)
    with pytest.raises(cm.ParameterError, match="before is in 'mm' and after in ''; bring them to one unit"):
        cm.breakage_index(CEN, start)
    with pytest.raises(cm.ParameterError, match="the index needs a start that is coarser"):
        cm.breakage_index(cm.fuller(1.0, 0.2), start)


def test_fractal_dimension_and_milling() -> None:
    fit = cm.fractal_dimension(cm.fuller(16.0, 0.45), 0.1, 10.0)
    assert fit.dimension == pytest.approx(2.55)
    assert fit.r_squared == pytest.approx(1.0)
    assert (fit.smallest, fit.largest) == (0.1, 10.0)
    x, y = np.log([0.16, 0.5, 1.0, 1.6]), np.log([0.13, 0.33, 0.67, 0.93])
    assert cm.fractal_dimension(CEN, 0.1, 1.9).dimension == pytest.approx(3 - np.polyfit(x, y, 1)[0])
    assert cm.fractal_dimension(CEN, 0.1, 1.9).r_squared == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2)
    with pytest.raises(cm.ParameterError, match=r"the window 1 to 1\.2 holds 1 points of the curve"):
        cm.fractal_dimension(CEN, 1.0, 1.2)
    parent = cm.Grading.from_sieves([16.0, 11.2], [100, 0])
    product = cm.Grading.from_sieves([16.0, 4.0, 1.0, 0.25], [100, 60, 20, 0])
    done = cm.milling(parent, product)
    assert done.parent == pytest.approx(math.sqrt(16 * 11.2))
    assert done.f80 == pytest.approx(11.2 * (16 / 11.2) ** 0.8)
    assert done.p80 == pytest.approx(8.0)
    assert done.t10 == pytest.approx(20 + 40 * math.log(done.parent / 10) / math.log(4))


@given(curve=curves(), unit=st.sampled_from(["um", "m", "in", "cm"]))
def test_a_change_of_unit_changes_no_ratio_and_scales_every_size(curve: cm.SizeCurve, unit: str) -> None:
    other = curve.in_unit(unit)
    scale = other.size[-1] / curve.size[-1]
    for index in (cm.uniformity, cm.curvature, cm.breakage_potential):
        assert index(other) == pytest.approx(index(curve), rel=1e-9, abs=1e-12)
    for percent in (10, 50, 80):
        assert other.percentile(percent) == pytest.approx(scale * curve.percentile(percent), rel=1e-9)
    ours, theirs = cm.folk_ward(curve), cm.folk_ward(other)
    np.testing.assert_allclose(
        [ours.mean, ours.sorting, ours.skewness, ours.kurtosis],
        [theirs.mean, theirs.sorting, theirs.skewness, theirs.kurtosis],
        rtol=1e-7,
        atol=1e-9,
    )
    metric = cm.folk_ward(other, scale="metric")
    assert metric.mean == pytest.approx(scale * cm.folk_ward(curve, scale="metric").mean, rel=1e-9)
    finer = cm.SizeCurve(0.1 * curve.size, curve.finer, curve.unit)
    assert (
        cm.breakage_index(other, finer.in_unit(unit)).index
        == pytest.approx(cm.breakage_index(curve, finer).index, rel=1e-7)
        if breakage.mean_log(curve) > math.log(curve.size[-1]) - 2.4
        else True
    )
    np.testing.assert_allclose(other.number_finer().finer, curve.number_finer().finer, rtol=1e-7, atol=1e-12)


@given(curve=curves(bottom=0.3))
def test_grading_to_sieves_to_grading(curve: cm.SizeCurve) -> None:
    grading = cm.Grading.from_sieves(list(curve.size), list(100 * curve.finer), "mm")
    table = grading.to_sieves(curve.size)
    again = cm.Grading.from_sieves(*table[:3])
    sizes = np.geomspace(curve.size[0] / 5, curve.size[-1], 30)
    np.testing.assert_allclose(again.finer(sizes), grading.finer(sizes), rtol=1e-9)
    assert table.percent_retained.sum() + table.pan == pytest.approx(100.0)
    for percent in (5, 35, 60, 100):
        by_curve = cm.SizeCurve.of(grading).percentile(percent, extrapolate=True)
        assert by_curve == pytest.approx(grading.percentile(percent, extrapolate=True), rel=1e-9)


def test_to_sieves_takes_the_part_of_a_series_that_says_something() -> None:
    table = CEN.to_sieves("ISO R20/3")
    assert table.size[0] == 2.0
    assert table.size[-1] == 0.045
    narrow = cm.Grading.from_sieves([0.6, 0.3], [100, 0], unit="mm").to_sieves("iso r40/3")
    np.testing.assert_array_equal(narrow.size, [0.6, 0.5, 0.425, 0.355, 0.3])
    np.testing.assert_allclose(
        CEN.to_sieves("ASTM E11").percent_finer[:2], [100.0, 93 + 7 * math.log(1.7 / 1.6) / math.log(1.25)]
    )
    with pytest.raises(cm.ParameterError, match="the largest grain, 200 mm, stays on the coarsest sieve, 125 mm"):
        cm.fuller(200.0).with_unit("mm").to_sieves("ISO R20/3")
    with pytest.raises(cm.ParameterError, match="unit is ''; it must be one of"):
        cm.fuller(16.0).to_sieves("ISO R20/3")


@pytest.mark.parametrize(
    "grading",
    [
        cm.uniform_size(0.1, 2.0),
        cm.power_law(2.5, 1e-3, 1.0),
        cm.lognormal(0.5, 0.4),
        cm.power_law(3.4, 0.01, 1.0),
        cm.fuller(2.0),
        cm.log_uniform(0.1, 1.0),
    ],
    ids=repr,
)
def test_percentiles_of_laws_are_inverse(grading: cm.Grading) -> None:
    percents = [1, 10, 50, 90, 99]
    np.testing.assert_allclose(grading.finer(grading.percentile(percents)), np.divide(percents, 100), rtol=1e-9)

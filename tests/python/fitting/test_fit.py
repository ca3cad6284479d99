"""Parameters found from gradings that a run, a lattice or a file has given."""

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import comminute as cm
from comminute.cases.reading import read_case
from comminute.cases.running import run_case

Floats = npt.NDArray[np.float64]
SIEVES = np.array([2.0, 1.6, 1.0, 0.5, 0.25, 0.125, 0.063, 0.032])
START = cm.Grading.from_sieves([2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1], unit="mm")
TRUE = cm.Material(reference_size=2.0, fabric_width=0.35, weibull_modulus=4.0, first_crush_stress=2.0)
VALUES = {"fabric_width": 0.35, "weibull_modulus": 4.0, "first_crush_stress": 2.0}
STRESSES = (5.0, 10.0, 20.0, 40.0, 80.0)


def crushed(
    material: cm.Material = TRUE, start: cm.Grading = START, stresses: tuple[float, ...] = STRESSES, **run: Any
) -> list[cm.Measurement]:
    """Gradings of a run on its own grid, which no fit has."""
    result = cm.Simulation(material, start).run(stress=list(stresses), **run)
    return [
        cm.Measurement(stress, SIEVES, result.curve(k).finer_than(SIEVES), unit="mm")
        for k, stress in enumerate(stresses)
    ]


def noisy(data: list[cm.Measurement], seed: int, sd: float = 0.01) -> list[cm.Measurement]:
    """Add errors of measurement at all sieves, tails among them."""
    rng = np.random.default_rng(seed)
    return [
        cm.Measurement(one.stress, one.size, one.finer + sd * rng.standard_normal(one.size.size), one.unit)
        for one in data
    ]


def test_twenty_calibrations_find_the_truth_in_their_intervals() -> None:
    data = crushed()
    inside = dict.fromkeys(VALUES, 0)
    for seed in range(20):
        found = cm.fit(noisy(data, seed), START, cm.Material(reference_size=2.0), starts=2)
        for name, (low, high) in found.intervals.items():
            inside[name] += low < VALUES[name] < high
        assert 0.6 * 0.01 < found.rms < 1.4 * 0.01
    assert all(count >= 17 for count in inside.values()), inside


def test_intervals_are_no_wider_than_the_scatter_of_fits() -> None:
    # Intervals that always hold the truth could be far too wide: their widths are those of the fits' own scatter.
    data = crushed()
    fits = [cm.fit(noisy(data, seed), START, cm.Material(reference_size=2.0), starts=1) for seed in range(20, 50)]
    for p in range(3):
        scatter = np.std([one.vector[p] for one in fits], ddof=1)
        stated = np.mean([np.sqrt(one.covariance[p, p]) for one in fits])
        assert 0.6 < stated / scatter < 1.6  # a standard deviation of thirty fits is known to 13 %


def test_profiles_of_a_nearly_linear_problem_are_the_intervals_of_the_covariance() -> None:
    data = noisy(crushed(), 3, sd=0.001)
    given: Any = {"start": START, "material": cm.Material(reference_size=2.0), "error": 0.001, "starts": 1}
    by_covariance = cm.fit(data, **given)
    by_profile = cm.fit(data, intervals="profile", **given)
    assert by_profile.interval_kind == "profile"
    for name, ends in by_covariance.intervals.items():
        widths = np.log(np.array(ends) / by_covariance.values[name])
        others = np.log(np.array(by_profile.intervals[name]) / by_profile.values[name])
        np.testing.assert_allclose(others, widths, rtol=0.1)


def test_an_end_of_a_profile_is_where_the_best_cost_has_risen_by_that_of_a_confidence() -> None:
    data = noisy(crushed(stresses=(5.0, 20.0)), 1)
    material = cm.Material(reference_size=2.0)
    found = cm.fit(data, START, material, intervals="profile", starts=2)
    low, _ = found.intervals["weibull_modulus"]
    fixed = cm.Material(reference_size=2.0, weibull_modulus=low)
    at_end = cm.fit(data, START, fixed, free=["fabric_width", "first_crush_stress"], starts=2)
    assert at_end.chi2 - found.chi2 == pytest.approx(3.84 * max(1.0, found.chi2 / found.freedom), rel=0.1)


@pytest.mark.parametrize(
    ("name", "value"),
    [("fragment_scale", 0.8), ("fragment_shape", 1.4), ("loading_rate", 0.3), ("weibull_modulus", 7.0)],
)
def test_every_parameter_is_found_from_exact_data(name: str, value: float) -> None:
    law = {"fragment_scale": {"scale": value}, "fragment_shape": {"shape": value}}.get(name, {})
    modulus = value if name == "weibull_modulus" else 4.0
    true = cm.Material(
        reference_size=2.0,
        fabric_width=0.35,
        weibull_modulus=modulus,
        first_crush_stress=2.0,
        fragments=cm.WeibullFragments(**law),
    )
    data = crushed(true, loading_rate=value if name == "loading_rate" else 0.0)
    known = cm.Material(reference_size=2.0, weibull_modulus=4.0)
    found = cm.fit(data, START, known, free=["fabric_width", "first_crush_stress", name])
    assert found.values[name] == pytest.approx(value, rel=0.02)
    assert found.values["fabric_width"] == pytest.approx(0.35, rel=0.02)
    assert found.rms < 5e-4  # the search has wider bins than the run that made the data


def test_specimens_with_starts_of_their_own_and_in_other_units() -> None:
    coarse = cm.Grading.from_sieves([2000.0, 1000.0, 500.0], [100, 40, 0], unit="um")
    as_mm = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 40, 0], unit="mm")
    data = [*crushed(stresses=(10.0,)), *crushed(start=as_mm, stresses=(10.0, 40.0))]
    given = [data[0], *(cm.Measurement(one.stress, one.size, one.finer, "mm", start=coarse) for one in data[1:])]
    found = cm.fit(given, START, cm.Material(reference_size=2.0), starts=2)
    for name, value in VALUES.items():
        assert found.values[name] == pytest.approx(value, rel=0.05)
    assert [one.unit for one in found.starts] == ["mm", "mm"]


def test_a_start_without_a_unit_takes_that_of_the_data() -> None:
    start = cm.power_law(2.3, 0.05, 2.0)
    data = crushed(start=start)
    found = cm.fit(data, start, cm.Material(reference_size=2.0))
    assert found.starts[0].unit == "mm"
    assert found.values["first_crush_stress"] == pytest.approx(2.0, rel=0.02)


def test_a_start_that_nobody_measured_is_found_with_the_rest() -> None:
    start = cm.lognormal(0.7, 0.5, largest=2.0)
    prior = cm.UnknownStart(median=0.6, sd_log=0.6, largest=2.0)
    known = cm.Material(reference_size=2.0, weibull_modulus=4.0)
    free = ["fabric_width", "first_crush_stress"]
    found = cm.fit(crushed(start=start), prior, known, free, starts=2, error=0.002)
    assert found.values["start_median"] == pytest.approx(0.7, rel=0.03)
    assert found.values["start_sd_log"] == pytest.approx(0.5, rel=0.05)
    assert found.values["fabric_width"] == pytest.approx(0.35, rel=0.05)
    # A prior that is far narrower than what the data say holds the start where it was.
    tight = cm.UnknownStart(median=0.6, sd_log=0.6, largest=2.0, median_error=1e-4, sd_log_error=1e-4)
    held = cm.fit(crushed(start=start), tight, known, free, starts=1)
    assert held.values["start_median"] == pytest.approx(0.6, rel=1e-3)


def test_flat_and_noisy_tails_are_taken_as_they_are() -> None:
    data = [
        cm.Measurement(one.stress, one.size, one.finer + np.where(one.size > 1.5, 0.01, -0.004), one.unit)
        for one in crushed()
    ]
    assert data[0].finer.max() > 1.0
    falling = cm.Measurement(10.0, [2.0, 1.0, 0.5, 0.25], [1.0, 0.84, 0.53, 0.535], unit="mm")
    found = cm.fit([*data, falling], START, cm.Material(reference_size=2.0))
    assert found.values["fabric_width"] == pytest.approx(0.35, rel=0.15)


def test_likelihood_is_that_of_independent_errors() -> None:
    data = noisy(crushed(stresses=(10.0, 40.0)), 0)
    found = cm.fit(data, START, cm.Material(reference_size=2.0), starts=1)
    run = cm.Simulation(TRUE, START).run(stress=[10.0, 40.0])
    gaps = np.concatenate([run.curve(k).finer_than(one.size) - one.finer for k, one in enumerate(data)])
    expected = -0.5 * np.sum((gaps / 0.01) ** 2)
    assert found.problem.log_likelihood(VALUES) == pytest.approx(expected, rel=0.02)
    assert found.problem.log_likelihood(found.values) == pytest.approx(-0.5 * found.chi2)
    assert found.problem.log_likelihood(VALUES | {"fabric_width": 20.0}) == -np.inf


def test_parameters_that_the_data_cannot_tell_are_named() -> None:
    one_curve = crushed(stresses=(5.0,))
    with pytest.warns(cm.FitWarning) as said:
        cm.fit(one_curve, START, cm.Material(reference_size=2.0))
    words = " ".join(str(one.message) for one in said)
    assert "weibull_modulus and first_crush_stress can hardly be told apart (correlation 1.000)" in words
    nothing = [cm.Measurement(0.5, SIEVES, START.finer(SIEVES), unit="mm")]
    sound = cm.Material(reference_size=2.0, first_crush_stress=5.0)
    with pytest.warns(cm.FitWarning) as said:
        found = cm.fit(nothing, START, sound, free=["fabric_width"], starts=1, intervals="profile")
    words = " ".join(str(one.message) for one in said)
    assert "hardly tell fabric_width" in words
    assert "do not bound fabric_width on both sides" in words
    assert found.intervals["fabric_width"] == (0.01, 10.0)


MATERIAL = cm.Material(reference_size=2.0)
PAIR = [(5.0, cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 70, 20], unit="mm"))]


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda: cm.fit([], START, MATERIAL), cm.ParameterError, r"data is empty; give \(stress, grading\)"),
        (lambda: cm.fit([5.0], START, MATERIAL), TypeError, r"data\[0\] is a float"),  # type: ignore[list-item]
        (lambda: cm.fit(PAIR, None, MATERIAL), cm.ParameterError, r"start is missing for data\[0\]"),
        (lambda: cm.fit(PAIR, START), TypeError, "material is a NoneType"),
        (lambda: cm.fit(PAIR, START, MATERIAL, free=[]), cm.ParameterError, "free is empty"),
        (lambda: cm.fit(PAIR, START, MATERIAL, free="fabric_width"), TypeError, r"must be a list of names"),
        (
            lambda: cm.fit(PAIR, START, MATERIAL, free=["first_crush_stress", "reference_size"]),
            cm.ParameterError,
            r"only first_crush_stress reference_size\*\*\(3 / weibull_modulus\) can be told",
        ),
        (lambda: cm.fit(PAIR, START, MATERIAL, free=["strength"]), cm.ParameterError, "free names 'strength'"),
        (
            lambda: cm.fit(PAIR, START, MATERIAL, free=["fabric_width", "fabric_width"]),
            cm.ParameterError,
            "free names 'fabric_width' twice",
        ),
        (lambda: cm.fit(PAIR, START, MATERIAL, free=["fabric_width"]), cm.ParameterError, "is neither set nor free"),
        (
            lambda: cm.fit(PAIR, START, MATERIAL, free=["loading_rate"], closure="resolved"),
            cm.ParameterError,
            "only closure 'paper' knows a loading rate",
        ),
        (
            lambda: cm.fit(PAIR, START, MATERIAL, free=["first_crush_stress"], loads="stress_ratio"),
            cm.ParameterError,
            "loads are stress ratios, which have no stress",
        ),
        (
            lambda: cm.fit(PAIR, START, cm.Material(fragments=cm.PowerLawFragments(2.0)), free=["fragment_scale"]),
            cm.ParameterError,
            "the material has PowerLawFragments",
        ),
        (
            lambda: cm.fit(
                PAIR, START, MATERIAL, free=["fabric_width", "weibull_modulus", "first_crush_stress", "fragment_scale"]
            ),
            cm.ParameterError,
            "free has 4 parameters; 3 numbers were measured: free fewer",
        ),
        (lambda: cm.fit(PAIR, START, MATERIAL, error=0.0), cm.ParameterError, "error is 0"),
        (lambda: cm.fit(PAIR, START, MATERIAL, starts=0), cm.ParameterError, "starts is 0"),
        (lambda: cm.fit(PAIR, START, MATERIAL, closure="papre"), cm.ParameterError, "closure is 'papre'"),  # type: ignore[arg-type]
        (
            lambda: cm.fit([(5.0, cm.power_law(2.5, 0.1, 2.0))], START, MATERIAL),
            cm.ParameterError,
            "grading is an ideal law, which has no sieves",
        ),
        (lambda: cm.Measurement(-1.0, [1.0], [0.5]), cm.ParameterError, "stress is -1"),
        (lambda: cm.Measurement(1.0, [1.0, 1.0], [0.5, 0.6]), cm.ParameterError, "size has a sieve twice"),
        (
            lambda: cm.Measurement(1.0, [1.0], [50.0]),
            cm.ParameterError,
            r"finer\[0\] is 50; it must be a mass fraction",
        ),
        (lambda: cm.Measurement(1.0, [1.0], [0.5], unit="furlong"), cm.ParameterError, "unit is 'furlong'"),
        (lambda: cm.Measurement(1.0, [1.0, 2.0], [0.5]), cm.ParameterError, "both must be lists of one length"),
        (lambda: cm.Measurement("20", [1.0], [0.5]), TypeError, "stress is '20'"),  # type: ignore[arg-type]
        (lambda: cm.fit(PAIR, "sand.csv", MATERIAL), TypeError, r"start is a str; .*Grading\.read reads a file"),  # type: ignore[arg-type]
        (
            lambda: cm.fit([cm.Measurement(5.0, [1.0, 0.5], [0.7, 0.2])], START, MATERIAL, ["first_crush_stress"]),
            cm.ParameterError,
            "data has sieves without a unit, and its start is in mm",
        ),
        (
            lambda: cm.fit(
                [cm.Measurement(5.0, [1.0, 0.5], [0.7, 0.2], "mm", error=np.array([0.01]))], START, MATERIAL
            ),
            cm.ParameterError,
            r"error of data\[0\] has shape \(1,\); give one number, or one for each of the 2 sieves",
        ),
        (lambda: cm.UnknownStart(0.0, 0.5, 2.0), cm.ParameterError, "median is 0"),
    ],
)
def test_wrong_input_is_refused_with_the_rule(call: Callable[[], Any], kind: type[Exception], words: str) -> None:
    with pytest.raises(kind, match=words):
        call()


def test_other_values_that_fit_as_well_are_named() -> None:
    with pytest.warns(cm.FitWarning, match="other values fit as well: fabric_width"):
        cm.fit(noisy(crushed(stresses=(5.0,)), 0), START, cm.Material(reference_size=2.0))


def test_ctrl_c_keeps_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    calls, curves = 0, cm.FitProblem.curves

    def interrupted(self: cm.FitProblem, vector: Floats, model: Any = None) -> list[Floats]:
        nonlocal calls
        calls += 1
        if calls == 40:
            raise KeyboardInterrupt
        return curves(self, vector, model)

    monkeypatch.setattr(cm.FitProblem, "curves", interrupted)
    with pytest.warns(cm.FitWarning, match="interrupted; the result is the best so far"):
        found = cm.fit(crushed(), START, cm.Material(reference_size=2.0))
    assert found.interrupted
    assert found.rms < 0.05  # on the way from .2


def test_the_result_becomes_a_case_that_runs(tmp_path: Path) -> None:
    found = cm.fit(noisy(crushed(), 0), START, cm.Material(reference_size=2.0), starts=1)
    (case,) = read_case(found.save(tmp_path / "fitted.toml"))
    assert case.material == found.material
    run = run_case(case)
    np.testing.assert_array_equal(run.stress, STRESSES)
    np.testing.assert_allclose(run.percentile(50), found.predict(list(STRESSES)).percentile(50), rtol=1e-9)
    numbers = json.loads(found.save(tmp_path / "fitted.json").read_text())
    assert numbers["values"] == found.values
    assert len(numbers["residuals"]) == 40
    with pytest.raises(cm.ParameterError, match=r"must end in \.toml .* or \.json"):
        found.save(tmp_path / "fitted.txt")


def test_the_lattice_says_how_far_the_closure_is() -> None:
    found = cm.fit(noisy(crushed(stresses=(10.0, 40.0)), 0), START, cm.Material(reference_size=2.0), starts=1)
    lattice = cm.Lattice(50_000, found.material, START, seed=7)
    gaps = []
    for datum, curve in zip(found.data, found.model, strict=True):
        lattice.load_to(datum.stress / found.values["first_crush_stress"])
        sampled = np.mean(np.exp(lattice.psi[0])[:, None] <= datum.size * (1 + 1e-12), axis=0)
        gaps.append(curve - sampled)
    rms = float(np.sqrt(np.mean(np.concatenate(gaps) ** 2)))
    assert found.closure_error.rms == pytest.approx(rms, abs=0.004)  # noise of the smaller lattice
    assert "times the fit's" in found.table()


def test_the_resolved_law_finds_the_lattices_parameter_and_the_lattice_too() -> None:
    lattice = cm.Lattice(200_000, TRUE, START, seed=5)
    data = []
    for stress in (10.0, 40.0):
        lattice.load_to(stress / 2.0)
        finer = np.mean(np.exp(lattice.psi[0])[:, None] <= SIEVES * (1 + 1e-12), axis=0)
        data.append(cm.Measurement(stress, SIEVES, finer, unit="mm"))
    known = cm.Material(reference_size=2.0, weibull_modulus=4.0, first_crush_stress=2.0, fabric_width=0.5)
    by_law = cm.fit(data, START, known, ["fabric_width"], closure="resolved", error=0.002, starts=1)
    assert by_law.values["fabric_width"] == pytest.approx(0.35, rel=0.03)
    by_lattice = cm.fit(data, START, known, ["fabric_width"], closure="lattice", cells=50_000, error=0.004, starts=1)
    assert by_lattice.values["fabric_width"] == pytest.approx(0.35, rel=0.05)
    by_paper = cm.fit(data, START, known, ["fabric_width"], starts=1)
    assert by_paper.rms > 3.0 * by_law.rms  # what the paper's closure cannot follow


def test_pictures(tmp_path: Path) -> None:
    found = cm.fit(noisy(crushed(), 0), START, cm.Material(reference_size=2.0), starts=1)
    found.plot().savefig(tmp_path / "fit.png")
    assert (tmp_path / "fit.png").stat().st_size > 20_000


def test_a_fit_warns_nothing_where_the_data_tell_all() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cm.fit(crushed(), START, cm.Material(reference_size=2.0), intervals="profile")

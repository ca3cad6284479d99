"""One sweep of the quasi-static solver against other routes to the same state: steps, paths, and the reference."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import comminute as cm
import reference_quasi_static as qs
from reference import Array
from strategies import Fragments, SolveCase, log_uniform, solve_cases

SEEDS = st.integers(0, 2**32 - 1)
ROUNDING = 1e-14  # of the whole mass, however often it has crushed


def same_crushes(found: cm.SolveReport, expected: cm.SolveReport) -> None:
    scale = max(1.0, expected.crushed + expected.crushed_neighbour)
    assert found.crushed == pytest.approx(expected.crushed, abs=1e-14 * scale)
    assert found.crushed_neighbour == pytest.approx(expected.crushed_neighbour, abs=1e-14 * scale)


def random_path(seed: int, last: float, steps: int) -> list[float]:
    """Return loads and unloadings, the largest of them the last."""
    rng = np.random.default_rng(seed)
    return [*(last * np.exp(-rng.exponential(1.5, steps))).tolist(), last]


def follow(solver: cm.QuasiStatic, p: Array, loads: list[float]) -> tuple[Array, float, float]:
    """Solves in place, each from where the last one settled; and the crushes of all."""
    state, largest, crushed, crushed_neighbour = p.copy(), None, 0.0, 0.0
    for load in loads:
        assert solver.solve(state, load, settled_at=largest, out=state) is state
        crushed += solver.report.crushed
        crushed_neighbour += solver.report.crushed_neighbour
        largest = load if largest is None else max(largest, load)
    return state, crushed, crushed_neighbour


# --- other routes to the same state -------------------------------------------------------------------------


@settings(max_examples=120)
@given(case=solve_cases(max_bins=250) | solve_cases(max_bins=60, fabric_off=True))
def test_running_sums_and_bin_by_bin_agree(case: SolveCase) -> None:
    direct, sums = case.solver("direct"), case.solver("sums")
    expected, found = direct.solve(case.p, case.stress_ratio), sums.solve(case.p, case.stress_ratio)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(
        np.cumsum(found.sum(axis=1)), np.cumsum(expected.sum(axis=1)), rtol=0.0, atol=2.0 * ROUNDING
    )
    same_crushes(sums.report, direct.report)
    for state in (found, expected):
        assert state.min() >= 0.0
        assert math.fsum(state.ravel()) == pytest.approx(1.0, abs=ROUNDING)
    automatic = case.solver()
    chosen = automatic.solve(case.p, case.stress_ratio)
    np.testing.assert_allclose(chosen, expected, rtol=0.0, atol=ROUNDING)
    if automatic.report.path != "narrow":
        np.testing.assert_array_equal(chosen, found if automatic.report.path == "sums" else expected)


@pytest.mark.parametrize("bins", [499, 512, 513, 700])
@pytest.mark.parametrize(
    ("material", "stress_ratio"),
    [
        (cm.Material(), 1e4),
        (cm.Material(fabric_width=0.3, fragments=cm.WeibullFragments(0.2, 2.0)), 30.0),
        (cm.Material(fabric_width=5.0, reference_size=3.0, fragments=cm.PowerLawFragments(0.7)), 0.4),
        (cm.Material(weibull_modulus=8.0, fabric_width=300.0, fragments=cm.WeibullFragments(1.3, 1.5)), 4.0),
        (cm.Material(fabric_width=0.01, fragments=cm.WeibullFragments(0.05, 1.0)), 1e5),
    ],
    ids=str,
)
def test_large_grids(bins: int, material: cm.Material, stress_ratio: float) -> None:
    grid = cm.LogGrid(-6.0, 1.0, bins)
    start = cm.mixed_fabric(cm.power_law(2.5, 5e-3, 2.7), grid).probability
    for scheme in ("conservative", "paper"):
        direct = cm.QuasiStatic(grid, material, scheme, path="direct")
        sums = cm.QuasiStatic(grid, material, scheme, path="sums")
        expected = direct.solve(start, stress_ratio)
        np.testing.assert_allclose(sums.solve(start, stress_ratio), expected, rtol=0.0, atol=ROUNDING)
        assert sums.report.path == "sums"
        same_crushes(sums.report, direct.report)
        path, *crushed = follow(sums, start, (stress_ratio * np.geomspace(0.01, 1.0, 20)).tolist())
        np.testing.assert_allclose(path, expected, rtol=0.0, atol=ROUNDING)
        assert crushed == pytest.approx([direct.report.crushed, direct.report.crushed_neighbour], rel=1e-13)


@settings(max_examples=80)
@given(case=solve_cases(), seed=SEEDS, steps=st.integers(1, 200), rate=st.sampled_from([0.0, 0.0, 0.3, 1.0]))
def test_a_path_of_loads_and_unloadings_is_one_solve(case: SolveCase, seed: int, steps: int, rate: float) -> None:
    assume(rate == 0.0 or case.grid.bins <= 40)
    once = case.solver(rate=rate)
    expected = once.solve(case.p, case.stress_ratio)
    found, *crushed = follow(case.solver(rate=rate), case.p, random_path(seed, case.stress_ratio, steps))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUNDING)
    scale = max(1.0, once.report.crushed + once.report.crushed_neighbour)
    assert crushed == pytest.approx([once.report.crushed, once.report.crushed_neighbour], abs=2e-14 * scale)


@pytest.mark.parametrize("scheme", ["conservative", "paper"])
@pytest.mark.parametrize("n", [0.01, 0.05, 0.6, 30.0, math.inf])
def test_two_hundred_increments_are_one_solve(n: float, scheme: qs.Scheme) -> None:
    grid, material = cm.LogGrid(-5.0, 1.0, 240), cm.Material(fabric_width=n, reference_size=1.7)
    start = cm.mixed_fabric(cm.power_law(2.3, 0.02, 2.5), grid)
    solver = cm.QuasiStatic(grid, material, scheme)
    expected, once = solver.solve(start, 50.0), solver.report
    fabric, crushed = start, 0.0
    for load in np.geomspace(0.2, 50.0, 200):
        fabric = solver.solve(fabric, float(load))
        crushed += solver.report.crushed
    np.testing.assert_allclose(fabric.probability, expected.probability, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(fabric.cdf(), expected.cdf(), rtol=0.0, atol=1e-14)
    assert crushed == pytest.approx(once.crushed, abs=1e-14 * max(1.0, once.crushed))
    assert fabric.settled_at == expected.settled_at == 50.0


@given(case=solve_cases(), rate=st.sampled_from([0.0, 0.0, 0.0, 0.35, 1.0]))
def test_centre_test_is_steps_repeated_to_rest(case: SolveCase, rate: float) -> None:
    assume(rate == 0.0 or (case.grid.bins <= 40 and cm.has_fftw))
    solver = cm.QuasiStatic(case.grid, case.material, "paper", rate)
    stepper = (
        cm.FullConvolution(case.grid, case.material, "blend", loading_rate=rate, scheme="paper")
        if rate > 0.0
        else cm.SlowUpdate(case.grid, case.material, scheme="paper")
    )
    found, expected = solver.solve(case.p, case.stress_ratio), stepper.settle(case.p, case.stress_ratio)
    atol = ROUNDING if rate == 0.0 else 1e-13  # transforms make noise
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=atol)
    scale = max(1.0, solver.report.crushed + solver.report.crushed_neighbour)
    assert stepper.report.crushed == pytest.approx(solver.report.crushed, abs=10.0 * atol * scale)
    assert stepper.report.crushed_neighbour == pytest.approx(solver.report.crushed_neighbour, abs=10.0 * atol * scale)


# --- the reference ------------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(
    case=solve_cases(max_bins=96), rate=st.sampled_from([0.0, 0.0, 0.2, 1.0]), before=st.none() | log_uniform(0.01, 1.0)
)
def test_solves_agree_with_the_reference(case: SolveCase, rate: float, before: float | None) -> None:
    settled_at = None if before is None else before * case.stress_ratio
    expected = qs.settle(case.p, case.psi, case.model, case.stress_ratio, settled_at, case.scheme, rate)
    for path in ("direct", "sums") if rate == 0.0 else ("automatic",):
        solver = case.solver(path, rate)
        found = solver.solve(case.p, case.stress_ratio, settled_at)
        np.testing.assert_allclose(found, expected.p, rtol=0.0, atol=5e-14)
        assert solver.report.crushed == pytest.approx(expected.crushed, rel=1e-12, abs=1e-13)
        assert solver.report.crushed_neighbour == pytest.approx(expected.crushed_neighbour, rel=1e-12, abs=1e-13)
        marginal = solver.marginal(case.p, case.stress_ratio, settled_at)
        np.testing.assert_allclose(marginal, expected.p.sum(axis=1), rtol=0.0, atol=5e-14)


# --- what else a solve promises -----------------------------------------------------------------------------


@given(case=solve_cases(max_bins=150), rate=st.sampled_from([0.0, 0.0, 0.4]))
def test_the_marginal_is_the_row_sums_of_the_state(case: SolveCase, rate: float) -> None:
    assume(rate == 0.0 or case.grid.bins <= 40)
    solver = case.solver(rate=rate)
    for settled_at in (None, 0.4 * case.stress_ratio, 2.0 * case.stress_ratio):
        state = solver.solve(case.p, case.stress_ratio, settled_at)
        of_state = solver.report
        marginal = solver.marginal(case.p, case.stress_ratio, settled_at)
        np.testing.assert_allclose(marginal, state.sum(axis=1), rtol=0.0, atol=ROUNDING)
        assert marginal.min() >= 0.0
        assert solver.report == of_state
        fabric = cm.Fabric(case.grid, case.p, settled_at=settled_at)
        np.testing.assert_allclose(solver.marginal(fabric, case.stress_ratio), marginal, rtol=0.0, atol=ROUNDING)
        after = solver.solve(fabric, case.stress_ratio)
        np.testing.assert_array_equal(after.probability, state)
        np.testing.assert_allclose(after.grainsize(), marginal, rtol=0.0, atol=ROUNDING)
        np.testing.assert_array_equal(solver.grading_after(fabric, case.stress_ratio).grainsize, after.grainsize())
        assert after.settled_at == max(case.stress_ratio, settled_at or 0.0)


@given(case=solve_cases(), share=st.floats(0.0, 1.0))
def test_grains_only_get_finer(case: SolveCase, share: float) -> None:
    rate = share if case.grid.bins <= 30 else 0.0
    solver, p, largest = case.solver(rate=rate), case.p, None
    for load in np.geomspace(0.05, 1.0, 6) * case.stress_ratio:
        after = solver.solve(p, float(load), settled_at=largest)
        # The cdf of either size never falls, at any size: stronger than what the means say.
        for axis in (0, 1):
            assert (np.cumsum((after - p).sum(axis=axis)) >= -ROUNDING).all()
        p, largest = after, float(load)


def test_unloading_changes_nothing_and_says_so() -> None:
    grid = cm.LogGrid(-4.0, 0.2, 64)
    p = np.random.default_rng(3).dirichlet(np.ones(64 * 64)).reshape(64, 64)
    solver = cm.QuasiStatic(grid, cm.Material(fabric_width=0.4))
    settled = solver.solve(p, 9.0)
    for load in (9.0, 3.0, 0.0):
        np.testing.assert_array_equal(solver.solve(settled, load, settled_at=9.0), settled)
        assert solver.report.path == "none"
        assert solver.report.crushed == solver.report.crushed_neighbour == 0.0
        marginal = solver.marginal(settled, load, settled_at=9.0)
        np.testing.assert_allclose(marginal, settled.sum(axis=1), rtol=1e-14)


@pytest.mark.parametrize("rate", [0.0, 0.3])
def test_the_least_possible_increment_never_moves_mass_back(rate: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(150):
        bins, top = int(rng.integers(8, 40)), float(rng.uniform(-1.0, 1.5))
        grid = cm.LogGrid(top - float(rng.uniform(0.5, 8.0)), top, bins)
        material = cm.Material(
            weibull_modulus=float(rng.uniform(0.5, 12.0)), fabric_width=float(rng.uniform(0.05, 9.0))
        )
        solver, load = cm.QuasiStatic(grid, material, loading_rate=rate), float(np.exp(rng.uniform(-1.0, 6.0)))
        p = solver.solve(rng.dirichlet(np.full(bins * bins, 0.05)).reshape(bins, bins), load)
        for _ in range(3):
            above = math.nextafter(load, math.inf)
            p, load = solver.solve(p, above, settled_at=load), above
            assert p.min() >= 0.0
            assert 0.0 <= solver.report.crushed < 1e-13


def test_reports_say_which_path_ran_and_how_well_the_sum_fits() -> None:
    grid, p = cm.LogGrid(-6.0, 1.0, 351), np.full((351, 351), 351.0**-2)
    laws: dict[str, Fragments] = {
        "eq 4": cm.WeibullFragments(),
        "fine": cm.WeibullFragments(0.1, 1.0),
        "power": cm.PowerLawFragments(0.8),
        "lognormal": cm.LogNormalFragments(),
        "table": cm.TabulatedFragments([0.25, 1.0], [0.5, 1.0]),
    }
    report = {}
    for name, law in laws.items():
        solver = cm.QuasiStatic(grid, cm.Material(fabric_width=0.5, fragments=law), path="sums")
        solver.solve(p, 100.0)
        report[name] = solver.report
    assert {name: r.path for name, r in report.items()} == {
        "eq 4": "sums",
        "fine": "sums",
        "power": "sums",
        "lognormal": "direct",
        "table": "direct",
    }
    assert (report["eq 4"].terms, report["eq 4"].head) in {(11, 0), (12, 0)}
    assert (report["fine"].head, report["fine"].terms <= 14) == (math.ceil(math.log(5.0) / 0.02), True)
    assert report["power"].terms == 1
    for r in report.values():
        if r.path == "sums":
            assert 0.0 <= r.fit_error <= 1e-13
        else:
            assert (r.terms, r.head, r.fit_error) == (0, 350, 0.0)
    narrow = cm.QuasiStatic(grid, cm.Material(fabric_width=0.01))
    narrow.solve(p, 2.0)
    assert narrow.report.path == "narrow"  # three bins wide: no sum is worth its terms
    by_table = cm.QuasiStatic(grid, cm.Material(fabric_width=0.5, fragments=laws["table"]))
    by_table.solve(p, 2.0)
    assert by_table.report.path == "direct"
    wide = cm.QuasiStatic(grid, cm.Material(fabric_width=0.5))
    wide.solve(p, 2.0)
    assert wide.report.path == "sums"
    blend = cm.QuasiStatic(cm.LogGrid(-3.0, 0.0, 12), cm.Material(), loading_rate=0.5)
    blend.solve(np.full((12, 12), 1.0 / 144.0), 50.0)
    assert (blend.report.path, blend.report.terms, blend.report.fit_error) == ("blend", 0, 0.0)

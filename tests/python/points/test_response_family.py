"""Response tables over a second variable: against direct solves, differences, scaling, files, and what is refused."""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import comminute as cm

MATERIAL = cm.Material()
GRID = cm.LogGrid(-9.0, 0.05, 128)
MOST = 300.0


def sand(dimension: float) -> cm.Grading:
    return cm.power_law(dimension, 0.01, 1.0).with_unit("mm")


BY_DIMENSION = cm.ResponseFamily(MATERIAL, sand, [2.1, 2.7], variable="fractal dimension", grid=GRID, largest=MOST)
BY_RATE = cm.ResponseFamily(MATERIAL, sand(2.4), [0.0, 0.5], variable="loading_rate", grid=GRID, largest=MOST)
TOLERANCE = 1e-3


def solved(dimension: float, rate: float, load: float) -> cm.Result:
    simulation = cm.Simulation(MATERIAL, sand(dimension), grid=GRID)
    return simulation.run(stress_ratio=[load], loading_rate=rate, keep_fabrics=())


@pytest.mark.parametrize("family", [BY_DIMENSION, BY_RATE], ids=["dimension", "rate"])
def test_a_family_is_a_solve_at_every_load_and_value(family: cm.ResponseFamily) -> None:
    rng = np.random.default_rng(3)
    low, high = family.values[[0, -1]]
    count = 1000 if family is BY_DIMENSION else 60  # a solve of the blend takes long
    loads, values = np.exp(rng.uniform(-0.5, np.log(MOST), count)), rng.uniform(low, high, count)
    if family is BY_DIMENSION:
        solver = cm.QuasiStatic(GRID, MATERIAL)
        direct = [solver.marginal(cm.mixed_fabric(sand(v), GRID), s) for s, v in zip(loads, values, strict=True)]
    else:
        direct = [solved(2.4, v, s).pmf[0] for s, v in zip(loads, values, strict=True)]
    for pmf, load, value in zip(direct, loads, values, strict=True):
        assert np.abs(family.cdf(load, value) - np.cumsum(pmf)).max() <= TOLERANCE


@pytest.mark.parametrize("family", [BY_DIMENSION, BY_RATE], ids=["dimension", "rate"])
def test_at_a_node_it_is_the_table(family: cm.ResponseFamily) -> None:
    for node in (0, family.values.size // 2, -1):
        value, table = float(family.values[node]), family.table(node)
        for load in (0.3, 2.0, 77.0, MOST):
            np.testing.assert_allclose(family.cdf(load, value), table.cdf(load), rtol=0.0, atol=1e-15)
            for name in ("crushes", "fines", "d50", "D90", "breakage"):
                assert family.value(name, load, value) == pytest.approx(float(table.value(name, load)), rel=1e-13)
                found = float(family.derivative(name, load, value))
                assert found == pytest.approx(float(table.derivative(name, load)), rel=1e-9, abs=1e-15)


def test_derivatives_are_those_of_differences() -> None:
    load, value, step = 40.0, 2.43, 1e-6
    assert np.abs(BY_DIMENSION.values - value).min() > 2.0 * step  # within an interval
    for name in ("crushes", "fines", "d50", "breakage"):
        for by, (up, down) in {
            "stress_ratio": ((load + step, value), (load - step, value)),
            "variable": ((load, value + step), (load, value - step)),
        }.items():
            difference = float(BY_DIMENSION.value(name, *up) - BY_DIMENSION.value(name, *down)) / (2.0 * step)
            found = BY_DIMENSION.derivative(name, load, value, by=by)  # type: ignore[arg-type]
            assert float(found) == pytest.approx(difference, rel=1e-4, abs=1e-8)


def test_gradings_rise_with_size_and_never_coarsen() -> None:
    rng = np.random.default_rng(4)
    for value in rng.uniform(2.1, 2.7, 20):
        curves = np.array([BY_DIMENSION.cdf(load, value) for load in np.geomspace(0.5, MOST, 40)])
        assert np.diff(curves, axis=1).min() >= -1e-12
        assert np.diff(curves, axis=0).min() >= -1e-12


def test_scaled_starts_are_one_table() -> None:
    # The law that the refusal of other largest grains points to, on a grid shifted with the sizes.
    half = cm.LogGrid(GRID.psi_min + np.log(0.5), GRID.psi_max + np.log(0.5), GRID.bins)
    small = cm.Simulation(MATERIAL, cm.power_law(2.4, 0.005, 0.5), grid=half).run(stress_ratio=[80.0])
    large = cm.Simulation(MATERIAL, cm.power_law(2.4, 0.01, 1.0), grid=GRID).run(stress_ratio=[80.0 * 0.5])
    np.testing.assert_allclose(small.cdf, large.cdf, rtol=0.0, atol=1e-12)


def test_exact_sizes_stay_where_they_are() -> None:
    family = cm.ResponseFamily(
        MATERIAL, lambda share: cm.gap_graded(1.0, 0.1, share), [0.3, 0.7], grid=GRID, largest=20.0, refine=False
    )
    start = family.curve(0.2, 0.5)
    assert start.percentile(25) == pytest.approx(0.1)
    assert start.percentile(75) == pytest.approx(1.0)
    assert float(start.finer_than(0.5)) == pytest.approx(0.5)


def test_files_and_bytes_give_it_back(tmp_path: Path) -> None:
    path = BY_DIMENSION.save(tmp_path / "family.nc")
    for again in (
        cm.ResponseFamily.open(path),
        cm.ResponseFamily.from_bytes(bytes(BY_DIMENSION), "fractal dimension", "mm"),
        pickle.loads(pickle.dumps(BY_DIMENSION)),
    ):
        assert again == BY_DIMENSION
        assert (again.variable, again.unit) == ("fractal dimension", "mm")
    assert BY_DIMENSION != BY_RATE
    assert "fractal dimension 2.1 to 2.7" in repr(BY_DIMENSION)


def family_of(**options: object) -> cm.ResponseFamily:
    given: dict[str, object] = {"grid": GRID, "largest": 20.0, "refine": False, **options}
    return cm.ResponseFamily(MATERIAL, sand, [2.2, 2.6], **given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("message", "call"),
    [
        ("it must be a Grading for the loading rate", lambda: family_of(variable="loading_rate")),
        ("there must be two or more", lambda: cm.ResponseFamily(MATERIAL, sand, [2.2])),
        ("greater than the one before", lambda: cm.ResponseFamily(MATERIAL, sand, [2.6, 2.2], grid=GRID, largest=9.0)),
        ("tolerance is 0", lambda: family_of(tolerance=0.0)),
        ("has another largest grain than the first", lambda: other_sizes()),
        ("the family goes from 2.1 to 2.7", lambda: BY_DIMENSION.value("d50", 10.0, [2.3, 2.8])),
        ("the table goes from 0 to 300", lambda: BY_DIMENSION.value("d50", 400.0, 2.3)),
        ("it must be a size such as d50", lambda: BY_DIMENSION.value("d500", 10.0, 2.3)),
        ("bytes are no response family", lambda: cm.ResponseFamily.from_bytes(b"no family, but long enough")),
        ("it must end in .nc", lambda: BY_DIMENSION.save("family.txt")),
        ("does not exist", lambda: cm.ResponseFamily.open("nowhere.nc")),
        ("by is", lambda: BY_DIMENSION.derivative("d50", 10.0, 2.3, by="load")),  # type: ignore[arg-type]
    ],
)
def test_what_is_refused_says_why(message: str, call: Callable[[], object]) -> None:
    with pytest.raises(cm.ParameterError) as caught:
        call()
    assert message in str(caught.value)


def other_sizes() -> cm.ResponseFamily:
    return cm.ResponseFamily(
        MATERIAL, lambda largest: cm.power_law(2.4, 0.01, largest), [0.6, 0.8], grid=GRID, largest=9.0
    )

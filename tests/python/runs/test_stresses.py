"""Stresses of every kind as loads: materials that name their measure, runs and files."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import comminute as cm
from comminute.runs.recipe import material_of, material_record

OEDOMETER = cm.Material(first_crush_stress=12.0, stress_measure="energy", poisson=0.2, k0=0.5)
MEAN = cm.Material(first_crush_stress=10.0, stress_measure="mean")
PLAIN = cm.Material(first_crush_stress=10.0)
START = cm.gap_graded(1.0, 0.2)
GRID = cm.LogGrid(-5.0, 0.0, 101)
TENSORS = np.stack([np.diag([5.0, 5.0, 20.0]), np.diag([30.0, 40.0, 50.0])])

# sigma_eq of an oedometer over its vertical stress.
TABLE = {
    ("energy", 0.2): {0.3: 0.709, 0.4: 0.721, 0.5: 0.745, 0.6: 0.780, 1.0: 1.0},
    ("energy", 0.3): {0.3: 0.799, 0.4: 0.787, 0.5: 0.791, 0.6: 0.808, 1.0: 1.0},
    ("mean", None): {0.3: 0.533, 0.4: 0.6, 0.5: 0.667, 0.6: 0.733, 1.0: 1.0},
    ("vertical", None): {0.3: 1.0, 0.5: 1.0, 1.0: 1.0},
    ("octahedral", None): {0.5: math.sqrt(2.0) / 6.0, 1.0: 0.0},
}


@pytest.mark.parametrize(("name", "poisson"), TABLE)
def test_an_oedometer_by_every_measure(name: str, poisson: float | None) -> None:
    measure = cm.StressMeasure(name, poisson=poisson)  # type: ignore[arg-type]
    rows = TABLE[name, poisson]
    np.testing.assert_allclose(measure(vertical=1.0, k0=list(rows)), list(rows.values()), rtol=0.0, atol=5e-4)


@pytest.mark.parametrize(("measure", "isotropic"), [("mean", 1.5), ("energy", 1.342), ("largest", 1.0)])
def test_an_isotropic_stress_does_more_than_a_vertical_one(measure: str, isotropic: float) -> None:
    material = cm.Material(
        first_crush_stress=12.0,
        stress_measure=measure,  # type: ignore[arg-type]
        k0=0.5,
        poisson=0.2,
    )
    assert material.stress_ratio(12.0) == 1.0
    assert material.stress_ratio(np.diag([6.0, 6.0, 12.0])) == pytest.approx(1.0, rel=1e-15)
    assert material.stress_ratio(p=12.0, q=0.0) == pytest.approx(isotropic, rel=1e-3)


def test_a_vertical_stress_is_the_largest_one_whatever_its_axis() -> None:
    vertical = cm.StressMeasure("vertical")
    assert vertical == cm.StressMeasure("largest")
    assert [vertical(np.diag(s)) for s in ([6.0, 6.0, 12.0], [12.0, 6.0, 6.0])] == [12.0, 12.0]
    assert vertical(vertical=10.0, k0=1.5) == 15.0  # horizontal stresses are the largest here


def test_a_measure_by_name_has_the_poisson_ratio_that_is_given() -> None:
    named = cm.Material(stress_measure="energy", poisson=0.2)
    assert named == cm.Material(stress_measure=cm.StressMeasure("energy", poisson=0.2))
    assert named.stress_measure is not None
    assert (named.stress_measure.name, named.stress_measure.poisson, named.k0) == ("energy", 0.2, None)
    assert cm.Material(stress_measure="mean").stress_measure == cm.StressMeasure("mean")
    assert cm.Material().stress_measure is None


def test_materials_and_measures_are_things() -> None:
    others = [PLAIN, MEAN, cm.Material(first_crush_stress=12.0, stress_measure="energy", poisson=0.2)]
    others.append(cm.Material(first_crush_stress=12.0, stress_measure="energy", poisson=0.3, k0=0.5))
    for material in (OEDOMETER, *others):
        assert pickle.loads(pickle.dumps(material)) == material == material_of(material_record(material))
        assert eval(repr(material), vars(cm).copy()) == material
    assert OEDOMETER not in others
    assert len({cm.StressMeasure("mean"), cm.StressMeasure("mean"), cm.StressMeasure("mean", poisson=0.1)}) == 2


def test_records_of_version_0_1_0_are_read_and_written_as_long_as_they_can_say_it() -> None:
    old = {"weibull_modulus": 3.0, "fabric_width": 0.05, "reference_size": 1.0, "first_crush_stress": 10.0}
    old["fragments"] = {"law": "weibull", "scale": 1.0, "shape": 1.0}  # type: ignore[assignment]
    assert material_of(old) == PLAIN
    assert material_record(PLAIN) == old
    pickled = cm.Material.__new__(cm.Material)
    pickled.__setstate__((3.0, 0.05, 1.0, cm.WeibullFragments(), 10.0))  # type: ignore[attr-defined]
    assert pickled == PLAIN
    assert material_record(OEDOMETER) == old | {
        "first_crush_stress": 12.0,
        "stress_measure": "energy",
        "poisson": 0.2,
        "k0": 0.5,
    }


def test_plain_numbers_mean_what_they_did() -> None:
    numbers = np.array([[0.0, 5.0, 10.0, 1.0, 1.0, 1.0]] * 2)
    np.testing.assert_array_equal(PLAIN.stress_ratio(numbers), numbers / 10.0)  # no measure, so no tensors
    np.testing.assert_array_equal(MEAN.stress_ratio(numbers[0]), numbers[0] / 10.0)
    np.testing.assert_array_equal(MEAN.stress_ratio(numbers), [0.5, 0.5])
    assert type(MEAN.stress_ratio(5.0)) is type(MEAN.stress_ratio(TENSORS[0])) is float


LOADS: dict[str, tuple[cm.Material, dict[str, object], list[float]]] = {
    "tensors": (MEAN, {"stress": TENSORS}, [10.0, 40.0]),
    "rows": (MEAN, {"stress": [[5.0, 5.0, 20.0, 1.0, 2.0, 3.0], [30.0, 40.0, 50.0, 0.0, 0.0, 0.0]]}, [10.0, 40.0]),
    "one tensor": (MEAN, {"stress": TENSORS[1].tolist()}, [40.0]),
    "p and q": (MEAN, {"p": [10.0, 40.0], "q": [15.0, 0.0]}, [10.0, 40.0]),
    "p and one q": (MEAN, {"p": [10.0, 40.0], "q": 15.0}, [10.0, 40.0]),
    "vertical": (MEAN, {"vertical": [15.0, 60.0], "k0": 0.5}, [10.0, 40.0]),
    "vertical, own K0": (OEDOMETER, {"vertical": [12.0, 60.0]}, [12.0, 60.0]),
    "as found": (OEDOMETER, {"stress": np.diag([6.0, 6.0, 12.0])}, [12.0]),
    "one in tension": (MEAN, {"stress": np.stack([TENSORS[0], -TENSORS[0]])}, [10.0, 0.0]),
}  # fmt: skip


@pytest.mark.parametrize("way", LOADS)
def test_runs_take_stresses_of_every_kind_and_tell_them_as_the_first_crush_stress_is(way: str) -> None:
    material, loads, stress = LOADS[way]
    sim = cm.Simulation(material, START, grid=GRID)
    found = sim.run(**loads)  # type: ignore[arg-type]
    assert found.stress is not None
    np.testing.assert_allclose(found.stress, stress, rtol=1e-14)
    np.testing.assert_allclose(found.stress_ratio, np.array(stress) / material.first_crush_stress, rtol=1e-14)
    assert found == sim.run(stress_ratio=found.stress_ratio)
    assert cm.run_again(found) == found
    rings = cm.Lattice(50, material, START).run(**loads, grid=GRID)  # type: ignore[arg-type]
    np.testing.assert_array_equal(rings.stress_ratio, found.stress_ratio)


def test_resumed_runs_and_files_keep_the_measure(tmp_path: Path) -> None:
    sim = cm.Simulation(OEDOMETER, START, grid=GRID)
    first = cm.open_result(sim.run(p=[12.0], q=[9.0]).save(tmp_path / "run.nc"))
    assert first.material == OEDOMETER
    ratios = [OEDOMETER.stress_ratio(p=12.0, q=9.0), OEDOMETER.stress_ratio(vertical=60.0, k0=0.4)]
    assert first.resume(vertical=[60.0], k0=0.4) == sim.run(stress_ratio=ratios)


def test_an_isotropic_path_by_the_octahedral_measure_is_no_load() -> None:
    octahedral = cm.Material(first_crush_stress=1.0, stress_measure="octahedral")
    result = cm.Simulation(octahedral, START, grid=GRID).run(p=[1.0, 2.0], q=0.0)
    np.testing.assert_array_equal(result.stress_ratio, [0.0, 0.0])

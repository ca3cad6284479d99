# ruff: noqa: E501  (mistakes and messages, one a line)
"""Case files whose material names its stress measure, and whose loads are stresses of every kind."""

import json
from pathlib import Path

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("pydantic")
pytest.importorskip("typer")

from comminute.cases.reading import ReadyCase, case_of_text, read_case
from comminute.cases.running import run_case, run_file_again
from comminute.cli.texts import case_summary

CASE = """
[material]
first_crush_stress = 12.0
stress_measure = "energy"
poisson = 0.2
k0 = 0.5
[grading]
kind = "gap-graded"
coarse = 1.0
fine = 0.2
[grid]
bins = 64
[load]
p = [12.0, 60.0]
q = 9.0
"""
MATERIAL = cm.Material(first_crush_stress=12.0, stress_measure="energy", poisson=0.2, k0=0.5)


def cases_of(folder: Path, text: str) -> list[ReadyCase]:
    (folder / "case.toml").write_text(text)
    return read_case(folder / "case.toml")


def case_of(folder: Path, load: str = "", material: str = "") -> ReadyCase:
    text = CASE.replace("p = [12.0, 60.0]\nq = 9.0", load) if load else CASE
    (case,) = cases_of(
        folder, text.replace('stress_measure = "energy"\npoisson = 0.2\nk0 = 0.5', material) if material else text
    )
    return case


def test_a_case_names_the_measure_of_its_material(tmp_path: Path) -> None:
    case = case_of(tmp_path)
    assert case.material == MATERIAL
    again = case_of_text(case.text(), case.target)
    assert (again.material, again.resolved) == (case.material, case.resolved)
    assert (
        "stress_measure" not in json.loads(case_of(tmp_path, "stress = 5.0", "fabric_width = 0.05").text())["material"]
    )


@pytest.mark.parametrize(
    ("load", "ratios"),
    [
        ("p = [12.0, 60.0]\nq = 9.0", MATERIAL.stress_ratio(p=[12.0, 60.0], q=9.0)),
        ("p = 12.0\nq = [0.0, -9.0]", MATERIAL.stress_ratio(p=12.0, q=[0.0, -9.0])),
        ("p = { from = 12.0, to = 48.0, steps = 3 }\nq = 0", MATERIAL.stress_ratio(p=[12.0, 24.0, 48.0], q=0.0)),
        ("vertical = [12.0, 24.0]\nk0 = 0.4", MATERIAL.stress_ratio(vertical=[12.0, 24.0], k0=0.4)),
        ("vertical = [12.0, 24.0]", [1.0, 2.0]),
        ("stress = [12.0, 24.0]", [1.0, 2.0]),
    ],
)  # fmt: skip
def test_loads_of_every_kind(load: str, ratios: list[float], tmp_path: Path) -> None:
    case = case_of(tmp_path, load)
    np.testing.assert_allclose(case.path().stress_ratio, ratios, rtol=1e-14)
    assert case_of_text(case.text(), case.target).path().stress_ratio.tolist() == case.path().stress_ratio.tolist()


def test_a_case_with_pairs_runs_and_its_file_runs_again(tmp_path: Path) -> None:
    case = case_of(tmp_path)
    result = run_case(case)
    assert result.material == MATERIAL
    assert result.stress is not None
    np.testing.assert_allclose(result.stress, 12.0 * result.stress_ratio, rtol=1e-15)
    assert cm.open_result(tmp_path / "run.nc") == result
    again, same = run_file_again(tmp_path / "run.nc", tmp_path / "again.nc")
    assert same
    assert again.stress_ratio.tolist() == MATERIAL.stress_ratio(p=[12.0, 60.0], q=9.0).tolist()


def test_a_sweep_over_measures(tmp_path: Path) -> None:
    cases = cases_of(tmp_path, CASE.replace('"energy"', '["mean", "energy", "vertical"]'))
    measures = [case.material.stress_measure for case in cases]
    assert [measure.name for measure in measures if measure] == ["mean", "energy", "largest"]


def test_the_summary_tells_measure_and_loads(tmp_path: Path) -> None:
    summary = case_summary(case_of(tmp_path))
    assert "run.nc: 2 loads, p 12 to 60 MPa, q 9 to 9 MPa" in summary
    assert "first crush stress 12 MPa (energy stress, poisson 0.2, vertical at K0 0.5), weibull" in summary


MESSAGES = [
    ("q = 9.0", "", "case.toml [load]: q is missing; p is given with it; q is 0 under an isotropic stress"),
    ("q = 9.0", "q = [1.0, 2.0, 3.0]", "case.toml [load]: q has shape (3,); p has (2,); give both in one shape"),
    ("q = 9.0", "q = 9.0\nstress = 1.0", "case.toml [load]: stress and p with q are both given; give one of stress, "),
    ("q = 9.0", "q = { from = 1, to = 2, stps = 2 }", "case.toml [load.q]: stps is an unknown key; did you mean steps?"),
    ("[12.0, 60.0]", "-1.0", "case.toml [load]: every stress is tensile, the mean down to -1; a packing in tension carries"),
    ("poisson = 0.2\n", "", "case.toml [material]: poisson is missing; the energy measure of a stress needs it, at least 0"),
    ("poisson = 0.2", "poisson = 0.5", "case.toml [material]: poisson is 0.5; it must be at least 0 and less than 0.5"),
    ("k0 = 0.5", "k0 = -1", "case.toml [material]: k0 is -1; it must be at least 0 and finite"),
    ('"energy"', '"pressure"', "case.toml [material]: stress_measure is 'pressure'; input should be 'largest', 'vertical'"),
    ('stress_measure = "energy"\npoisson = 0.2\n', "", "case.toml [material]: k0 is 0.5; it belongs to a stress measure, which is not set. Name it in [material], stress_measure ="),
    ('stress_measure = "energy"\npoisson = 0.2\nk0 = 0.5\n', "", "case.toml [load]: stress_measure is missing; stresses that are not single numbers need it. Name it in [material]"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "words"), MESSAGES)
def test_message(old: str, new: str, words: str, tmp_path: Path) -> None:
    assert old in CASE
    with pytest.raises((cm.ParameterError, cm.ShapeError)) as raised:
        cases_of(tmp_path, CASE.replace(old, new, 1))
    assert words in str(raised.value)

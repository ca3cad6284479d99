"""The command `fit`, and the examples that go with it."""

import json
import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import comminute as cm
from comminute.cli.app import app

DATA = Path(__file__).parents[3] / "examples" / "calibration"
FILES = [str(DATA / f"sand-{stress}MPa.csv") for stress in (5, 20, 80)]
START = ["--start", str(DATA / "sand.csv")]
TWO = ["--free", "fabric_width,first_crush_stress", "--fix", "weibull_modulus=4"]


def call(*words: object) -> Result:
    return CliRunner().invoke(app, ["fit", *map(str, words)])


def test_a_fit_prints_a_table_and_writes_what_it_is_asked_for(tmp_path: Path) -> None:
    targets = [tmp_path / name for name in ("fitted.toml", "fitted.json", "fitted.png")]
    done = call(*FILES, *START, *TWO, *(word for target in targets for word in ("-o", target)))
    assert done.exit_code == 0, done.output
    assert "closure 'paper': rms" in done.output
    assert all(target.stat().st_size > 300 for target in targets)
    again = call(*FILES, *START, *TWO, "-o", targets[0])
    assert again.exit_code == 3
    checked = CliRunner().invoke(app, ["check", str(targets[0])])
    assert checked.exit_code == 0, checked.output
    assert "3 loads, stress 5 to 80 MPa" in checked.output
    in_kpa = [f"{path}@{1000 * stress}kPa" for path, stress in zip(FILES, (5, 20, 80), strict=True)]
    assert call(*in_kpa, *START, *TWO, "-o", tmp_path / "kpa.toml").exit_code == 0
    checked = CliRunner().invoke(app, ["check", str(tmp_path / "kpa.toml")])
    assert "3 loads, stress 5000 to 80000 kPa" in checked.output


def test_stresses_in_names_behind_files_and_a_start_among_them_are_one_fit() -> None:
    by_name = json.loads(call(*FILES, *START, *TWO, "--json").output)
    others = [f"{path}@{stress}MPa" for path, stress in zip(FILES, (5, 20, 80), strict=True)]
    behind = json.loads(call(*others, f"{DATA / 'sand.csv'}@0", *TWO, "--json").output)
    globbed = json.loads(call(*FILES, DATA / "sand.csv", *START, *TWO, "--json").output)
    assert by_name == behind == globbed
    assert by_name["stress_unit"] == "MPa"
    assert 0.2 < by_name["values"]["fabric_width"] < 0.5


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([*FILES], "--start is wanted once: 0 starts are named; name one, by --start FILE or as FILE@0"),
        ([DATA / "sand.csv", *START], "at least one|data is empty"),
        ([*FILES, f"{FILES[0]}@5kPa", *START], "the stresses have different units: MPa, kPa"),
        ([f"{FILES[0]}@high", *START], "is 'high'; it must be a number"),
        ([f"{FILES[0]}@5furlong", *START], "it must be a number, with one of Pa, kPa"),
        ([*FILES, *START, "--fix", "weibull_modulus"], "it must be NAME=NUMBER"),
        ([*FILES, *START, "--fix", "fabric_width=0.2"], "fixes fabric_width, which is free"),
        ([*FILES, *START, "--free", "strength"], "free names 'strength'"),
        ([*FILES, *START, "-o", "fit.xyz"], "it must end in .toml, .json"),
    ],
)
def test_wrong_words_are_refused_with_the_rule(words: list[object], message: str) -> None:
    done = call(*words)
    assert done.exit_code == 2
    assert any(part in done.output for part in message.split("|")), done.output


def test_what_cannot_be_told_is_said_below_the_table() -> None:
    done = call(FILES[0], *START)
    assert done.exit_code == 0
    assert "warning: " in done.output


def test_the_posterior_agrees_with_the_fit(tmp_path: Path) -> None:
    script = [sys.executable, str(DATA / "posterior.py"), str(tmp_path)]
    done = subprocess.run(script, capture_output=True, text=True, check=True)
    for line in done.stdout.splitlines():
        words = line.replace(":", "").split()
        low, high, fit_low, fit_high = (float(words[k]) for k in (1, 3, 7, 9))
        assert low == pytest.approx(fit_low, rel=0.15)
        assert high == pytest.approx(fit_high, rel=0.2)
    assert (tmp_path / "posterior.png").stat().st_size > 20_000


def test_the_callback_for_grain_learning_hands_over_what_sieves_measure() -> None:
    rows: list[np.ndarray] = []
    samples = np.array([[0.35, 2.0], [0.2, 1.0]])
    system = SimpleNamespace(param_data=samples, set_sim_data=rows.append)
    runpy.run_path(str(DATA / "grain_learning.py"))["run"](SimpleNamespace(system=system))
    (found,) = rows
    assert found.shape == (2, 1, 30)  # samples, observations, five stresses on six sieves
    material = cm.Material(reference_size=2.0, weibull_modulus=4.0, fabric_width=0.2, first_crush_stress=1.0)
    run = cm.Simulation(material, cm.Grading.read(DATA / "sand.csv")).run(stress=[80.0])
    np.testing.assert_allclose(found[1, 0, -6:], run.curve().finer_than([1.6, 1.0, 0.5, 0.25, 0.125, 0.063]), atol=1e-3)

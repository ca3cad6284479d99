"""The closures beside the lattice: what is compared, what is advised, and the command."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from pictures import objections
from typer.testing import CliRunner

import comminute as cm
from comminute.cli.app import app

BAND = cm.Grading.from_sieves([1.0, 0.5], [100, 0], unit="mm")


@pytest.fixture(scope="module")
def band() -> cm.ClosureComparison:
    return cm.compare_closures(cm.Material(), BAND, stress_ratio=[1.0, 8.0, 123_456.0], cells=50_000, seed=1)


def test_curves_are_those_of_the_closures_and_of_the_lattice(band: cm.ClosureComparison) -> None:
    paper = cm.Simulation(cm.Material(), BAND).run(stress_ratio=[1.0, 8.0, 123_456.0])
    law = cm.Resolved(cm.Material(), BAND)
    for k, load in enumerate(band.stress_ratio.tolist()):
        law.load_to(load)
        np.testing.assert_array_equal(band.paper[k], paper.curve(k).finer_than(band.size))
        np.testing.assert_array_equal(band.resolved[k], law.cdf())
        assert band.step_error[k] == law.step_error
    np.testing.assert_allclose(band.size, np.exp(law.grid.upper), rtol=1e-11)
    np.testing.assert_array_equal(band.start, cm.SizeCurve.of(BAND).finer_than(band.size))
    lattice = cm.Lattice(50_000, cm.Material(), BAND, replicas=4, seed=1)
    lattice.load_to(8.0)
    counted = np.array([(ring[:, None] <= np.log(band.size)).mean(axis=0) for ring in lattice.psi])
    np.testing.assert_allclose(band.lattice[1], counted.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(band.lattice_error[1], counted.std(axis=0, ddof=1) / 2.0, atol=1e-12)


def test_exact_sizes_are_compared_on_either_side() -> None:
    found = cm.compare_closures(cm.Material(), cm.monodisperse(1.0), stress_ratio=1.0, cells=50_000)
    below, at = found.size[-2:]
    assert below < 1.0 <= at
    assert found.lattice[0, -2] == pytest.approx(0.432, abs=0.01)
    assert found.paper[0, -2] == pytest.approx(0.5, abs=1e-11)
    assert found.resolved[0, -2:] == pytest.approx([0.432332, 1.0], abs=1e-4)


def test_advice_goes_by_the_distances(band: cm.ClosureComparison) -> None:
    distances = band.distances
    assert (distances["paper"].distance[1:] > 0.08).all()
    assert (distances["resolved"].distance < 0.005).all()
    assert band.advice.startswith("Take the resolved closure: it is 0.00")
    assert band.advice.endswith("from the lattice at stress ratio 123500.")
    assert "resolved 0.00" in repr(band)
    titles = band.table().splitlines()[0].split()
    assert titles == ["stress", "ratio", "paper", "at", "mm", "resolved", "at", "mm", "noise", "step", "error"]
    broad = cm.compare_closures(cm.Material(), cm.power_law(2.5, 1e-3, 1.0), stress_ratio=1.5, cells=20_000)
    assert broad.advice.startswith("The paper's closure will do: at most 0.00")
    again = cm.compare_closures(cm.Material(), cm.power_law(2.5, 1e-3, 1.0), stress_ratio=1.5, cells=20_000, threads=2)
    assert again == broad


def test_mixing_is_passed_on_to_all_three() -> None:
    found = cm.compare_closures(
        cm.Material(), cm.monodisperse(1.0), stress_ratio=[8.0, 6.0], remix_after=[0], cells=50_000
    )
    assert (found.lattice[1] > found.lattice[0] + 0.01).any()
    assert (found.distances["resolved"].distance < 0.006).all()


def test_the_picture_says_what_it_shows(band: cm.ClosureComparison) -> None:
    figure = band.plot()
    assert isinstance(figure, Figure)
    assert objections(figure) == []
    left, right = figure.axes
    assert left.get_xlabel() == "grainsize (mm)"
    np.testing.assert_array_equal(left.lines[-1].get_data(), (band.size, band.paper[-1]))
    assert right.get_legend_handles_labels()[1] == ["paper", "resolved"]


CASE = """
[units]
size = "mm"
[material]
fabric_width = 0.05
reference_size = 1.0
[grading]
kind = "monodisperse"
size = 1.0
[load]
stress_ratio = [1.0, 8.0]
"""


def test_the_command_prints_distances_and_advice(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    picture = tmp_path / "closures.png"
    call = ["compare-closures", str(case), "--cells", "20000"]
    done = CliRunner().invoke(app, [*call, "--output", str(picture)])
    assert done.exit_code == 0, done.output
    assert "Take the resolved closure" in done.output
    assert picture.read_bytes()[:4] == b"\x89PNG"
    again = CliRunner().invoke(app, [*call, "--output", str(picture)])
    assert again.exit_code == 3
    found = json.loads(CliRunner().invoke(app, [*call, "--json"]).output)
    assert found["paper"]["distance"][0] == pytest.approx(0.0677, abs=0.01)
    assert found["stress_ratio"] == [1.0, 8.0]
    case.write_text(CASE + "loading_rate = 0.1\n")
    refused = CliRunner().invoke(app, call)
    assert refused.exit_code == 2
    assert "the lattice and the resolved closure are quasi-static: it must be 0" in refused.output
    case.write_text(CASE + "[engine]\nsteps_per_load = 3\n")
    assert "steps_per_load is 3" in CliRunner().invoke(app, call).output
    case.write_text(CASE + "[engine]\nkind = 'fast'\n")
    assert "kind is 'fast'" in CliRunner().invoke(app, call).output


@pytest.mark.filterwarnings("ignore:bins are .* wide")  # few on purpose
def test_bins_and_scheme_of_the_case_are_those_of_the_papers_closure(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(CASE + "[grid]\npsi_min = -6.0\npsi_max = 0.0\nbins = 61\n[engine]\nscheme = 'paper'\n")
    found = json.loads(CliRunner().invoke(app, ["compare-closures", str(case), "--cells", "2000", "--json"]).stdout)
    grid, material, start = cm.LogGrid(-6.0, 0.0, 61), cm.Material(), cm.monodisperse(1.0)
    ours = cm.compare_closures(
        material, start, stress_ratio=[1.0, 8.0], grid=grid, scheme="paper", cells=2000, replicas=4
    )
    assert found["paper"]["distance"] == ours.distances["paper"].distance.tolist()
    coarse = cm.Simulation(material, start, grid=grid, scheme="paper").run(stress_ratio=[1.0, 8.0])
    np.testing.assert_array_equal(ours.paper[1], coarse.curve(1).finer_than(ours.size))


def test_a_fabric_that_is_off_has_nothing_to_resolve() -> None:
    with pytest.raises(cm.ParameterError, match="fabric_width is inf"):
        cm.compare_closures(cm.Material(fabric_width=math.inf), cm.monodisperse(1.0), stress_ratio=1.0)

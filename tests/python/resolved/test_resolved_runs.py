"""Runs by the resolved closure: results that everything reads, files, cases, and what is refused."""

import json
import math
import re
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from pictures import objections
from typer.testing import CliRunner

import comminute as cm
from comminute import plotting
from comminute.cli.app import app
from comminute.runs.recipe import grading_of, grading_record
from comminute.runs.results import CLOSURE_ERRORS

MATERIAL = cm.Material(first_crush_stress=2.0)
SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100, 70, 20, 0], unit="mm")
LOADS = [1.0, 8.0, 2.0, 4.0]
PATH = {"stress_ratio": LOADS, "remix_after": [1]}
STARTS = {
    "equal": cm.monodisperse(1.0),
    "gap": cm.gap_graded(1.0, 0.2, 0.3).with_unit("mm"),
    "sand": SAND,
    "lognormal": cm.lognormal(0.5, 0.4),
    "fuller": cm.fuller(2.0),
    "rosin": cm.rosin_rammler(1.0, 1.5),
}


def run(start: cm.Grading, **path: object) -> cm.ResolvedResult:
    result = cm.Simulation(MATERIAL, start, closure="resolved").run(**(path or PATH))  # type: ignore[arg-type]
    assert isinstance(result, cm.ResolvedResult)
    return result


@pytest.fixture(scope="module")
def gap() -> cm.ResolvedResult:
    return run(STARTS["gap"])


@pytest.mark.parametrize("name", STARTS)
def test_a_run_is_the_law_by_bins(name: str) -> None:
    start = STARTS[name]
    result, law = run(start), cm.Resolved(MATERIAL, start)
    assert result.closure == "resolved"
    assert result.grid == law.grid
    assert np.unique(result.edge_size).size == result.grid.bins == result.pmf.shape[1]
    for k, load in enumerate(LOADS):
        law.load_to(load)
        mass, exact = law.pmf(), law.grid.exact
        np.testing.assert_array_equal(result.stress_ratio[k], load)
        assert result.crushes[k] == law.crushes
        assert [point.mass for point in result.points[k]] == mass[exact & (mass > 1e-15)].tolist()
        # a curve counts what is no larger than a size, at an edge with the exact size that lies on it
        upper, cdf = law.grid.upper, law.cdf()
        last = [np.flatnonzero(upper == edge)[-1] for edge in result.grid.edges[1:]]
        np.testing.assert_allclose(result.cdf[k], cdf[last], atol=1e-14)
        curve = result.curve(k)
        np.testing.assert_allclose(curve.finer_than(np.exp(upper[last])), cdf[last], atol=1e-12)
        if k == 1:
            law.remix()
    assert abs(result.mass_error).max() < 1e-14


def test_curves_jump_at_exact_sizes(gap: cm.ResolvedResult) -> None:
    for k in range(4):
        curve, sizes = gap.curve(k), [point.size for point in gap.points[k]]
        assert sizes == pytest.approx([0.2, 1.0], rel=1e-15)
        for point in gap.points[k]:
            below, at = curve.finer[curve.size == point.size]
            assert at - below == pytest.approx(point.mass, abs=1e-14)
    assert gap.percentile(100) == pytest.approx([1.0] * 4)
    assert gap.percentile(50)[0] == gap.curve(0).percentile(50) == pytest.approx(0.2, rel=1e-15)  # in the jump
    start = gap.start_curve
    assert start.finer_than([0.19, 0.2, 0.99, 1.0]).tolist() == [0.0, 0.7, 0.7, 1.0]


def test_sizes_that_are_asked_for_are_edges() -> None:
    sieves = [3.0, 1.4, 0.7, 0.075, 1e-4]
    sim = cm.Simulation(MATERIAL, SAND, closure="resolved", sizes=sieves)
    result = sim.run(stress_ratio=50.0)
    for size in (*sieves[1:], 2.0, 1.0, 0.5, 0.25):
        assert np.isclose(result.edge_size, size, rtol=1e-12).sum() == 1
    assert result.edge_size[-1] == pytest.approx(2.0)
    assert result.edge_size[0] <= 1e-4 * (1.0 + 1e-12)
    other = cm.Simulation(MATERIAL, SAND, closure="resolved").run(stress_ratio=50.0)
    distance = np.abs(result.curve().finer_than(sieves) - other.curve().finer_than(sieves)).max()
    assert 0.0 < distance < 0.008  # read between edges, and steps that differ


def test_a_measured_curve_bends_at_its_sieves_and_nowhere_else_at_no_load() -> None:
    result = run(SAND, stress_ratio=[1e-3])
    at = np.array([2.0, 1.0, 0.5, 0.25, 0.8])
    np.testing.assert_allclose(result.curve().finer_than(at), SAND.finer(at), atol=1e-12)
    assert result.crushes[0] == 0.0
    assert any("nothing crushed" in note for note in result.notes)


@pytest.mark.parametrize("name", STARTS)
def test_files_resumption_and_repetition_give_the_same_bits(name: str, tmp_path: Path) -> None:
    start = STARTS[name]
    whole = run(start)
    saved = cm.open_result(whole.save(tmp_path / "run.nc"))
    assert saved == whole
    assert type(saved) is cm.ResolvedResult
    assert saved.start == whole.start
    assert cm.run_again(saved) == whole
    sim = cm.Simulation(MATERIAL, start, closure="resolved")
    first = cm.open_result(sim.run(stress_ratio=[1.0, 8.0], remix_after=[1]).save(tmp_path / "first.nc"))
    assert first.resume(stress_ratio=[2.0, 4.0]) == whole
    whole.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as arrays:
        np.testing.assert_array_equal(arrays["pmf"], whole.pmf)
        assert "fabric" not in arrays


@pytest.mark.parametrize("name", STARTS)
def test_gradings_survive_as_text(name: str) -> None:
    again = grading_of(json.loads(json.dumps(grading_record(STARTS[name]))))
    assert again == STARTS[name]
    assert again.notes == STARTS[name].notes


def test_fabrics_are_computed_when_they_are_asked_for(gap: cm.ResolvedResult) -> None:
    assert gap.fabrics == (None,) * 4
    law = cm.Resolved(MATERIAL, STARTS["gap"])
    law.load_to(8.0)
    fabric = gap.fabric(1)
    np.testing.assert_allclose(fabric.probability, law.joint(fabric.grid), atol=1e-6)
    assert fabric.settled_at == 8.0
    assert gap.fabric(3).settled_at == 4.0
    assert gap.fabric(-1) == gap.fabric(3)
    assert fabric.grid == gap.start.grid
    assert fabric.probability.sum() == pytest.approx(1.0, abs=1e-12)
    with pytest.raises(IndexError):
        gap.fabric(4)


def test_pictures_and_indices_read_uneven_bins(gap: cm.ResolvedResult) -> None:
    picture = gap.plot(1)
    assert isinstance(picture, Figure)
    assert objections(picture) == []
    for index in ("D50", "B", "crushes", "fines"):
        drawn = plotting.plot_index(gap, index).lines[0].get_ydata()
        assert np.isfinite(np.asarray(drawn, dtype=float)).all()
    assert cm.breakage_index(gap.start_curve, gap.curve(1)).index > 0.0


def test_the_slider_goes_over_all_loads(gap: cm.ResolvedResult) -> None:
    control = gap.slider().children[0]
    assert [k for _, k in control.options] == [0, 1, 2, 3]


def test_many_materials_are_their_single_runs() -> None:
    materials = [cm.Material(fabric_width=n, weibull_modulus=w) for n in (0.05, 0.1) for w in (3.0, 5.0)]
    loads = np.array([[1.0, 4.0], [2.0, 8.0], [8.0, 2.0], [1.5, 100.0]])
    grid = cm.ResolvedGrid.fitting(STARTS["gap"], 0.05)
    found = cm.resolved_gradings(materials, STARTS["gap"], loads)
    np.testing.assert_array_equal(found, cm.resolved_gradings(materials, STARTS["gap"], loads, threads=3))
    for m, material in enumerate(materials):
        law = cm.Resolved(material, STARTS["gap"], grid)
        for t, load in enumerate(loads[m].tolist()):
            law.load_to(load)
            np.testing.assert_array_equal(found[m, t], law.pmf())
    same = cm.resolved_gradings(materials[:2], STARTS["gap"], [1.0, 4.0])
    np.testing.assert_array_equal(same[0], found[0])
    with pytest.raises(cm.ShapeError, match="there are 4 materials"):
        cm.resolved_gradings(materials, STARTS["gap"], np.array([[1.0]]))
    with pytest.raises(cm.ParameterError, match=r"materials\[1\].*stress_ratio"):
        cm.resolved_gradings(materials[:2], STARTS["gap"], np.array([[1.0], [-1.0]]))


def test_what_the_closure_does_not_take_is_refused() -> None:
    grid = cm.LogGrid(-6.0, 0.0, 61)
    fabric = cm.mixed_fabric(cm.monodisperse(1.0), grid)
    sim = cm.Simulation(MATERIAL, SAND, closure="resolved")
    refused: dict[str, Callable[[], object]] = {
        "start .*knows the mean of two neighbours.*from_lattice": lambda: cm.Simulation(
            MATERIAL, fabric, closure="resolved"
        ),
        "grid is .*leave it out": lambda: cm.Simulation(MATERIAL, SAND, grid=grid, closure="resolved"),
        "scheme is 'paper'.*leave it out": lambda: cm.Simulation(MATERIAL, SAND, scheme="paper", closure="resolved"),
        "closure is 'triple'.*'paper', 'resolved'": lambda: cm.Simulation(MATERIAL, SAND, closure="triple"),  # type: ignore[arg-type]
        r"sizes is \[1, 2\].*closure = 'resolved'": lambda: cm.Simulation(MATERIAL, SAND, sizes=[1.0, 2.0]),
        r"sizes\[1\] is 0": lambda: cm.Simulation(MATERIAL, SAND, closure="resolved", sizes=[1.0, 0.0]),
        "fabric_width is inf": lambda: cm.Simulation(cm.Material(fabric_width=math.inf), SAND, closure="resolved"),
        "engine is 'quasi-static'.*leave it out": lambda: sim.run(stress_ratio=1.0, engine="quasi-static"),
        "loading_rate is 0.5.*must be 0": lambda: sim.run(stress_ratio=1.0, loading_rate=0.5),
        "kind is 'fast'": lambda: sim.run(stress_ratio=1.0, kind="fast"),
        "steps_per_load is 3": lambda: sim.run(stress_ratio=1.0, steps_per_load=3),
        "keep_fabrics is 'all'.*keeps none": lambda: sim.run(stress_ratio=1.0, keep_fabrics="all"),
        "compare_closures": lambda: cm.compare(run(SAND, stress_ratio=[1.0]), cm.Simulation(MATERIAL, SAND).run(1.0)),
    }
    for words, call in refused.items():
        with pytest.raises(cm.ParameterError, match=words):
            call()


def test_much_mass_in_the_fines_is_said() -> None:
    wide = cm.Material(fabric_width=0.4, fragments=cm.PowerLawFragments(0.1))
    with pytest.warns(cm.ResolutionWarning, match="fines bin.*ask for finer sizes") as said:
        result = cm.Simulation(wide, cm.monodisperse(1.0), closure="resolved").run(stress_ratio=1e4)
    assert said[0].filename == __file__
    size = 0.01 * result.edge_size[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        deeper = cm.Simulation(wide, cm.monodisperse(1.0), closure="resolved", sizes=[size]).run(stress_ratio=1e4)
    # of fragments that fine almost none crushes again, and so the share is the fragment law's
    assert deeper.fines[0] == pytest.approx(0.01**0.1 * result.fines[0], rel=0.02)
    with pytest.warns(cm.ResolutionWarning) as said:
        cm.Simulation(wide, cm.monodisperse(1.0), grid=cm.LogGrid(-3.0, 0.0, 61)).run(stress_ratio=1e4)
    assert {warning.filename for warning in said} == {__file__}


@pytest.mark.parametrize(("file", "scattered"), [("three_cells.md", False), ("three_cells_scattered.md", True)])
def test_the_closure_error_is_the_worst_of_the_validation(file: str, scattered: bool) -> None:
    page = (Path(__file__).parents[3] / "docs" / "validation" / file).read_text()
    worst: dict[float, float] = {}
    for width, distances in re.findall(r"^\| n = ([\d.]+)[^|]*\|[^|]*\|([\d |]+)\|$", page, re.MULTILINE):
        found = max(int(number) for number in distances.split("|")) * 1e-4
        worst[float(width)] = max(worst.get(float(width), 0.0), found)
    rising = dict(zip(sorted(worst), np.maximum.accumulate([worst[width] for width in sorted(worst)]), strict=True))
    assert CLOSURE_ERRORS[scattered] == pytest.approx(rising)
    material = cm.Material(fabric_width=0.1, strength_scatter=scattered)
    result = cm.Simulation(material, SAND, closure="resolved").run(stress_ratio=1.0)
    assert isinstance(result, cm.ResolvedResult)
    assert result.closure_error == CLOSURE_ERRORS[scattered][0.1]


def test_how_near_the_closure_is_stands_in_the_notes() -> None:
    result = run(SAND, stress_ratio=[1.0])
    assert result.closure_error == 0.0036
    assert any("0.0036" in note for note in result.notes)
    unknown = cm.Simulation(cm.Material(fabric_width=0.6), SAND, closure="resolved").run(stress_ratio=1.0)
    assert any("not at fabric width 0.6" in note for note in unknown.notes)


def test_closures_of_other_results() -> None:
    assert cm.Simulation(MATERIAL, SAND).run(1.0).closure == "paper"
    assert cm.Lattice(100, MATERIAL, SAND).run(1.0).closure == "none"


CASE = """
[material]
reference_size = 2.0
[grading]
kind = "gap-graded"
coarse = 2.0
fine = 0.2
[load]
stress_ratio = [1.0, 8.0, 4.0]
remix_after = [1]
[engine]
closure = "resolved"
sizes = [0.5, 0.075]
"""


def invoke(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(app, [str(word) for word in words])
    return done.exit_code, done.output


def test_a_case_is_run_by_the_closure_that_it_names(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    code, said = invoke("check", case)
    assert code == 0
    assert "closure: resolved" in said
    code, said = invoke("run", case)
    assert code == 0, said
    result = cm.open_result(tmp_path / "run.nc")
    start = cm.gap_graded(2.0, 0.2).with_unit("mm")
    expected = cm.Simulation(cm.Material(reference_size=2.0), start, closure="resolved", sizes=[0.5, 0.075])
    np.testing.assert_array_equal(result.pmf, expected.run([1.0, 8.0, 4.0], remix_after=[1]).pmf)
    for words in (("stats", tmp_path / "run.nc"), ("plot", tmp_path / "run.nc", "--what", "fabric")):
        code, said = invoke(*words)
        assert code == 0, said
    code, said = invoke("run", tmp_path / "run.nc")
    assert code == 0, said
    assert "every array equals" in said
    code, said = invoke("compare-closures", case, "--cells", 2000)
    assert code == 0, said


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("[grid]\nbins = 50\n", r"bins.*\[grid\]|\[grid\].*bins"),
        ('[output]\nfabrics = "all"\n', "keeps none"),
    ],
)
def test_a_case_with_what_the_closure_does_not_take_is_refused(line: str, words: str, tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(CASE + line)
    code, said = invoke("check", case)
    assert code == 2
    assert re.search(words, said), said
    case.write_text(CASE + 'scheme = "paper"\n')
    code, said = invoke("check", case)
    assert (code, "[engine]" in said) == (2, True)
    case.write_text(CASE.replace("remix_after = [1]", "loading_rate = 0.5"))
    assert invoke("check", case)[0] == 2

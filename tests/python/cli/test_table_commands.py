"""Tables, comparisons and several files on the command line, and an engineer's hour with them."""

import json
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from typer.testing import CliRunner, Result

import comminute as cm
from comminute.cli.app import app

DATA = Path(__file__).parents[3] / "examples" / "calibration"
SAND, AFTER = DATA / "sand.csv", DATA / "sand-20MPa.csv"


def call(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    material = cm.Material(reference_size=2.0, fabric_width=0.3, first_crush_stress=2.0)
    return cm.Simulation(material, cm.Grading.read(SAND)).run(stress=[5.0, 20.0]).save(folder / "run.nc")


def test_a_table_is_that_of_the_result(run_file: Path, tmp_path: Path) -> None:
    result = cm.open_result(run_file)
    target = tmp_path / "table.csv"
    done = call("table", run_file, "--sieves", "2,1,0.5", "--percentiles", "25,90", "-o", target)
    assert done.exit_code == 0, done.output
    assert str(result.grading_table([2.0, 1.0, 0.5])) in done.output
    assert str(result.load_table(["D25", "D90", "fines", "crushes"])) in done.output
    assert target.read_text().startswith("size (mm),start,")
    assert (tmp_path / "table-loads.csv").exists()
    assert call("table", run_file, "-o", target).exit_code == 3


def test_several_files_stand_side_by_side(run_file: Path) -> None:
    found = json.loads(call("table", SAND, AFTER, run_file, "--json").output)
    assert set(found) == {"gradings", "loads of run"}
    heads = ["size (mm)", "sand", "sand-20MPa", "run: start", "run: stress 5", "run: stress 20"]
    assert list(found["gradings"][0]) == heads
    assert [row["sand"] for row in found["gradings"]] == pytest.approx([100, 93, 67, 33, 13, 1])


def test_a_comparison_has_what_needs_both_gradings() -> None:
    rows = {row["index"]: row for row in json.loads(call("compare", SAND, AFTER, "--json").output)["comparison"]}
    before, after = cm.Grading.read(SAND), cm.Grading.read(AFTER)
    assert rows["Hardin Br"]["after"] == pytest.approx(cm.relative_breakage(before, after))
    assert rows["Einav B"]["after"] == pytest.approx(cm.breakage_index(before, after).index)
    mill = cm.milling(before, after)
    assert (rows["F80, P80 (mm)"]["before"], rows["F80, P80 (mm)"]["after"]) == (mill.f80, mill.p80)
    assert rows["D50 (mm)"]["after/before"] == pytest.approx(after.percentile(50) / before.percentile(50))


def test_several_files_have_their_indices_below_each_other() -> None:
    found = json.loads(call("stats", SAND, AFTER, "--percentiles", "25,90", "--json").output)
    assert [one["gradings"][0]["of"] for one in found["files"]] == ["sand.csv", "sand-20MPa.csv"]
    assert found["files"][1]["gradings"][0]["D90"] == pytest.approx(cm.Grading.read(AFTER).percentile(90))
    assert "D5" not in found["files"][0]["gradings"][0]
    assert call("stats", SAND, AFTER).output.count("sizes in mm") == 2


def test_points_lie_over_curves_in_a_picture(run_file: Path, tmp_path: Path) -> None:
    for number, files in enumerate(([run_file], [run_file, SAND], [SAND, AFTER])):
        target = tmp_path / f"{number}.png"
        done = call("plot", *files, "--measured", f"{AFTER}@20MPa", "-o", target)
        assert done.exit_code == 0, done.output
        bare = tmp_path / f"bare-{number}.png"
        assert call("plot", *files, "-o", bare).exit_code == 0
        assert target.read_bytes() != bare.read_bytes()


def test_several_cases_run_in_one_command(tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert call("new", tmp_path / name).exit_code == 0
    done = call("run", tmp_path / "a" / "case.toml", tmp_path / "b" / "case.toml")
    assert done.exit_code == 0, done.output
    assert cm.open_result(tmp_path / "a" / "run.nc") == cm.open_result(tmp_path / "b" / "run.nc")
    twice = call("run", tmp_path / "a" / "case.toml", tmp_path / "a" / "case.toml", "--force")
    assert twice.exit_code == 2
    assert "would write run.nc twice" in twice.output
    assert call("run", tmp_path / "a" / "run.nc", tmp_path / "b" / "case.toml").exit_code == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["table", SAND, "--percentiles", "50,110"], "--percentiles is '110'; it must be numbers up to 100"),
        (["table", SAND, "--sieves", "ISO R99"], "ISO R99"),
        (["table", SAND, "-o", "table.txt"], "it must end in .csv, .xlsx"),
        (["plot", SAND, "--what", "index"], "sand.csv is a sieve table"),
        (["plot", SAND, AFTER, "--what", "fabric"], "it has gradings alone"),
        (["plot", SAND, "--measured", AFTER, "--phi"], "points go over semilog and loglog axes"),
        (["plot", SAND, "--measured", f"{SAND}"], "the stress of"),
    ],
)
def test_wrong_words_are_refused_with_the_rule(words: list[object], message: str, tmp_path: Path) -> None:
    target = [] if "-o" in words else ["-o", tmp_path / "out.png"] if words[0] == "plot" else []
    done = call(*words, *target)
    assert done.exit_code == 2
    assert message in done.output


def test_an_engineers_hour(tmp_path: Path) -> None:
    # A workbook with two crushed samples comes in; a prediction at a new stress, a table and a figure go out.
    book = openpyxl.Workbook()
    sheet = book.active
    samples = {name: cm.Grading.read(DATA / f"{name}.csv") for name in ("sand-10MPa", "sand-40MPa")}
    sieves = [2.0, 1.6, 1.0, 0.5, 0.25, 0.125, 0.063, 0.032]
    sheet.append(["sieve mm", "B1 % passing", "B2 % passing"])
    for size in sieves:
        sheet.append([size, *(round(100.0 * grading.finer(size), 1) for grading in samples.values())])
    book.save(tmp_path / "tests.xlsx")

    read = [cm.Grading.read(tmp_path / "tests.xlsx", sample=name) for name in ("B1", "B2")]
    for grading, given in zip(read, samples.values(), strict=True):
        np.testing.assert_allclose(grading.finer(sieves), given.finer(sieves), atol=1e-3)

    case, target = tmp_path / "fitted.toml", tmp_path / "fit.png"
    measured = [f"{tmp_path / 'tests.xlsx'}#B1@10MPa", f"{tmp_path / 'tests.xlsx'}#B2@40MPa"]
    fit = ["fit", *measured, "--start", SAND, "--fix", "weibull_modulus=4", "--free", "fabric_width,first_crush_stress"]
    fitted = call(*fit, "-o", case, "-o", target)
    assert fitted.exit_code == 0, fitted.output

    case.write_text(case.read_text().replace("stress = [10.0, 40.0]", "stress = [10.0, 40.0, 80.0]"))
    assert call("run", case).exit_code == 0
    table = tmp_path / "gradings.xlsx"
    assert call("table", tmp_path / "run.nc", "--sieves", "ISO R20/3", "-o", table).exit_code == 0
    assert openpyxl.load_workbook(table).sheetnames == ["gradings", "loads"]
    figure = tmp_path / "figure.png"
    over = [word for text in measured for word in ("--measured", text)]
    drawn = call("plot", tmp_path / "run.nc", *over, "-o", figure)
    assert drawn.exit_code == 0, drawn.output
    assert figure.stat().st_size > 20_000

    predicted = cm.open_result(tmp_path / "run.nc").curve(2)
    seen = cm.Grading.read(DATA / "sand-80MPa.csv")
    gap = np.abs(predicted.finer_than(sieves) - seen.finer(sieves))
    assert gap.max() < 0.15  # the paper's closure is off by as much in the fit itself
    assert np.sqrt(np.mean(gap**2)) < 0.06

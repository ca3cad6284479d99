"""The command line as its users meet it: words, exit codes, and files."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("typer")
pytest.importorskip("h5netcdf")

from commands import call

CASE = """
[material]
reference_size = 2.0
first_crush_stress = 1.2
[grading]
file = "sand.csv"
[grid]
bins = 100
[load]
stress = [1.2, 12.0, 24.0]
"""
SAND = "size_mm,percent_finer\n2,100\n1,60\n0.5,20\n0.2,0\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "sand.csv").write_text(SAND)
    return tmp_path


def test_new_check_run_stats_plot(tmp_path: Path) -> None:
    made = tmp_path / "mine"
    assert call("new", made).exit_code == 0
    assert sorted(p.name for p in made.iterdir()) == ["case.toml", "sand.csv"]
    assert call("new", made).exit_code == 3
    assert call("new", made, "--force").exit_code == 0
    checked = call("check", made / "case.toml")
    assert checked.exit_code == 0
    assert "run.nc: 9 loads, stress 1.2 to 120 MPa" in checked.output
    assert sorted(p.name for p in made.iterdir()) == ["case.toml", "sand.csv"]
    done = call("run", made / "case.toml")
    assert done.exit_code == 0, done.output
    header = "stress MPa stress ratio d10 mm d50 mm d60 mm fines crushes"
    assert " ".join(done.output.splitlines()[0].split()) == header
    assert len(done.output.splitlines()) == 13
    assert "material: reference size 2 mm, first crush stress 1.2 MPa, weibull modulus 3" in done.output
    stats = json.loads(call("stats", made / "run.nc", "--json").output)
    assert stats["unit"] == "mm"
    assert stats["gradings"][0]["D50"] == pytest.approx(0.5 * 2**0.5, rel=1e-3)
    assert stats["gradings"][-1]["Einav B"] > 0.0
    assert (stats["gradings"][-1]["stress"], stats["gradings"][-1]["stress_ratio"]) == (120.0, 100.0)
    table = call("stats", made / "run.nc").output.splitlines()
    assert " ".join(table[1].split()) == "stress (MPa) start 1.2 2.134 3.795 6.748 12 21.34 37.95 67.48 120"
    for what in ("gradings", "fabric", "index"):
        assert call("plot", made / "run.nc", "--what", what, "-o", made / f"{what}.png").exit_code == 0
        assert (made / f"{what}.png").stat().st_size > 10_000
    assert call("plot", made / "run.nc", "-o", made / "index.png").exit_code == 3
    assert call("plot", made / "sand.csv", "--axes", "loglog", "--coarse-left").exit_code == 0
    assert call("plot", made / "sand.csv", "--what", "fabric", "-o", made / "f.png").exit_code == 2
    computed = call("plot", made / "run.nc", "--what", "fabric", "--load", "3", "-o", made / "f.png")
    assert computed.exit_code == 0, computed.output  # one that the file does not hold


def test_a_run_equals_the_library_and_carries_its_case(folder: Path) -> None:
    assert call("run", folder / "case.toml").exit_code == 0
    result = cm.open_result(folder / "run.nc")
    material = cm.Material(reference_size=2.0, first_crush_stress=1.2)
    sand = cm.Grading.read(folder / "sand.csv")
    by_hand = cm.Simulation(material, sand, grid=result.grid).run(stress=[1.2, 12.0, 24.0])
    np.testing.assert_array_equal(result.pmf, by_hand.pmf)
    np.testing.assert_array_equal(result.crushes, by_hand.crushes)
    assert result.fabric(-1) == by_hand.fabric(-1)
    assert result.to_xarray()["stress"].attrs["units"] == "MPa"
    assert "units" not in by_hand.to_xarray()["stress"].attrs
    assert result.recipe is not None
    assert json.loads(result.recipe.case)["grading"]["size"] == [2.0, 1.0, 0.5, 0.2]
    assert cm.run_again(result) == result


def test_a_result_runs_again_without_its_case(folder: Path) -> None:
    assert call("run", folder / "case.toml").exit_code == 0
    (folder / "case.toml").unlink()
    (folder / "sand.csv").unlink()
    again = call("run", folder / "run.nc")
    assert again.exit_code == 0
    assert "run-again.nc: every array equals that of run.nc" in again.output
    assert cm.open_result(folder / "run-again.nc") == cm.open_result(folder / "run.nc")
    assert call("run", folder / "run.nc").exit_code == 3


def test_json_is_one_object_and_nothing_else(folder: Path) -> None:
    found = json.loads(call("run", folder / "case.toml", "--json").stdout)
    (run,) = found["runs"]
    assert [row["stress"] for row in run["loads"]] == [1.2, 12.0, 24.0]
    assert run["unit"] == "mm"
    (checked,) = json.loads(call("check", folder / "case.toml", "--json").stdout)
    assert checked["material"]["weibull_modulus"] == cm.Material().weibull_modulus
    assert json.loads(call("doctor", "--json").stdout)["comminute"] == cm.__version__


def test_nothing_is_overwritten_without_force(folder: Path) -> None:
    assert call("run", folder / "case.toml").exit_code == 0
    before = (folder / "run.nc").read_bytes()
    refused = call("run", folder / "case.toml")
    assert refused.exit_code == 3
    assert "run.nc exists; --force overwrites it, --output names another file" in refused.stderr
    assert (folder / "run.nc").read_bytes() == before
    assert call("run", folder / "case.toml", "-o", folder / "other.nc").exit_code == 0
    assert cm.open_result(folder / "other.nc") == cm.open_result(folder / "run.nc")
    assert call("run", folder / "case.toml", "--force").exit_code == 0
    assert call("run", folder / "case.toml", "-o", folder / "other.txt").exit_code == 2


def test_a_sweep_writes_a_file_for_each_value(folder: Path) -> None:
    (folder / "case.toml").write_text(CASE.replace("[material]", "[material]\nweibull_modulus = [3.0, 6.0]"))
    done = call("run", folder / "case.toml")
    assert "run 2 of 2: material.weibull_modulus = 6.0" in done.output
    assert cm.open_result(folder / "run-2.nc").material.weibull_modulus == 6.0
    assert call("run", folder / "case.toml", "-o", folder / "one.nc").exit_code == 2
    assert call("run", folder / "case.toml", "--resume").exit_code == 0


ROWS = [
    ("sand.csv", "1,60", "1,10", "sand.csv row 3: 10 % finer at 1 mm is less than 20 % at 0.5 mm"),
    (
        "sand.csv",
        "1,60\n0.5,20",
        "0.3,50\n0.6,40",
        "error: sand.csv row 4: 40 % finer at 0.6 mm is less than 50 % at 0.3 mm; "
        "cumulative per cent finer cannot fall with size. Retained percentages? name the column percent_retained.",
    ),
    ("sand.csv", "1,60", "0,60", "sand.csv row 3, column size_mm: the value is 0; a size must be greater than 0"),
    ("sand.csv", "1,60", "nan,60", "sand.csv row 3, column size_mm: the value is 'nan'; it must be a number"),
    ("sand.csv", "1,60", "1,many", "sand.csv row 3, column percent_finer: the value is 'many'; it must be a number"),
    ("sand.csv", "1,60", "0.5,60", "size 0.5 mm stands already in sand.csv row "),
    ("sand.csv", SAND, "", "sand.csv is empty; it needs a header line and at least two sieves"),
    (
        "sand.csv",
        "2,100",
        "2,90",
        "sand.csv: the coarsest sieve, 2 mm, has 90 % finer, not 100 %; add the size that all "
        'grains pass, or write top = "extend" in [grading] to carry the last slope on to 100 %',
    ),
    ("case.toml", "1.2, 12.0", "-1.2, 12.0", "case.toml [load]: stress[0] is -1.2; it must be a number of at least 0"),
    ("case.toml", "1.2, 12.0", "nan, 12.0", "case.toml [load]: stress[0] is nan; it must be a number of at least 0"),
    (
        "case.toml",
        "bins",
        "psi_max = 0.0\nbins",
        "case.toml [grid]: the largest grain, 2, lies above the grid's top edge, 1.0",
    ),
    (
        "case.toml",
        "first_crush_stress = 1.2",
        "",
        "case.toml [load]: stress is 1.2; it needs first_crush_stress, which is not set. Set it in [material], or give",
    ),
    ("case.toml", "bins = 100", "bins = 7", "case.toml [grid]: bins is 7; it must be at least 8"),
    ("case.toml", "[material]", "[material]\nfabric_width = 0", "fabric_width is 0; it must be greater than 0"),
    ("case.toml", "[material]", "[material]\nweibull_modulus = -1", "weibull_modulus is -1; it must be greater than 0"),
    ("case.toml", "[material]", "[material]\nfragments = { scale = 0 }", "scale is 0; it must be greater than 0"),
    ("case.toml", "[material]", "[material]\nfragments = { shape = -1 }", "shape is -1; it must be greater than 0"),
    (
        "case.toml",
        'file = "sand.csv"',
        'kind = "gap-graded"\ncoarse = 2\nfine = 1\ncoarse_share = 2',
        "coarse_share is 2; it must be between 0 and 1",
    ),
    (
        "case.toml",
        "[material]",
        "[material]\nweibul_modulus = 3",
        "[material]: weibul_modulus is an unknown key; did you mean weibull_modulus?",
    ),
]


@pytest.mark.parametrize(("name", "old", "new", "words"), ROWS)
def test_mistakes_are_answered_in_a_line(name: str, old: str, new: str, words: str, folder: Path) -> None:
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1))
    for verb in ("check", "run"):
        answer = call(verb, folder / "case.toml")
        assert answer.exit_code == 2
        assert answer.stdout == ""
        assert answer.stderr.count("\n") == 1
        assert words in answer.stderr
    assert not list(folder.glob("*.nc"))


REMARKS = [
    (("sand.csv", SAND, "size_mm,percent_finer\n2,1\n1,0.6\n0.5,0\n"), "note: the values end at 1: read as fractions"),
    (("sand.csv", "0.2,0", "0.2,3"), "note: 3 % is finer than the finest sieve, 0.2 mm: it continues as a power law"),
    (
        ("case.toml", "[1.2, 12.0, 24.0]", "[0.6]"),
        "note: stress ratios below 1 crush only grains larger than the reference",
    ),
    (("case.toml", "[1.2, 12.0, 24.0]", "[12, 1.2]"), "note: unloading changes nothing"),
    (
        ("case.toml", "[1.2, 12.0, 24.0]", "[0]"),
        "note: nothing crushed: the load path stays below what the weakest grain",
    ),
    (("case.toml", "bins", "psi_min = -0.5\nbins"), "% of the start lies in the fines bin: curves below a size of"),
]


@pytest.mark.parametrize(("change", "words"), REMARKS)
def test_what_is_allowed_but_may_surprise_is_said(change: tuple[str, str, str], words: str, folder: Path) -> None:
    name, old, new = change
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1))
    done = call("run", folder / "case.toml")
    assert done.exit_code == 0, done.output
    assert words in done.output


def test_a_coarse_finest_sieve_is_said_once_and_followed_on_request(folder: Path) -> None:
    (folder / "sand.csv").write_text("size_mm,percent_retained\n4,0\n2,12.5\n0.4,60\npan,27.5\n")
    short = call("stats", folder / "sand.csv")
    assert short.exit_code == 0
    assert short.output.splitlines()[-1] == (
        "-: D5, D10, D16, D25 lie below the finest size of the curve, 0.4 mm, which 27.5 % are finer than; "
        "--extrapolate follows the tail"
    )
    assert "note: 27.5 % is finer than the finest sieve" in short.output
    followed = json.loads(call("stats", folder / "sand.csv", "--extrapolate", "--json").output)
    sand = cm.Grading.read(folder / "sand.csv")
    (row,) = followed["gradings"]
    assert row["D10"] == pytest.approx(sand.percentile(10, extrapolate=True))
    assert row["Cu"] == pytest.approx(cm.uniformity(sand, extrapolate=True))
    assert row["because"] == {}


def test_options_of_sieve_tables_hold_for_stats_and_plot(folder: Path) -> None:
    (folder / "sand.csv").write_text("size_mm,percent_finer\n2,95\n1,60\n0.5,0\n")
    for verb in ("stats", "plot"):
        refused = call(verb, folder / "sand.csv")
        assert refused.exit_code == 2
        assert "or pass --top extend to carry the last slope on" in refused.stderr
        assert call(verb, folder / "sand.csv", "--top", "extend", "--number").exit_code == 0


@pytest.mark.parametrize(("words", "ending"), [(("run", "case.toml"), "nc"), (("plot", "sand.csv"), "png")])
def test_an_output_that_cannot_be_is_refused_at_once(words: tuple[str, str], ending: str, folder: Path) -> None:
    verb, name = words
    for output, rule in (
        (folder / "out.txt", "it must end in ."),
        (folder / "no" / f"out.{ending}", "its folder does"),
    ):
        refused = call(verb, folder / name, "-o", output)
        assert refused.exit_code == 2
        assert f"--output is '{output}'; {rule}" in refused.stderr


def test_cite_and_version() -> None:
    assert "10.1016/j.jmps.2020.103897" in call("cite").output
    assert call("--version").output.strip() == cm.__version__
    assert call("nonsense").exit_code == 2


@pytest.mark.parametrize("library", ["typer", "pydantic", "h5netcdf"])
def test_without_the_extra_the_command_names_it(library: str) -> None:
    script = f"import sys; sys.modules['{library}'] = None; sys.argv[1:] = ['doctor']\n"
    script += "from comminute.__main__ import main; main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    if library == "h5netcdf":
        assert done.returncode == 0  # it is needed for files alone
        return
    assert done.returncode == 5
    assert done.stderr.strip() == f"comminute needs {library}; install it with: pip install 'comminute[cli]'"


def test_marks_of_what_was_not_measured(tmp_path: Path) -> None:
    folder = Path(__file__).parents[2] / "data" / "field-cases"
    tail = folder / "k8-fines-content-from-a-4mm-sieve.csv"
    plain = json.loads(call("stats", tail, "--json").output)["gradings"][0]
    assert plain["D50"] is None
    assert plain["marks"] == {"extrapolated": ["Hardin Bp", "finer than 0.063 mm", "void ratio"]}
    followed = json.loads(call("stats", tail, "--json", "--extrapolate").output)["gradings"][0]
    assert {"D10", "D50", "phi50", "Cu", "Folk-Ward mean"} <= set(followed["marks"]["extrapolated"])
    assert {"D60", "D80"}.isdisjoint(followed["marks"]["extrapolated"])
    assert "*: rests on the tail below the finest size, which is not measured" in call("stats", tail).output
    path = tmp_path / "open.csv"
    path.write_text("size_mm,percent_finer\n1,90\n0.5,40\n0.25,0\n")
    extended = json.loads(call("stats", path, "--top", "extend", "--json").output)["gradings"][0]
    assert "D95" in extended["marks"]["extended"]
    assert "D84" not in extended["marks"]["extended"]
    assert isinstance(extended["D95"], float)


def test_options_of_sieve_tables_are_used_or_refused(tmp_path: Path) -> None:
    folder = Path(__file__).parents[2] / "data" / "field-cases"
    long = folder / "k6-two-samples-in-long-table-merged.csv"
    named = json.loads(call("stats", long, "--sample", "A", "--json").output)
    assert named["gradings"][0]["D50"] == pytest.approx(1.542211, rel=1e-6)
    for options, words in (
        ((), "holds 2 samples in its rows, 'A', 'B'; name one"),
        (("--sample", "A", "--mesh", "tyler"), "names no sieve by a number"),
        (("--sample", "A", "--sheet", "x"), "is a text file, which has no sheets"),
        (("--sample", "A", "--total-mass-g", "1"), "total_mass_g is 1, less than the 350 g on the sieves"),
    ):
        done = call("stats", long, *options)
        assert done.exit_code == 2
        assert words in done.stderr


def test_a_run_whose_reader_has_gone_is_finished_all_the_same(folder: Path) -> None:
    text = (folder / "case.toml").read_text()
    many = ", ".join(str(1.2 + k) for k in range(40))
    (folder / "case.toml").write_text(text.replace("[1.2, 12.0, 24.0]", f"[{many}]"))
    command = [sys.executable, "-m", "comminute", "run", str(folder / "case.toml")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        assert "stress MPa" in run.stdout.readline()
        run.stdout.close()
        assert run.stderr is not None
        assert run.stderr.read() == ""
    assert run.returncode == 0
    assert [file.name for file in folder.glob("*.nc*")] == ["run.nc"]
    assert cm.open_result(folder / "run.nc").stress_ratio.size == 40


def test_void_ratios_in_the_table_of_indices(tmp_path: Path) -> None:
    file = tmp_path / "sand.csv"
    file.write_text("size_mm,percent_finer\n2,100\n1,60\n0.5,0\n")
    plain, calibrated = call("stats", file, "--json"), call("stats", file, "--void-ratio", 0.62, "--json")
    grading = cm.Grading.read(file)
    rows = [json.loads(one.stdout)["gradings"][0]["void ratio"] for one in (plain, calibrated)]
    assert rows == [cm.packing.void_ratio(grading), pytest.approx(0.62, rel=1e-9)]
    assert "a mere default; --void-ratio calibrates it" in call("stats", file).stdout
    refused = call("stats", file, "--void-ratio", 0.01)
    assert refused.exit_code == 2
    assert "this grading has" in refused.stderr

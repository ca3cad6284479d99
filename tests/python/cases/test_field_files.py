"""Cases as they came from users: the reference size is asked for, load files carry units, titles keep apart."""

from pathlib import Path

import pytest

pytest.importorskip("pydantic")
pytest.importorskip("typer")

from typer.testing import CliRunner

import comminute as cm
from comminute.cases.load_files import read_loads
from comminute.cases.reading import read_case
from comminute.cli.app import app

FOLDER = Path(__file__).parents[2] / "data" / "field-cases"
MEASURED = """
[units]
size = "{unit}"
[material]
first_crush_stress = 1.0
{line}
[grading]
file = "sand.csv"
{key}
[load]
stress = [10.0]
"""


@pytest.mark.parametrize(("unit", "one"), [("mm", "1"), ("um", "1000")])
def test_a_measured_grading_needs_a_reference_size(unit: str, one: str) -> None:
    with pytest.raises(cm.ParameterError) as refused:
        read_case(FOLDER / f"k7-reference-size-left-out-{unit}.toml")
    assert "[material]: reference_size is missing" in str(refused.value)
    assert f"add the line reference_size = {one} (in {unit}: 1 mm" in str(refused.value)


def written(folder: Path, line: str, key: str, table: str) -> Path:
    (folder / "sand.csv").write_text(table)
    path = folder / "case.toml"
    path.write_text(MEASURED.format(unit="mm", line=line, key=key))
    return path


def test_options_of_a_sieve_table_in_a_case(tmp_path: Path) -> None:
    table = "size_mm,A,B\n4,100,100\n2,80,70\n1,0,0\n"
    one = read_case(written(tmp_path, "reference_size = 1.0", 'sample = "B"', table))
    assert one[0].grading.finer(2.0) == 0.7
    both = read_case(written(tmp_path, "reference_size = 1.0", 'sample = ["A", "B"]', table))
    assert [ready.grading.finer(2.0) for ready in both] == [0.8, 0.7]
    with pytest.raises(cm.ParameterError, match="holds no masses; leave it out"):
        read_case(written(tmp_path, "reference_size = 1.0", 'total_mass_g = 9.0\nsample = "A"', table))


def test_load_files(tmp_path: Path) -> None:
    assert read_loads(FOLDER / "k17-load-file-unit-in-header.csv", "MPa") == ("stress", [0.1, 1.0, 10.0])
    path = tmp_path / "load.csv"
    for text, found in (
        ("stress (kPa)\n100\n1000\n", ("stress", [0.1, 1.0])),
        ("stress_kPa\n100\n1000\n", ("stress", [0.1, 1.0])),
        ("stress_ratio\n1,5\n2\n", ("stress_ratio", [1.5, 2.0])),
        ("# made by hand\nstress ratio [-]\n1.5\n2\n", ("stress_ratio", [1.5, 2.0])),
    ):
        path.write_text(text)
        name, loads = read_loads(path, "MPa")
        assert name == found[0]
        assert loads == pytest.approx(found[1])
    for text, words in (
        ("stress,other\n1,2\n", "give one column, named stress or stress_ratio"),
        ("stress\nmany\n", "row 2, column stress: the value is 'many'; it must be a number"),
        ("stress\n", "has a header but no loads"),
        ("stress (tons)\n1\n", "stresses are in tons and the case's in MPa; give them in one unit"),
    ):
        path.write_text(text)
        with pytest.raises(cm.ParameterError) as refused:
            read_loads(path, "MPa")
        assert words in str(refused.value)


def test_titles_of_a_run_keep_apart_and_its_material_is_printed(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text((FOLDER / "k18-text-columns-run-together.toml").read_text())
    done = CliRunner().invoke(app, ["run", str(case)])
    assert done.exit_code == 0, done.output
    titles = "stress kPa  stress ratio  d10 microns  d50 microns  d60 microns"
    assert titles in done.output.splitlines()[0]
    assert "material: reference size 1.6e+04 microns, first crush stress 1000 kPa" in done.output

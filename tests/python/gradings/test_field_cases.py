"""Tables and cases as they came from laboratories: each read right, or refused for its own reason."""

import json
import math
from pathlib import Path

import pytest

import comminute as cm

FOLDER = Path(__file__).parents[2] / "data" / "field-cases"
CASES = [case for case in json.loads((FOLDER / "expected.json").read_text()) if case["command"] == "stats"]
REFUSED = {
    "k3-top-extended-ninefold.csv": "a factor of 8.9420",
    "k5-hint-hydrometer-step.csv": "13.1 % finer at 0.071 mm is more than 12 % at 0.075 mm; two methods that overlap",
    "k6-two-samples-in-long-table-merged.csv": "holds 2 samples in its rows, 'A', 'B'; name one, sample = 'A'",
    "k14-wide-samples-as-columns.csv": "holds 3 samples in its columns, 'S1', 'S2', 'S3'; name one, sample = 'S1'",
    "k14-raw-diameters.csv": "a list of grains is no table of sieves",
    "k15-no-header.csv": "row 1 holds numbers; a header is missing",
}


def read(name: str, options: list[str]) -> cm.Grading:
    top = "extend" if "--top" in options else "error"
    return cm.Grading.read(FOLDER / name, number="--number" in options, top=top)  # type: ignore[arg-type]


@pytest.mark.parametrize("case", CASES, ids=[case["file"] for case in CASES])
def test_field_case(case: dict[str, object]) -> None:
    name, options, expect = str(case["file"]), case["options"], case["expect"]
    assert isinstance(options, list)
    assert isinstance(expect, dict)
    if name.endswith(".xlsx"):
        pytest.importorskip("openpyxl")
    if name in REFUSED:
        with pytest.raises(cm.ParameterError) as refused:
            read(name, options)
        assert REFUSED[name] in str(refused.value)
        return
    grading = read(name, options)
    for percentile, size in expect.items():
        # the expected sizes are written with six decimals or six digits
        found = float(grading.percentile(float(percentile[1:])))
        assert math.isclose(found, size, rel_tol=1e-5, abs_tol=6e-7), percentile


def test_notes_and_choices_of_field_cases() -> None:
    long, wide = FOLDER / "k6-two-samples-in-long-table-merged.csv", FOLDER / "k14-wide-samples-as-columns.csv"
    assert cm.Grading.read(long, sample="A").percentile(50) == pytest.approx(1.542211, rel=1e-6)
    assert cm.Grading.read(long, sample="b").percentile(50) == pytest.approx(1.174, rel=1e-3)
    assert cm.Grading.read(wide, sample="S2").finer([2.0, 1.0, 0.5]).tolist() == pytest.approx([0.9, 0.5, 0.2])
    numbers = FOLDER / "k16-tyler-mesh-read-as-astm.csv"
    assert any("by ASTM E11" in note for note in cm.Grading.read(numbers).notes)
    assert cm.Grading.read(numbers).percentile(50) == pytest.approx(0.539, abs=1e-3)
    # Tyler's 20 and 35 mesh are 0.85 and 0.425 mm
    assert cm.Grading.read(numbers, mesh="tyler").percentile(50) == pytest.approx(0.425 * 2 ** (5 / 35))
    fractions = cm.Grading.read(FOLDER / "k3-fraction-1-minus-rounding.csv")
    assert any("fractions" in note for note in fractions.notes)


def test_sheets_of_a_workbook() -> None:
    pytest.importorskip("openpyxl")
    path = FOLDER / "k6-second-sheet-ignored.xlsx"
    assert any("sheet 'before'" in note and "'after' is not" in note for note in cm.Grading.read(path).notes)
    assert cm.Grading.read(path, sheet="after").finer(1.0) == 0.7
    assert cm.Grading.read(path, sheet=2) == cm.Grading.read(path, sheet="After")
    with pytest.raises(cm.ParameterError, match=r"sheet is 'x'; .* has 'before', 'after'"):
        cm.Grading.read(path, sheet="x")

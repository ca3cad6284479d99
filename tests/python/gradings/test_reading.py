"""Sieve tables in every form that a laboratory writes them, and what is said of those that cannot be read."""

import datetime
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import comminute as cm
from comminute.gradings.workbooks import workbook_sheets

SIZE = [2.0, 1.6, 1.0, 0.5, 0.16, 0.08]
FINER = [100, 93, 67, 33, 13, 1]
RETAINED = [0, 7, 26, 34, 20, 12]
EXPECTED = cm.Grading.from_sieves(SIZE, FINER)


def lines(header: str, *columns: Sequence[float], delimiter: str = ",", decimal: str = ".") -> str:
    rows = [
        delimiter.join(f"{value:.10g}".replace(".", decimal) for value in row) for row in zip(*columns, strict=True)
    ]
    return "\n".join([header, *rows]) + "\n"


def read(folder: Path, text: str | bytes, name: str = "sand.csv", **options: str | bool | None) -> cm.Grading:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return cm.Grading.read(path, **options)  # type: ignore[arg-type]


FORMS = {
    "percent finer": lines("size_mm,percent_finer", SIZE, FINER),
    "fine to coarse": lines("size_mm,percent_finer", SIZE[::-1], FINER[::-1]),
    "tabs": lines("size_mm\tpercent_finer", SIZE, FINER, delimiter="\t"),
    "decimal commas": lines("size_mm;percent_finer", SIZE, FINER, delimiter=";", decimal=","),
    "micrometres": lines("size_um,percent_finer", [1e3 * s for s in SIZE], FINER),
    "micro sign": lines("size (µm),percent finer", [1e3 * s for s in SIZE], FINER),
    "retained": lines("size_mm,percent_retained", SIZE, RETAINED) + "pan,1\n",
    "retained, no pan": lines("size_mm,percent_retained", SIZE, RETAINED),
    "cumulative": lines("percent_cumulative_retained,size_mm", [100 - f for f in FINER], SIZE) + "",
    "cumulative and pan": lines("size_mm,percent_cumulative_retained", SIZE, [100 - f for f in FINER]) + "Pan,100\n",
    "mass": lines("size_mm,mass_retained_g", SIZE, [13.5 * r for r in RETAINED]) + "pan,13.5\n",
    "comments": "# CEN\n\n" + lines("size_mm,percent_finer", SIZE, FINER).replace("93", "93 # two sieves agree"),
    "windows": lines("size_mm,percent_finer", SIZE, FINER).replace("\n", "\r\n"),
    "fractions": lines("size_mm,percent_finer", SIZE, [f / 100 for f in FINER]),
    "per cent signs": lines("size_mm,percent_finer", SIZE, FINER).replace("93", "93 %"),
    "quoted": '"size_mm","percent_finer"\n' + lines("", SIZE, FINER).lstrip(),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_curve(form: str, tmp_path: Path) -> None:
    grading = read(tmp_path, FORMS[form], unit="mm")
    sizes = np.geomspace(0.02, 2.0, 40)
    np.testing.assert_allclose(grading.finer(sizes), EXPECTED.finer(sizes), rtol=1e-12, atol=1e-13)
    assert grading.unit == "mm"


def test_encodings(tmp_path: Path) -> None:
    text = FORMS["percent finer"]
    for encoding in ("utf-8-sig", "utf-16"):
        assert read(tmp_path, text.encode(encoding)) == EXPECTED
    assert read(tmp_path, ("# körnung\n" + text).encode("latin-1")) == EXPECTED


def test_the_unit_of_the_file_is_carried(tmp_path: Path) -> None:
    grading = read(tmp_path, FORMS["micrometres"])
    assert (grading.unit, grading.largest) == ("um", 2000.0)
    assert read(tmp_path, FORMS["micrometres"], unit="mm").largest == 2.0


def test_phi_and_sieve_designations(tmp_path: Path) -> None:
    by_phi = read(tmp_path, "phi,percent_finer\n-1,100\n0,60\n2,0\n")
    np.testing.assert_array_equal(by_phi.finer([2.0, 1.0, 0.25]), [1.0, 0.6, 0.0])
    assert by_phi.notes == ("phi of sand.csv read as openings in mm",)
    by_name = read(tmp_path, 'sieve;percent_finer\n3/8 in;100\nNo. 16;98\n30;70\n"ASTM No. 200";2\n63 µm;0\n')
    np.testing.assert_allclose(by_name.finer([9.5, 1.18, 0.6, 0.075, 0.063]), [1.0, 0.98, 0.7, 0.02, 0.0])


@pytest.mark.parametrize(
    "header",
    [
        "Size (mm),Passing (%)",
        "sieve opening [mm],% finer",
        "Sieve size mm,percent passing (%)",
        "grain size (mm),% passing",
        "diameter_mm,percent_finer",
    ],
)
def test_headers_as_laboratories_write_them(header: str, tmp_path: Path) -> None:
    assert read(tmp_path, lines(header, SIZE, FINER)) == EXPECTED


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("size_mm,percent_fnier", "did you mean percent_finer by 'percent_fnier'?"),
        ("sze_mm,percent_finer", "did you mean size_mm by 'sze_mm'?"),
        ("size_furlong,percent_finer", "the header names no size column; it must name one of size_mm"),
    ],
)
def test_a_header_that_is_none_is_answered_with_the_nearest(header: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(cm.ParameterError) as refused:
        read(tmp_path, lines(header, SIZE, FINER))
    assert words in str(refused.value)


def test_what_is_assumed_is_said(tmp_path: Path) -> None:
    assert (
        "column 'remarks' of sand.csv is not used"
        in read(tmp_path, "size_mm,percent_finer,remarks\n2,100,dry\n1,0,\n").notes
    )
    assert read(tmp_path, "size_mm,mass_retained_g\n2,0\n1,50\n").notes == (
        "sand.csv has no pan row: nothing taken as finer than the finest sieve",
    )
    retained = read(tmp_path, "size_mm,percent_retained\n2,0\n1,50\n0.5,46\n")
    assert "sand.csv has no pan row: the missing 4 % taken as finer than the finest sieve" in retained.notes
    rounded = read(tmp_path, "size_mm,percent_retained\n2,0\n1,50\n0.5,46.2\npan,4\n")
    assert "percent_retained of sand.csv adds up to 100.2 %: scaled to 100 %" in rounded.notes
    assert rounded.finer(0.5) == pytest.approx(4 / 100.2)
    fractions = read(tmp_path, "size_mm,percent_retained\n2,0\n1,0.5\n0.5,0.46\npan,0.04\n")
    assert "the values add up to 1: read as fractions, not per cent" in fractions.notes
    extended = read(tmp_path, "size_mm,percent_finer\n1,90\n0.5,40\n0.25,0\n", top="extend")
    assert "carried on at its last slope" in extended.notes[0]


def test_numbers_of_grains_become_mass_and_back(tmp_path: Path) -> None:
    text = "size_mm,percent_finer\n2,100\n1,95\n0.5,60\n0.25,0\n"
    by_mass = read(tmp_path, text, number=True)
    assert "the shares count grains: converted to mass with weights of size cubed" in by_mass.notes
    back = cm.SizeCurve.of(by_mass).number_finer()
    np.testing.assert_allclose(back.finer, [0.0, 0.6, 0.95, 1.0], rtol=1e-13)
    # by hand: one grain in eight of the larger size carries as much mass as the seven of half the size... and 1/8 more
    pair = cm.Grading.from_sieves([2.0, 1.999999, 1.0, 0.999999], [100, 50, 50, 0], number=True)
    assert pair.finer(1.5) == pytest.approx(1 / 9, rel=1e-5)


def workbook(path: Path, rows: Sequence[Sequence[object]], *others: Sequence[Sequence[object]]) -> Path:
    """Write a workbook of one sheet for each table."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for table in (rows, *others):
        sheet = book.create_sheet()
        for row in table:
            sheet.append(row)
    book.save(path)
    return path


def test_a_spreadsheet(tmp_path: Path) -> None:
    path = tmp_path / "sand.xlsx"
    table: list[list[object]] = [["size_mm", "percent_retained", "remarks"]]
    table += [list(row) for row in zip([*SIZE, "pan"], [*RETAINED, 1], ["dry", *6 * [None]], strict=True)]
    workbook(path, table)
    np.testing.assert_allclose(cm.Grading.read(path).finer(SIZE), np.divide(FINER, 100), rtol=1e-13)
    table[3][1] = "many"
    workbook(path, table)
    with pytest.raises(cm.ParameterError, match=r"sand.xlsx row 4, column percent_retained: the value is 'many'"):
        cm.Grading.read(path)
    path.write_bytes(b"PK not a workbook")
    with pytest.raises(cm.ParameterError, match=r"sand\.xlsx is no readable spreadsheet"):
        cm.Grading.read(path)


def test_cells_of_every_kind_are_text_with_their_rows(tmp_path: Path) -> None:
    date = datetime.datetime(2024, 5, 17)
    rows: list[list[object]] = [
        ["# a comment", 1.0],
        [],
        [" size_mm ", "percent_finer", "remarks", None, ""],
        [2.0, 100, date, None],
        [None, None],
        [0.1, 1e-7, True, None, "  "],
        [1e20, 12.5, "=1+1"],
        ["2.0", "#N/A", "nan", "", "#"],
        [None, 0.0],
        [],
    ]
    path = workbook(tmp_path / "sand.xlsx", rows, [["size_mm", "percent_finer"], [1, 100]])
    first = workbook_sheets(path)[0]
    assert [(line.place, [cell.text for cell in line.cells]) for line in first.lines] == [
        ("sand.xlsx row 1", ["# a comment", "1", "", "", ""]),
        ("sand.xlsx row 3", ["size_mm", "percent_finer", "remarks", "", ""]),
        ("sand.xlsx row 4", ["2", "100", "17 May 2024 (a date)", "", ""]),
        ("sand.xlsx row 6", ["0.1", "1e-07", "True", "", ""]),
        ("sand.xlsx row 7", ["100000000000000000000", "12.5", "=1+1", "", ""]),  # which no program has computed yet
        ("sand.xlsx row 8", ["2.0", "#N/A", "nan", "", "#"]),
        ("sand.xlsx row 9", ["", "0", "", "", ""]),
    ]
    assert [line.comment for line in first.lines] == [True, False, False, False, False, False, False]
    assert workbook_sheets(workbook(path, [[], [None]])) == []


def test_spreadsheets_that_are_none(tmp_path: Path) -> None:
    path = workbook(tmp_path / "sand.xlsx", [["size_mm", "percent_finer"], [1, 100]])
    for name in ("sand.xls", "sand.ods"):
        path.rename(tmp_path / name)
        path = tmp_path / name
        with pytest.raises(
            cm.ParameterError, match=rf"{name} is .*, for which there is no reader here; save it as \.xlsx"
        ):
            cm.Grading.read(path)


MESSAGES = {
    "size_mm,percent_finer\n1.2,100\n# a comment\n0.3,50\n0.6,40\n": "sand.csv row 5: 40 % finer at 0.6 mm is "
    "less than 50 % at 0.3 mm; cumulative per cent finer cannot fall with size. Retained percentages? name the column "
    "percent_retained.",
    "size_mm,percent_finer\n2,100\n0,0\n": "sand.csv row 3, column size_mm: the value is 0; a size must be greater",
    "size_mm,percent_finer\n2,100\n-1,0\n": "sand.csv row 3, column size_mm: the value is -1; a size must be greater",
    "size_mm,percent_finer\n2,100\nnan,0\n": "sand.csv row 3, column size_mm: the value is 'nan'; it must be a number",
    "size_mm,percent_finer\n2,100\n1,some\n": "sand.csv row 3, column percent_finer: the value is 'some'; it must be",
    "size_mm,percent_finer\n2,100\n1,\n": "sand.csv row 3, column percent_finer: the value is empty; it must be",
    "size_mm,percent_finer\n2,100\n1,120\n": "column percent_finer: the value is 120; it must be between 0 and 100",
    "size_mm,percent_finer\n2,100\n1,50\n1.0,40\n": "sand.csv row 4: size 1 mm stands already in sand.csv row 3",
    "": "sand.csv is empty; it needs a header line and at least two sieves",
    "# nothing\n": "sand.csv is empty; it needs a header line and at least two sieves",
    "size_mm,percent_finer\n": "sand.csv has a header but no sieves; it needs at least two",
    "size_mm,percent_finer\n2,100\n": "sand.csv: the sieve curve has 1 points; it must have at least 2",
    "size_mm,percent_finer\n1,90\n0.5,0\n": "sand.csv: the coarsest sieve, 1 mm, has 90 % finer, not 100 %; add the "
    'size that all grains pass, or pass top="extend" to carry the last slope on to 100 %',
    "size,percent_finer\n1,100\n": "sand.csv row 1: the size column has no unit; name it size_mm or size_um",
    "size_mm,percent_fine\n1,100\n": "the header names no value column; it must name one of percent_finer, "
    "percent_retained, percent_cumulative_retained, mass_retained_g; did you mean percent_finer by 'percent_fine'?",
    "size_mm,percent_finer,percent_retained\n2,100,0\n1,50,20\n0.5,0,80\n": "sand.csv row 3: by column 'percent_finer' "
    "50 % are finer, by 'percent_retained' 80 %; correct the table, or leave one of the columns",
    "size_mm,percent_finer\n1,100\n0.5,20,30\n": "sand.csv row 3: 3 columns, but the header names 2",
    "size_mm;percent_finer\n1,2;100\n0,5;0;\n": "",
    "size_mm;percent_finer\n1,2;100\n0.5;0;\n": "sand.csv row 2: '1,2' is 1.2 with a decimal comma, but sand.csv row 3 "
    "has '0.5', 0.5 with a decimal point; write one decimal mark throughout",
    "size_mm,percent_finer\n1,100\n0.5\n": "sand.csv row 3: 1 columns, but the header names 2",
    'size_mm,percent_finer\n"1,100\n': "sand.csv row 2: unexpected end of data; close every quotation mark",
    "size_mm,percent_retained\n2,0\n1,80\n0.5,80\n": "sand.csv: column percent_retained adds up to 160 "
    "%; it must be 100 %. Cumulative values? name the column percent_cumulative_retained.",
    "size_mm,percent_retained\n2,0\n1,40\npan,40\n": "sand.csv: column percent_retained adds up to 80 "
    "%; it must be 100 %",
    "size_mm,mass_retained_g\n2,0\n1,0\n": "sand.csv: column mass_retained_g adds up to 0",
    "size_mm,percent_finer\n2,100\n1,50\npan,3\n": "sand.csv row 4: 3 % is finer than the pan; the pan "
    "holds all. Leave it out",
    "size_mm,percent_cumulative_retained\n2,0\n1,50\npan,90\n": "sand.csv: 90 % is retained down to the "
    "pan; it must hold all: 100 %",
    "size_mm,percent_retained\n2,0\npan,50\npan,50\n": "sand.csv row 4: a second pan; a table has one",
    "sieve,percent_finer\nNo. 41,100\n50,0\n": "sand.csv row 2, column sieve: sieve is 'No. 41'; ASTM E11 has no such "
    "sieve. Did you mean No. 40?",
    "size_mm,percent_finer\n8,100\n#4,60\n1,0": "row 3, column size_mm: '#4' may be a sieve number or a comment",
    "phi,percent_finer\n-9999,100\n2,0\n": "column phi: the value is -9999; phi must be between -1000 and 1000",
}


@pytest.mark.parametrize(("text", "words"), MESSAGES.items(), ids=range(len(MESSAGES)))
def test_message(text: str, words: str, tmp_path: Path) -> None:
    if not words:
        assert read(tmp_path, text).finer(1.2) == 1.0
        return
    with pytest.raises(cm.ParameterError) as raised:
        read(tmp_path, text)
    assert words in str(raised.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(cm.ParameterError, match=r"none.csv is no file; give a sieve table"):
        cm.Grading.read(tmp_path / "none.csv")
    with pytest.raises(cm.ParameterError, match="is no file"):
        cm.Grading.read(tmp_path)
    with pytest.raises(cm.ParameterError, match="is no text file"):
        read(tmp_path, b"size_mm\x00\x00")
    with pytest.raises(cm.ParameterError, match=r"unit is 'furlong'; it must be one of"):
        read(tmp_path, FORMS["tabs"], unit="furlong")


def test_a_total_in_the_column_of_samples_names_none(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("sample,size mm,percent passing\ntotal,2,100\ntotal,1,60\ntotal,0.5,20\n")
    assert cm.Grading.read(table).finer([2.0, 1.0, 0.5]).tolist() == pytest.approx([1.0, 0.6, 0.2])
    with pytest.raises(cm.ParameterError, match="one sample without a name"):
        cm.Grading.read(table, sample="A")

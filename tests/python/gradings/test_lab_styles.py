# ruff: noqa: E501  (tables, one a line)
"""Tables in the styles of laboratories: rows given are rows read, or the table is refused; never a wrong number."""

import random
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lab_tables import LabTable, table

import comminute as cm
from comminute.gradings.options import Reading
from comminute.gradings.reading import SieveData, read_sieves
from comminute.gradings.sieves import convert
from comminute.gradings.values import as_per_cent


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("tables")


def rows_of(data: SieveData) -> list[tuple[float, float]]:
    sizes = [convert(size, data.unit, "mm") for size in data.size]
    return sorted(zip(sizes, as_per_cent(list(data.percent_finer)), strict=True))


@given(seed=st.integers(0, 2**32))
def test_rows_given_are_rows_read(seed: int, folder: Path) -> None:
    made: LabTable = table(random.Random(seed))
    path = folder / "lab.csv"
    path.write_text(made.text, encoding="utf-8")
    found = rows_of(read_sieves(path))
    for (size, finer), (size_there, finer_there) in zip(
        found, sorted(zip(made.size, made.finer, strict=True)), strict=True
    ):
        assert size == pytest.approx(size_there, rel=1e-9)
        assert finer == pytest.approx(finer_there, abs=1e-6)


Options = dict[str, object]
ROWS = [4.0, 2.0, 1.0]
READ: dict[str, tuple[str, Options, list[float], list[float]]] = {
    "title above samples": (
        "Percent passing\nsize_mm,A,B\n4,100,100\n2,80,70\n1,50,40\n", {"sample": "b"}, ROWS, [100, 70, 40]
    ),
    "samples in rows": (
        "Sample,4 mm,2 mm,1 mm,Pan\nS1,0,20,50,30\nS2,0,10,50,40\n", {"sample": "S2"}, ROWS, [100, 90, 40]
    ),
    "sizes in a row": ("Size (mm),4,2,1\n% passing,100,80,50\n", {}, ROWS, [100, 80, 50]),
    "samples below sizes": ("Sieve (mm),4,2,1\nS1,100,80,50\nS2,100,90,60\n", {"sample": "S1"}, ROWS, [100, 80, 50]),
    "sample named once": (
        "sample,size_mm,mass_retained_g\nA,4,0\n,2,5\n,pan,5\nB,4,0\n,2,60\n,1,20\n,pan,20\n", {"sample": "B"}, ROWS,
        [100, 40, 20],
    ),
    "dry mass": ("size_mm,mass_retained_g\n4,0\n2,50\n1,30\npan,2\n", {"total_mass_g": 100.0}, ROWS, [100, 50, 20]),
    "upper edges": ("size_mm,mass\n4,10\n2,50\n1,40\n", {"edges": "upper"}, ROWS, [100, 90, 40]),
    "two edges": ("from (mm),to (mm),mass (g)\n4,2,20\n2,1,50\n1,0,30\n", {}, ROWS, [100, 80, 30]),
    "passing and retained sieves": ("Passing (mm),Retained (mm),Weight (g)\n4,2,20\n2,1,50\n1,-,30\n", {}, ROWS, [100, 80, 30]),
    "European classes": ("Kornklasse (mm);Masse (g)\n2/4;20\n1/2;50\n0/1;30\n", {}, ROWS, [100, 80, 30]),
    "thousands points": ("Siebweite (mm);Rückstand (g)\n4,0;0\n2,0;1.250,5\n1,0;2.310\nSchale;940,2\n", {}, ROWS,
        [100, 100 - 125050 / 4500.7, 94020 / 4500.7]),
    "loss": ("size_mm,mass_retained_g\n4,0\n2,20\n1,50\npan,30\nLoss,1\nTotal,101\n", {}, ROWS, [100, 80, 30]),
    "units below": ("Sieve,Mass,Retained,Passing\nmm,g,%,%\n4,0,0,100\n2,20,20,80\n1,50,50,30\nPan,30,30,0\n", {}, ROWS,
        [100, 80, 30]),
    "two lines of header": (
        "Sieve size,Weight,Percent\n(mm),retained (g),passing\n4,0,100\n2,20,80\n1,50,30\nPan,30,0\n", {}, ROWS, [100, 80, 30]
    ),
    "limits beside": ("Sieve (mm),% passing,Spec min,Spec max\n4,100,100,100\n2,80,70,90\n1,50,40,60\n", {}, ROWS, [100, 80, 50]),
    "header in a comment": ("# size_mm percent_finer\n4.0 100.0\n2.0 80.0\n1.0 50.0\n", {}, ROWS, [100, 80, 50]),
    "markdown": ("| size_mm | percent_finer |\n|---|---|\n| 4 | 100 |\n| 2 | 80 |\n| 1 | 50 |\n", {}, ROWS, [100, 80, 50]),
    "old openings beside numbers": (
        "sieve,size_mm,percent_finer\nNo. 4,4.76,100\nNo. 10,2,50\nNo. 40,0.42,10\n", {}, [4.76, 2, 0.42], [100, 50, 10]
    ),
    "Tyler's numbers beside openings": ("sieve,size_mm,percent_finer\n10 mesh,1.7,100\n35 mesh,0.425,50\n", {}, [1.7, 0.425],
        [100, 50]),
    "kilograms": ("size_mm,mass retained (kg)\n4,0\n2,0.2\n1,0.5\npan,0.3\n", {}, ROWS, [100, 80, 30]),
    "grams in cells": ("size_mm,mass retained\n4,0 g\n2,200 g\n1,0.5 kg\npan,300 g\n", {}, ROWS, [100, 80, 30]),
    "washed": ("size_mm,mass_retained_g\n4,0\n2,20\n1,50\nwashed through 1,25\npan,5\n", {}, ROWS, [100, 80, 30]),
    "sums without direction": ("size_mm,Cumulative (%)\n4,0\n2,20\n1,50\npan,100\n", {}, ROWS, [100, 80, 50]),
    "sums of mass": ("size_mm,Cumulative mass retained (g)\n4,0\n2,20\n1,50\npan,80\n", {}, ROWS, [100, 75, 37.5]),
    "micrometres in cells": ("Sieve size,% passing\n4.75 mm,100\n600 µm,50\n75 µm,5\n", {}, [4.75, 0.6, 0.075], [100, 50, 5]),
    "Tyler": ("sieve,percent_finer\n10 mesh,100\n35 mesh,45\n", {"mesh": "tyler"}, [1.7, 0.425], [100, 45]),
    "residue": ("size_mm,percent_finer\n4,100.00000000000001\n2,50\n1,-5e-15\n", {}, ROWS, [100, 50, 0]),
}  # fmt: skip


@pytest.mark.parametrize("style", READ)
def test_style(style: str, tmp_path: Path) -> None:
    text, options, size, finer = READ[style]
    path = tmp_path / "sand.csv"
    path.write_text(text, encoding="utf-8")
    found = rows_of(read_sieves(path, how=Reading(**options)))  # type: ignore[arg-type]
    assert [row[0] for row in found] == pytest.approx(size[::-1], rel=1e-12)
    assert [row[1] for row in found] == pytest.approx(finer[::-1], abs=1e-9)


def test_encodings(tmp_path: Path) -> None:
    path = tmp_path / "sand.csv"
    for text, encoding in (
        ("Siebweite (mm);Rückstand (g)\n4,0;0\n2,0;20,5\nSchale;9,5\n", "cp1252"),
        ("ふるい目の開き (mm),通過質量百分率 (%)\n4,100\n2,80\n", "cp932"),
        ("筛孔尺寸(mm),通过百分率(%)\n4,100\n2,80\n", "gb18030"),
        ("Korngröße in mm\tDurchgang\n4\t100\n2\t80\n", "utf-16"),
    ):
        path.write_bytes(text.encode(encoding))
        assert len(read_sieves(path).size) == 2


HEAD = "size_mm,mass_retained_g\n4,0\n2,50\n1,30\n"
REFUSED: dict[str, tuple[str, Options, str]] = {
    "samples in columns": ("Sieve (mm),A passing (%),B passing (%)\n4,100,100\n2,80,70\n", {}, "holds 2 samples in its columns, 'A'"),
    "samples by place": ("Site,size_mm,mass_retained_g\nA,4,0\nA,2,1\nA,1,2\nB,3,0\nB,1.7,4\n", {}, "2 samples in its rows, 'A', 'B'"),
    "no such sample": ("size_mm,A,B\n4,100,100\n2,80,70\n", {"sample": "C"}, "sample is 'C'; sand.csv has 'A', 'B'"),
    "sample of one": (HEAD, {"sample": "C"}, "sample is 'C', but sand.csv has one sample without a name"),
    "sheet of text": (HEAD, {"sheet": "C"}, "sheet is 'C', but sand.csv is a text file"),
    "mesh of openings": (HEAD, {"mesh": "tyler"}, "mesh is 'tyler', but sand.csv names no sieve by a number"),
    "mesh unknown": (HEAD, {"mesh": "din"}, "mesh is 'din'; it must be one of 'astm', 'tyler'"),
    "mass of shares": ("size_mm,percent_finer\n4,100\n2,0\n", {"total_mass_g": 9.0}, "holds no masses; leave it out"),
    "edges of sieves": ("size_mm,percent_finer\n4,100\n2,0\n", {"edges": "upper"}, "belong to sieves, not to classes; leave it"),
    "mass too small": (HEAD + "pan,2\n", {"total_mass_g": 80.0}, "total_mass_g is 80, less than the 82 g on the sieves"),
    "either mark": ("size_mm;mass_retained_g\n16;0\n8;1,250\n4;2,310\n", {}, "row 3: '1,250' may be 1250 or 1.25"),
    "both marks": ("size_mm;percent_finer\n4;100\n2;80,5\n1;50.5\n", {}, "'80,5' is 80.5 with a decimal comma, but sand.csv row 4"),
    "wrong total": (HEAD + "pan,29\nTotal,120\n", {}, "row 6: the total says 120, but the rows above add up to 109"),
    "mass before": ("Dry mass (g),500\n\n" + HEAD + "pan,29\n", {}, "500 g before sieving, but the rows add up to 109 g"),
    "second table": ("size_mm,percent_finer\n4,100\n2,80\nsize_mm,percent_finer\n4,100\n2,90\n", {}, "row 4 is a second header"),
    "bare numbers": ("Sieve,mass_retained_g\n16,0\n8,80\n4,55\npan,30\n", {}, "16, 8 may be openings or numbers of sieves"),
    "two sizes": ("sieve,size_mm,percent_finer\nNo. 4,4.75,100\nNo. 10,2.36,50\n", {}, "row 3: column sieve has 'No. 10', 2 mm"),
    "two curves": ("size_mm,% retained,% passing\n4,0,100\n2,50,50\n1,30,30\npan,20,\n", {}, "row 4: by column '% passing' 30 %"),
    "sum or mass": ("size_mm,Retained\n4,0\n2,20\n1,50\n0.5,100\n", {}, "may be percent_cumulative_retained or mass_retained_g"),
    "whole unknown": ("size_mm,Cumulative mass retained (g)\n4,0\n2,20\n", {}, "add a pan row, or give total_mass_g"),
    "middles": ("Mean size (mm),mass (g)\n4,10\n2,50\n", {}, "middles of classes; give the sieves between them"),
    "gap between classes": ("size_mm,mass\n4-2,10\n1-0.5,50\n", {}, "row 3: the class begins at 1 mm, and the next coarser one ends"),
    "finer than another sieve": (HEAD + "<0.5,5\n", {}, "row 5: finer than 0.5 mm, but the finest sieve is 1"),
    "a date": ('sieve,percent_finer\n"03 Apr 2023 (a date)",100\nNo. 4,5\n', {}, "has made a date of a fraction"),
    "a commented row": ("size_mm,percent_finer\n8,100\n#4,50\n2,1\n", {}, "'#4' may be a sieve number or a comment"),
    "an empty value": ("size_mm,mass_retained_g\n4,0\n2,\n1,5\n", {}, "row 3, column mass_retained_g: the value is empty"),
    "below a limit": ("size_mm,percent_finer\n4,100\n2,<5\n1,0\n", {}, "row 3, column percent_finer: the value is '<5'"),
    "no hint to the opposite": ("size_mm,passing retained (%)\n4,100\n2,0\n", {}, "its values may be percent_finer or percent_retained; name it"),
    "a half": ("size_mm,percent_finer\n1/2,100\n1/4,50\n", {}, "row 2, column size_mm: the value is '1/2'; it must be a number"),
}  # fmt: skip


@pytest.mark.parametrize("style", REFUSED)
def test_refusal(style: str, tmp_path: Path) -> None:
    text, options, words = REFUSED[style]
    path = tmp_path / "sand.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(cm.ParameterError) as refused:
        read_sieves(path, how=Reading(**options))  # type: ignore[arg-type]
    assert words in str(refused.value)


def test_masses_count_no_grains(tmp_path: Path) -> None:
    path = tmp_path / "sand.csv"
    path.write_text(HEAD)
    with pytest.raises(cm.ParameterError, match="holds masses, which count no grains"):
        cm.Grading.read(path, number=True)
    path.write_text("size_mm,count\n4,0\n2,50\n1,300\n")
    assert cm.Grading.read(path) == cm.Grading.read(path, number=True)


@pytest.mark.parametrize("ending", ["ods", "xls"])
def test_spreadsheets_without_a_reader(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"sand.{ending}"
    path.write_bytes(b"PK")
    with pytest.raises(cm.ParameterError, match=r"for which there is no reader here; save it as \.xlsx or \.csv"):
        cm.Grading.read(path)

"""Tables of results for spreadsheets and pandas."""

import csv
from pathlib import Path

import numpy as np
import openpyxl
import pytest

import comminute as cm

SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 60, 0], unit="mm")
MATERIAL = cm.Material(reference_size=2.0, fabric_width=0.3, first_crush_stress=1.0)
RUN = cm.Simulation(MATERIAL, SAND).run(stress=[5.0, 50.0])


def test_gradings_on_sieves_are_the_curves_there() -> None:
    table = RUN.grading_table([0.25, 2.0, 1.0])
    assert table.columns == ("size (mm)", "start", "stress 5", "stress 50")
    sizes, *columns = np.array(table.rows, dtype=float).T
    np.testing.assert_array_equal(sizes, [2.0, 1.0, 0.25])
    np.testing.assert_allclose(columns[0], 100.0 * np.asarray(SAND.finer([2.0, 1.0, 0.25])))
    for k in range(2):
        np.testing.assert_allclose(columns[k + 1], 100.0 * RUN.curve(k).finer_than([2.0, 1.0, 0.25]))


def test_sieves_left_out_are_those_of_the_start() -> None:
    assert [row[0] for row in RUN.grading_table().rows] == [2.0, 1.0, 0.5]
    ideal = cm.Simulation(MATERIAL, cm.power_law(2.5, 0.01, 2.0)).run(stress=5.0)
    assert len(ideal.grading_table().rows) == ideal.grid.bins


def test_a_series_is_cut_to_where_something_lies() -> None:
    table = RUN.grading_table("ISO R20/3")
    finest = [row[-1] for row in table.rows]
    assert table.rows[0][0] == 2.0
    assert finest == sorted(finest, reverse=True)  # type: ignore[type-var]
    assert all(share >= 0.05 for share in finest[:-1])  # type: ignore[operator]


def test_indices_by_load() -> None:
    table = RUN.load_table(["D90", "Cu", "B", "Br", "fines", "crushes", "mass_error"])
    assert table.columns[:3] == ("stress", "stress ratio", "D90 (mm)")
    stress, ratio, d90, cu, b, br, fines, crushes, error = np.array(table.rows, dtype=float).T
    np.testing.assert_array_equal(stress, [5.0, 50.0])
    np.testing.assert_array_equal(ratio, RUN.stress_ratio)
    np.testing.assert_allclose(d90, RUN.percentile(90))
    np.testing.assert_allclose(cu, [cm.uniformity(RUN.curve(k)) for k in range(2)])
    np.testing.assert_allclose(b, [cm.breakage_index(SAND, RUN.curve(k)).index for k in range(2)])
    np.testing.assert_allclose(br, [cm.relative_breakage(SAND, RUN.curve(k)) for k in range(2)])
    np.testing.assert_array_equal([fines, crushes, error], [RUN.fines, RUN.crushes, RUN.mass_error])


def test_an_index_without_a_value_is_an_empty_cell(tmp_path: Path) -> None:
    relative = cm.Simulation(MATERIAL, cm.fuller(2.0)).run(stress=5.0)  # no unit, which Hardin's index needs
    table = relative.load_table(["D50", "Br"])
    assert table.rows[0][-1] is None
    assert table.to_csv(tmp_path / "table.csv").read_text().splitlines()[1].endswith(",")
    assert str(table).splitlines()[1].endswith("-")


def test_files_hold_the_numbers(tmp_path: Path) -> None:
    with RUN.to_csv(tmp_path / "run.csv").open(newline="") as file:
        head, *rows = list(csv.reader(file))
    assert tuple(head) == RUN.grading_table().columns
    assert [[float(cell) for cell in row] for row in rows] == [list(row) for row in RUN.grading_table().rows]
    book = openpyxl.load_workbook(RUN.to_excel(tmp_path / "run.xlsx", sieves=[2.0, 0.1], indices=["D90", "Br"]))
    assert book.sheetnames == ["gradings", "loads"]
    loads = [tuple(cell.value for cell in row) for row in book["loads"].iter_rows()]
    table = RUN.load_table(["D90", "Br"])
    assert loads[0] == table.columns
    np.testing.assert_allclose(np.array(loads[1:], dtype=float), np.array(table.rows, dtype=float), rtol=1e-14)
    one = openpyxl.load_workbook(RUN.grading_table([1.0]).to_excel(tmp_path / "one.xlsx"))
    assert one.sheetnames == ["table"]


def test_pandas_gets_the_same() -> None:
    frame = RUN.to_pandas(["D50", "crushes"])
    assert list(frame.columns) == ["stress ratio", "D50 (mm)", "crushes"]
    assert list(frame.index) == [5.0, 50.0]
    np.testing.assert_array_equal(frame["crushes"], RUN.crushes)


def test_names_and_sieves_that_are_none_are_refused() -> None:
    with pytest.raises(cm.ParameterError, match="index is 'strength'"):
        RUN.load_table(["strength"])
    with pytest.raises(cm.ParameterError, match="sieves is none"):
        RUN.grading_table([])
    with pytest.raises(cm.ParameterError, match="sieves is none"):
        RUN.grading_table([1.0, -1.0])

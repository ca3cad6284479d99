"""Sheets of a spreadsheet file, through openpyxl where it is installed."""

from __future__ import annotations

import datetime
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from comminute.gradings.faults import fault
from comminute.gradings.sheets import Cell, Line, Sheet, is_comment
from comminute.util.names import shorten

if TYPE_CHECKING:
    from pathlib import Path

UNREADABLE = {
    ".ods": "an OpenDocument spreadsheet",
    ".xls": "a spreadsheet of Excel before 2007",
    ".xlsb": "a binary workbook",
    ".numbers": "a spreadsheet of Numbers",
}


def workbook_sheets(path: Path) -> list[Sheet]:
    """Sheets of a workbook that hold anything, in its order.

    Raises
    ------
    ImportError
        Naming the extra to install.
    ParameterError
        For a kind of spreadsheet without a reader here, or a file that is none.
    """
    if path.suffix.lower() in UNREADABLE:
        kind = UNREADABLE[path.suffix.lower()]
        raise fault("", f"{path.name} is {kind}, for which there is no reader here", "save it as .xlsx or .csv")
    try:
        import openpyxl  # noqa: PLC0415  (optional)
    except ImportError as error:
        message = f"reading {path.name} needs openpyxl; install it with: pip install 'comminute[xlsx]'"
        raise ImportError(message) from error
    try:
        with path.open("rb") as file:
            values = openpyxl.load_workbook(file, read_only=True, data_only=True, keep_links=False)
            formulas = openpyxl.load_workbook(file, read_only=True, keep_links=False)
            try:
                sheets = [_sheet(path.name, sheet, formulas[sheet.title]) for sheet in values.worksheets]
            finally:
                values.close()
                formulas.close()
    except Exception as error:  # openpyxl's own errors are of many classes, and none is documented
        raise fault("", f"{path.name} is no readable spreadsheet: {shorten(str(error), 120)}") from error
    return [sheet for sheet in sheets if sheet.lines]


def _sheet(name: str, values: Any, formulas: Any) -> Sheet:
    """Lines of a sheet that are not empty; columns to the right in which nothing stands are left out."""
    for sheet in (values, formulas):
        sheet.reset_dimensions()  # some programs write a range that does not hold all cells
    lines = []
    for number, row in enumerate(zip(values.iter_rows(), formulas.iter_rows(), strict=True), 1):
        cells = tuple(_cell(value, formula) for value, formula in zip(*row, strict=True))
        line = Line(f"{name} row {number}", cells, is_comment(cells), number, name)
        if line.filled:
            lines.append(line)
    width = max((1 + max(k for k, cell in enumerate(line.cells) if cell.text) for line in lines), default=0)
    padded = (replace(line, cells=(line.cells + width * (Cell(""),))[:width]) for line in lines)
    return Sheet(name, tuple(padded), values.title)


def _cell(cell: Any, formula: Any) -> Cell:
    """Text and number of a cell; a share that is shown as per cent is per cent.

    A formula counts by the value that a spreadsheet program last computed for it, and is text where none did.
    """
    value = cell.value
    if value is None:
        return Cell("" if formula.value is None else str(formula.value))
    if isinstance(value, datetime.date):
        return Cell(f"{value:%d %b %Y} (a date)")
    if isinstance(value, bool) or not isinstance(value, int | float):
        return Cell(str(value).strip())
    if "%" in (cell.number_format or ""):
        number = float(f"{100.0 * value:.15g}")
        return Cell(f"{number:.15g}%", number)
    whole = isinstance(value, float) and value.is_integer()
    return Cell(str(int(value)) if whole else repr(value), float(value))

"""Sheets of a spreadsheet file, through openpyxl where it is installed."""

from __future__ import annotations

import datetime
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from comminute._core import ParameterError
from comminute.gradings.sheets import Cell, Line, Sheet, is_comment

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
        For a kind of spreadsheet without a reader here, a file that is none, or a formula without a stored value.
    """
    if path.suffix.lower() in UNREADABLE:
        kind = UNREADABLE[path.suffix.lower()]
        raise ParameterError(f"{path.name} is {kind}, for which there is no reader here; save it as .xlsx or .csv")
    try:
        import openpyxl  # noqa: PLC0415  (optional)
    except ImportError as error:
        message = f"reading {path.name} needs openpyxl; install it with: pip install 'comminute[xlsx]'"
        raise ImportError(message) from error
    try:
        values = openpyxl.load_workbook(path, data_only=True)
        formulas = openpyxl.load_workbook(path)
    except Exception as error:  # openpyxl's own errors are of many classes, and none is documented
        reason = "".join(c if c.isprintable() else "?" for c in str(error))[:120]
        raise ParameterError(f"{path.name} is no readable spreadsheet: {reason}") from error
    sheets = []
    for sheet in values.worksheets:
        lines = []
        for number, row in enumerate(sheet.iter_rows(), 1):
            cells = tuple(_cell(cell, formulas[sheet.title], path.name) for cell in row)
            line = Line(f"{path.name} row {number}", cells)
            if line.filled:
                lines.append(replace(line, comment=is_comment(cells)))
        if lines:
            width = max(1 + max(k for k, cell in enumerate(line.cells) if cell.text) for line in lines)
            lines = [replace(line, cells=line.cells[:width]) for line in lines]
            sheets.append(Sheet(path.name, tuple(lines), sheet.title))
    return sheets


def _cell(cell: Any, formulas: Any, name: str) -> Cell:
    """Text and number of a cell; a share that is shown as per cent is per cent."""
    value = cell.value
    if value is None:
        formula = formulas.cell(cell.row, cell.column).value
        if isinstance(formula, str) and formula.startswith("="):
            raise ParameterError(
                f"{name} cell {cell.coordinate} holds a formula without its value; open the file in a spreadsheet "
                "program and save it, or save it as CSV"
            )
        return Cell("")
    if isinstance(value, bool) or not isinstance(value, int | float):
        if isinstance(value, datetime.datetime | datetime.date):
            return Cell(f"{value:%d %b %Y} (a date)")
        return Cell(str(value).strip())
    if "%" in (cell.number_format or ""):
        number = float(f"{100.0 * value:.15g}")
        return Cell(f"{number:.15g}%", number)
    return Cell(repr(value), float(value))

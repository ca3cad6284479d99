"""Rows of a spreadsheet's first sheet, read by openpyxl where it is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from comminute._core import ParameterError
from comminute.gradings.rows import Row
from comminute.util.names import shorten

OTHER_KINDS = (".xls", ".ods")


def spreadsheet_rows(path: Path) -> list[Row]:
    """Rows of the first sheet that are not empty, with their numbers in the sheet.

    A row that begins with # is a comment. A formula counts by the value that a spreadsheet program last computed
    for it.

    Parameters
    ----------
    path : Path
        An .xlsx file.

    Returns
    -------
    list of Row
        All of one width; columns to the right in which no row has text are left out.

    Raises
    ------
    ImportError
        If openpyxl is missing; the message names the extra to install.
    ParameterError
        For a file that is no .xlsx spreadsheet.
    """
    if path.suffix.lower() in OTHER_KINDS:
        raise ParameterError(f"{path.name} is no .xlsx spreadsheet; save the table as .xlsx or .csv")
    try:
        import openpyxl  # noqa: PLC0415  (an optional dependency)
    except ImportError as error:
        message = f"reading {path.name} needs openpyxl; install it with: pip install 'comminute[xlsx]'"
        raise ImportError(message) from error
    try:
        with path.open("rb") as file:
            book = openpyxl.load_workbook(file, read_only=True, data_only=True, keep_links=False)
            try:
                rows = _rows(book.worksheets[0])
            finally:
                book.close()
    except Exception as error:  # openpyxl's own errors are of many classes, and none is documented
        raise ParameterError(f"{path.name} is no readable spreadsheet: {shorten(str(error), 120)}") from error
    width = max((1 + max(i for i, cell in enumerate(row.cells) if cell) for row in rows), default=0)
    return [Row(row.number, (row.cells + width * ("",))[:width]) for row in rows]


def _rows(sheet: Any) -> list[Row]:
    sheet.reset_dimensions()  # some programs write a range that does not hold all cells
    rows = []
    for number, cells in enumerate(sheet.iter_rows(), 1):
        texts = tuple(_text(cell) for cell in cells)
        if any(texts) and not texts[0].startswith("#"):
            rows.append(Row(number, texts))
    return rows


def _text(cell: Any) -> str:
    """Text of a cell: a whole number without decimal point, nothing for an empty cell or one that shows an error."""
    value = cell.value
    if value is None or cell.data_type == "e":
        return ""
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() else repr(value)
    return str(value).strip()

"""Rows of a spreadsheet's first sheet, through pandas where it is installed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from comminute.gradings.tables import Row, shorten, wrong_file

if TYPE_CHECKING:
    from pathlib import Path


def spreadsheet_rows(path: Path) -> list[Row]:
    """Rows that are not empty, with their numbers in the sheet; lines that begin with # are comments.

    Raises
    ------
    ImportError
        Where pandas or openpyxl is missing; it names the extra to install.
    ParameterError
        For a file that is no spreadsheet.
    """
    try:
        import openpyxl  # noqa: F401, PLC0415
        import pandas as pd  # noqa: PLC0415
    except ImportError as error:
        message = f"reading {path.name} needs pandas and openpyxl; install them with: pip install 'comminute[xlsx]'"
        raise ImportError(message) from error
    try:
        sheet = pd.read_excel(path, sheet_name=0, header=None, dtype=object, keep_default_na=False)
    except Exception as error:  # the reader's own errors are of many classes, and none is documented
        raise wrong_file(path.name, "is no readable spreadsheet", shorten(str(error), 120)) from error
    rows = []
    for number, values in enumerate(sheet.itertuples(index=False, name=None), 1):
        cells = tuple(_text(value) for value in values)
        if any(cells) and not cells[0].startswith("#"):
            rows.append(Row(number, cells))
    return _trimmed(rows)


def _text(value: object) -> str:
    if isinstance(value, float) and math.isnan(value):
        return ""
    return repr(value) if isinstance(value, float) else str(value).strip()


def _trimmed(rows: list[Row]) -> list[Row]:
    """Rows without the empty columns to their right."""
    width = max((1 + max(i for i, cell in enumerate(row.cells) if cell) for row in rows), default=0)
    return [Row(row.number, row.cells[:width]) for row in rows]

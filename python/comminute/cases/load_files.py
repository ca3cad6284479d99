"""Load paths from files: one column of stresses or stress ratios."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.numerals import Numeral, decimal_mark, digits_of
from comminute.gradings.sheets import Sheet, require_size, text_sheets
from comminute.gradings.words import plain
from comminute.util.names import is_file, shorten

if TYPE_CHECKING:
    from pathlib import Path

PASCALS = {
    "pa": 1.0,
    "kpa": 1e3,
    "mpa": 1e6,
    "gpa": 1e9,
    "bar": 1e5,
    "psi": 6894.757293168361,
    "n/mm2": 1e6,
    "kn/m2": 1e3,
}
NAMES = {"stress": "stress", "stress_ratio": "stress_ratio", "pressure": "stress", "load": "stress"}


def read_loads(path: Path, unit: str) -> tuple[str, list[float]]:
    """Read the loads of a file, and say whether they are "stress" or "stress_ratio".

    Parameters
    ----------
    path : Path
        A text file or a workbook with one column, whose header may carry the unit: stress (MPa).
    unit : str
        Unit of the case's stresses; a stress in another known unit is converted.

    Returns
    -------
    str
    list of float

    Raises
    ------
    ParameterError
        Naming file, row and value.
    """
    if not is_file(path):
        raise ParameterError(f"{shorten(str(path), 200)} is no file; give a table of loads (.csv or .xlsx)")
    require_size(path)
    sheet = _sheet(path)
    lines = [line for line in sheet.lines if not line.comment]
    if not lines:
        raise ParameterError(f"{path.name} is empty; it needs a header, stress or stress_ratio, and loads")
    header, *rows = lines
    texts = [cell.text for cell in header.filled]
    name, factor = _meaning(" ".join(texts), unit, path.name) if texts else ("", 1.0)
    if not name or len(texts) > 1:
        raise ParameterError(f"{header.place}: give one column, named stress or stress_ratio")
    if not rows:
        raise ParameterError(f"{path.name} has a header but no loads")
    texts_of_loads = [(line, plain(line.filled[0].text.strip('"'))) for line in rows]
    numerals = [
        Numeral(text, line.place, float("inf")) for line, text in texts_of_loads if line.filled[0].number is None
    ]
    mark = decimal_mark(path.name, numerals, comma_separated=False)
    loads = []
    for line, text in texts_of_loads:
        number = line.filled[0].number
        value = number if number is not None else digits_of(text, mark)
        if value is None or len(line.filled) > 1:
            shown = shorten(" ".join(one.text for one in line.filled))
            raise ParameterError(f"{line.place}, column {texts[0]}: the value is '{shown}'; it must be a number")
        loads.append(value * factor)
    return name, loads


def _sheet(path: Path) -> Sheet:
    if path.suffix.lower() in (".xlsx", ".xls", ".ods"):
        from comminute.gradings.workbooks import workbook_sheets  # noqa: PLC0415  (openpyxl is optional)

        sheets = workbook_sheets(path)
        return sheets[0] if sheets else Sheet(path.name, ())
    return text_sheets(path, one_column=True)[0]


def _meaning(header: str, unit: str, name: str) -> tuple[str, float]:
    """Quantity that a header names, and the factor to the unit of the case."""
    text = plain(header).lower()
    bracket = re.search(r"[\[(]\s*([^\])]*?)\s*[\])]", text)
    given = bracket[1] if bracket else ""
    words = re.sub(r"[\[(].*", "", text).strip()
    for known in PASCALS:
        if not given and re.fullmatch(rf".*[\s_,/]{re.escape(known)}", words):
            given, words = known, words[: -len(known)].rstrip(" _,/")
    quantity = NAMES.get(re.sub(r"[\s_-]+", "_", words), "")
    if quantity == "stress_ratio":
        return (quantity, 1.0) if given in ("", "-", "1") else ("", 1.0)
    if quantity and given and given != unit.lower():
        if given not in PASCALS or unit.lower() not in PASCALS:
            raise ParameterError(f"{name}: stresses are in {given} and the case's in {unit}; give them in one unit")
        return quantity, PASCALS[given] / PASCALS[unit.lower()]
    return quantity, 1.0

"""Numbers in the value columns of a table, in grams or per cent."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from comminute.gradings.faults import fault
from comminute.gradings.headers import unit_in
from comminute.gradings.numerals import digits_of
from comminute.gradings.words import GRAMS, plain
from comminute.util.names import shorten

if TYPE_CHECKING:
    from comminute.gradings.layout import Column
    from comminute.gradings.sheets import Cell, Line

UNIT = re.compile(r"(.*[0-9.,])\s*(%|[a-z%]+\.?)")


def numeral_in(cell: Cell) -> str:
    """Cut the unit off a number; empty where the file stores a number itself, whose marks are no question."""
    if cell.number is not None:
        return ""
    text = plain(cell.text)
    with_unit = UNIT.fullmatch(text)
    return with_unit[1].strip() if with_unit else text


def value_of(column: Column, line: Line, mark: str) -> float:
    """Value of a cell: grams, per cent, a share or a count.

    Raises
    ------
    ParameterError
        For a cell that is empty or no number, or whose unit is not that of its column.
    """
    cell, meaning = column.cell(line), column.meaning
    where = line.at(column.header)
    mass = meaning.name.startswith("mass")
    value, unit = cell.number, ""
    if value is None:
        text = plain(cell.text)
        with_unit = UNIT.fullmatch(text)
        if with_unit and unit_in(with_unit[2].rstrip(".")):
            text, unit = with_unit[1].strip(), unit_in(with_unit[2].rstrip("."))
        value = digits_of(text, mark)
    if value is None:
        what = "is empty" if not cell.text else f"is '{shorten(cell.text)}'"
        more = " (a decimal comma needs semicolons or tabs between columns)" if "," in cell.text and mark == "." else ""
        if cell.text.startswith("="):
            more = "; it is a formula without its value: save the file in a spreadsheet program"
        raise fault(where, f"the value {what}", f"it must be a number{more}")
    if unit and (unit in GRAMS) != mass and not (unit == "%" and not mass):
        raise fault(where, f"the value is '{shorten(cell.text)}'", "its unit is not that of the column")
    if mass:
        value *= GRAMS[unit or meaning.unit or "g"]
    most = 100.0 * (1.0 + 1e-9) if meaning.name.startswith("percent") else float("inf")
    if value < -1e-9 or value > most:
        rule = "between 0 and 100" if meaning.name.startswith("percent") else "at least 0"
        raise fault(where, f"the value is {value:.4g}", f"it must be {rule}")
    return 0.0 if value < 0.0 else value

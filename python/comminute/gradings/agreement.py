"""Columns of one table that say the same in several ways: masses, shares, and what they add up to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.faults import fault
from comminute.gradings.numbers import numeral_in
from comminute.gradings.numerals import digits_of
from comminute.gradings.openings import AGREE, Size, Style, read_size
from comminute.gradings.sieves import convert
from comminute.gradings.values import RETAINED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from comminute.gradings.layout import Column
    from comminute.gradings.sheets import Line

MOST = 1.0  # per cent finer by which rounded columns may differ


def rounding(column: Column, lines: Sequence[Line | None], mark: str) -> float:
    """Find the unit of the last digit to which a column is written."""
    finest = 1.0
    for line in lines:
        if line is None:
            continue
        cell = column.cell(line)
        text = numeral_in(cell) or cell.text.rstrip("%")
        mark_here = mark if numeral_in(cell) else "."
        if digits_of(text, mark_here) is not None and "e" not in text.lower():
            digits = len(text.partition(mark_here)[2].strip())
            finest = min(finest, 10.0**-digits)
    return finest


def require_agreement(
    read: Column, other: Column, curves: tuple[list[float], list[float]], lines: Sequence[Line | None], mark: str
) -> None:
    """Refuse two columns that say different curves, naming the first row where they do.

    Parameters
    ----------
    read, other : Column
        The column that is read, and one beside it.
    curves : tuple of two lists of float
        Per cent finer by each, on the same sieves.
    lines : sequence of Line
        Rows of the sieves.
    mark : str
        Decimal mark of the file.
    """
    steps = len(lines) if other.meaning.name in RETAINED else 2
    allowed = min(0.5 * rounding(other, lines, mark) * max(steps, 2), MOST) + 0.05
    for line, one, two in zip(lines, *curves, strict=True):
        if line is not None and abs(one - two) > allowed:
            raise fault(
                line.place,
                f"by column '{read.header}' {one:.4g} % are finer, by '{other.header}' {two:.4g} %",
                "correct the table, or leave one of the columns (mass washed out? give total_mass_g)",
            )


def is_numbered(column: Column, line: Line, styles: dict[int, Style]) -> bool:
    """Tell whether a cell names its sieve by a number of a series."""
    try:
        return read_size(column.cell(line).text, styles[column.index]).named == "mesh"
    except ParameterError:
        return False


def require_same_sieves(
    rows: list[tuple[Line, Size]], others: list[Column], styles: dict[int, Style], mesh: str | None
) -> None:
    """Refuse rows in which two columns name two sieves; numbers of Tyler's series are told by the openings."""
    for column in others:
        wrong: list[ParameterError] = []
        tyler = mesh is None
        for line, size in rows:
            style = styles[column.index]
            here = _in_mm(column, line, style)
            if here is None or size.kind == "class":
                continue
            there = convert(size.opening, size.unit, "mm")
            if not same_opening(here, there):
                said = (
                    f"column {column.header} has '{column.cell(line).text}', {here:.4g} mm, and the size beside it is "
                )
                wrong.append(fault(line.place, f"{said}{there:.4g} mm", "correct one of them"))
            other = _in_mm(column, line, Style(style.unit, style.mark, "tyler"))
            tyler = tyler and other is not None and same_opening(other, there)
        if wrong and not tyler:
            raise wrong[0]


def same_opening(here: float, there: float) -> bool:
    """Tell whether two openings are those of one sieve, as exact or as old standards have it."""
    return here > 0.0 and there > 0.0 and abs(math.log(here / there)) <= AGREE


def _in_mm(column: Column, line: Line, style: Style) -> float | None:
    try:
        size = read_size(column.cell(line).text, style)
    except ParameterError:
        return None
    return convert(size.opening, size.unit, "mm") if size.kind == "sieve" else None

"""Columns of one table that say the same in several ways: masses, shares, and what they add up to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.numerals import digits_of
from comminute.gradings.numbers import numeral_in
from comminute.gradings.values import RETAINED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from comminute.gradings.layout import Column
    from comminute.gradings.sheets import Line

MOST = 1.0  # per cent finer by which rounded columns may differ


def rounding(column: Column, lines: Sequence[Line | None], mark: str) -> float:
    """Unit of the last digit to which a column is written."""
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
            raise ParameterError(
                f"{line.place}: by column '{read.header}' {one:.4g} % are finer, by '{other.header}' {two:.4g} %; correct "
                "the table, or leave one of the columns (mass washed out? give total_mass_g)"
            )

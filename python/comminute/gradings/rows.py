"""Row of a table, as text and spreadsheet files both give it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of a table: its number in the file, counted from 1, and its cells as text."""

    number: int
    cells: tuple[str, ...]

"""Columns of a table that are read: those of sizes, and those of values."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from comminute.gradings.faults import fault
from comminute.gradings.headers import Meaning, meaning_of, near_word

if TYPE_CHECKING:
    from comminute.gradings.layout import Column, Layout

PRIORITY: tuple[str, ...] = ("mass_retained_g", "count", "mass_cumulative_retained", "mass_finer", "percent_finer")
PRIORITY += ("percent_cumulative_retained", "percent_retained", "retained", "cumulative", "mass_cumulative", "share")
NO_VALUES = "it must name one of percent_finer, percent_retained, percent_cumulative_retained, mass_retained_g"


def columns_of(layout: Layout) -> tuple[list[Column], list[Column]]:
    """Size columns, and value columns with that to read first."""
    sizes, values = layout.of_kind("size"), layout.of_kind("value")
    for column in (*values, *layout.of_kind("unknown")):
        near = near_word(column.header) if column.meaning.name in ("", "share") and column.header else ""
        if near and ((column.meaning.rest and column.meaning.name == "share") or not values):
            raise fault(
                layout.header.place,
                "the header names no value column",
                f"{NO_VALUES}; did you mean {near} by '{column.header}'?",
            )
    bare = [column for column in sizes if column.meaning.name == "opening" and not column.meaning.unit]
    for column in bare:
        numbers = [column.cell(line).text for line in layout.body if column.cell(line).numeric]
        if len(sizes) == 1 and numbers and all(map(_is_bare, numbers)):
            raise fault(layout.header.place, "the size column has no unit", "name it size_mm or size_um")
    if not values:
        values = [
            replace(c, meaning=_open_meaning(layout, c)) for c in layout.of_kind("unknown") if _has_numbers(layout, c)
        ]
        values = values[:1]
    if not values:
        raise fault(
            layout.header.place,
            "the header names no value column",
            NO_VALUES,
        )
    return sizes, sorted(values, key=lambda column: PRIORITY.index(column.meaning.name))


def _is_bare(text: str) -> bool:
    """Tell whether a cell holds a number and no unit."""
    return all(c in "0123456789.,' " for c in text.strip())


def _has_numbers(layout: Layout, column: Column) -> bool:
    return bool(column.header) and any(column.cell(line).numeric for line in layout.body)


def _open_meaning(layout: Layout, column: Column) -> Meaning:
    """Quantity of a column whose header names a sample: that of the title above the table, or left to its numbers."""
    found = {}
    for line in layout.above:
        for cell in line.filled:
            meaning = meaning_of(cell.text)
            if meaning.kind == "value" and meaning.name != "share":
                found[meaning.name] = meaning
    if len(found) == 1:
        return replace(next(iter(found.values())), rest=column.header)
    return Meaning("value", "share", rest=column.header)

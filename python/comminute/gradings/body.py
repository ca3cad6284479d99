"""Rows of a table by what they are: sieves, the pan, totals, losses, and lines that are signed or say something."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from comminute.gradings.faults import fault
from comminute.gradings.headers import meaning_of
from comminute.gradings.layout import is_blank
from comminute.gradings.numerals import digits_of
from comminute.gradings.openings import row_meaning
from comminute.gradings.words import plain
from comminute.util.names import shorten

if TYPE_CHECKING:
    from comminute.gradings.layout import Column, Layout
    from comminute.gradings.sheets import Line

SAMPLES_SHOWN = 8


@dataclass
class Body:
    """Lines of a table by kind."""

    sieves: list[Line] = field(default_factory=list)
    pan: list[Line] = field(default_factory=list)
    washed: list[Line] = field(default_factory=list)
    total: list[Line] = field(default_factory=list)
    initial: list[Line] = field(default_factory=list)
    loss: list[Line] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def sorted_body(layout: Layout, sizes: list[Column], values: list[Column], *, finer: bool) -> Body:
    """Lines of a table by what they are; a line that is nothing known is an error, and none vanishes.

    Parameters
    ----------
    layout : Layout
    sizes, values : list of Column
        Columns of sizes, and those of values.
    finer : bool
        Whether the values are what is finer than each size; else a size of 0, or a dash for one, is the pan.

    Raises
    ------
    ParameterError
        For a line with numbers that is neither a sieve nor a row known by its name, and for a second header.
    """
    body = Body()
    skipped, told = [], []
    texts = [column for column in layout.columns if column not in values]
    for line in layout.body:
        _refuse_second_header(layout, line)
        label = _label(line, sizes, texts)
        if not label and not finer and all(_is_nought(column, line) for column in sizes):
            label = "pan"
        has_numbers = any(column.cell(line).numeric for column in values)
        if label == "summary":
            told.append(line)
        elif label:
            getattr(body, label).append(line)
        elif not has_numbers and not any(column.cell(line).numeric for column in sizes) and _is_words(line):
            skipped.append(line)
        else:
            _require_width(layout, line, [*sizes, *values])
            body.sieves.append(line)
    for line in (*told, *skipped):
        body.notes.append(f"{line.place}, '{shorten(line.filled[0].text)}', is no sieve and is not used")
    if body.pan and all(is_blank(column.cell(body.pan[0])) for column in sizes):
        _require_at_end(body.pan[0], body.sieves)
    if len(body.pan) > 1:
        raise fault(body.pan[1].place, "a second pan", "a table has one")
    return body


def _require_at_end(pan: Line, sieves: list[Line]) -> None:
    """Refuse a pan that is told by its dash alone and stands between sieves."""
    numbers = [line.number for line in sieves]
    if numbers and min(numbers) < pan.number < max(numbers):
        raise fault(pan.place, "the row has no size and stands between sieves", "name its size, or name it pan")


def _label(line: Line, sizes: list[Column], texts: list[Column]) -> str:
    """Meaning of a line by its name, which stands for a size or, where that is left blank, in another column."""
    for column in sizes:
        meaning = row_meaning(column.cell(line).text)
        if meaning:
            return meaning
    if all(is_blank(column.cell(line)) for column in sizes):
        for column in texts:
            meaning = row_meaning(column.cell(line).text)
            if meaning:
                return meaning
    return ""


def _is_nought(column: Column, line: Line) -> bool:
    """Tell whether a size cell holds 0, or a dash in its place."""
    cell = column.cell(line)
    zero = column.meaning.name != "phi" and re.fullmatch(r"0*[.,]?0+", plain(cell.text)) is not None
    return bool(cell.text) and (is_blank(cell) or zero)


def _is_words(line: Line) -> bool:
    """Tell whether a line says something rather than naming a sieve: a signature, a date, a remark."""
    first = line.filled[0].text
    return not any(c.isdigit() for c in first) or (len(line.filled) == 1 and len(plain(first).split()) > 2)


def _refuse_second_header(layout: Layout, line: Line) -> None:
    if any(cell.numeric for cell in line.filled) or len(line.filled) < 2:
        return
    kinds = [meaning_of(cell.text).kind for cell in line.filled]
    if "size" in kinds and "value" in kinds:
        raise fault(
            "",
            f"{line.place} is a second header: {layout.name} holds two tables",
            "give each a file or a sheet of its own",
        )


def _require_width(layout: Layout, line: Line, needed_columns: list[Column]) -> None:
    """Refuse a line with cells beyond those that the header names, or too few of them."""
    width = layout.width
    extra = [cell for cell in line.cells[width:] if cell.text]
    needed = max((column.index + 1 for column in needed_columns), default=0)
    if extra or len(line.cells) < needed:
        commas = " (decimal commas need semicolons or tabs between columns)" if extra and layout.comma_separated else ""
        raise fault(
            line.place,
            f"{len(line.cells)} columns, but the header names {width}",
            f"give every row one value for each column{commas}",
        )


def chosen_sample(layout: Layout, sample: str | int | None) -> Layout:
    """Table of one sample: its rows of a long table, or its columns of a wide one.

    Raises
    ------
    ParameterError
        For several samples of which none is asked for, one that is not there, or a sample asked of a table of one.
    """
    long = _sample_names(layout)
    if any(name and not row_meaning(name) for name in long):  # a total or a pan names no sample
        return _rows_of(layout, long, sample)
    wide = _sample_columns(layout, named=sample is not None)
    if wide:
        label = _asked(layout, list(wide), sample, "columns")
        kept = wide[label]
        columns = tuple(column for column in layout.columns if column in kept or not _in_any(column, wide))
        note = f"sample '{label}' of {layout.name} is read, {_listed([n for n in wide if n != label])} not"
        notes = (*layout.notes, note) if len(wide) > 1 else layout.notes
        return replace(layout, columns=columns, notes=notes)
    if sample is not None:
        raise fault(
            "",
            f"sample is '{sample}', but {layout.name} has one sample without a name",
            "leave it out",
            parameter="sample",
        )
    return layout


def _in_any(column: Column, wide: dict[str, list[Column]]) -> bool:
    return any(column in columns for columns in wide.values())


def _listed(names: list[str]) -> str:
    shown = ", ".join(repr(shorten(name, 24)) for name in names[:SAMPLES_SHOWN])
    return (
        shown
        + (f" and {len(names) - SAMPLES_SHOWN} more" if len(names) > SAMPLES_SHOWN else "")
        + (" is" if len(names) == 1 else " are")
    )


def _asked(layout: Layout, names: list[str], sample: str | int | None, where: str) -> str:
    """Name among those of the samples that is asked for."""
    listed = ", ".join(repr(shorten(name, 24)) for name in names[:SAMPLES_SHOWN])
    listed += f" and {len(names) - SAMPLES_SHOWN} more" if len(names) > SAMPLES_SHOWN else ""
    if sample is None:
        if len(names) == 1:
            return names[0]
        raise fault(
            "",
            f"{layout.name} holds {len(names)} samples in its {where}, {listed}",
            f"name one, sample = '{shorten(names[0], 24)}'",
        )
    found = [name for name in names if name.casefold() == str(sample).strip().casefold()]
    if not found:
        raise fault("", f"sample is '{shorten(str(sample))}'", f"{layout.name} has {listed}", parameter="sample")
    return found[0]


def _filled_down(layout: Layout, column: Column) -> list[str]:
    """Text of a column in each line of the body; a blank goes on with the text above it."""
    texts, last = [], ""
    for line in layout.body:
        last = column.cell(line).text or last
        texts.append(last)
    return texts


def _sample_names(layout: Layout) -> list[str]:
    """Name of the sample of each row of a long table, from all columns that say it; empty where none does."""
    said = [_filled_down(layout, column) for column in layout.of_kind("sample")]
    said = [names for names in said if any(names) and (len(set(names)) < len(names) or len(names) == 1)]
    varied = [names for names in said if len(set(filter(None, names))) > 1]
    if said:
        return [" ".join(filter(None, parts)) for parts in zip(*(varied or said[:1]), strict=True)]
    column = _column_of_blocks(layout)
    return [] if column is None else _filled_down(layout, column)


def _column_of_blocks(layout: Layout) -> Column | None:
    """Column without a known word that divides a table, whose sizes fall and rise again, into samples."""
    sizes = layout.of_kind("size")
    values = [_rough(sizes[0].cell(line).text) for line in layout.body] if sizes else []
    known = [value for value in values if value is not None]
    steps = [b - a for a, b in pairwise(known)]
    if not any(step > 0 for step in steps) or not any(step < 0 for step in steps):
        return None
    for column in layout.of_kind("unknown"):
        names = _filled_down(layout, column)
        counts = Counter(names).values()
        if (
            len(counts) > 1
            and min(counts) > 1
            and all(column.cell(line).text or k for k, line in enumerate(layout.body))
        ):
            return column
    return None


def _rough(text: str) -> float | None:
    return digits_of(plain(text), "," if "," in text else ".")


def _rows_of(layout: Layout, names: list[str], sample: str | int | None) -> Layout:
    """Rows of one sample of a long table, whose rows belong to the samples of these names."""
    known = list(dict.fromkeys(name for name in names if name and not row_meaning(name)))
    if len(known) == 1 and sample is None:
        return layout
    label = _asked(layout, known, sample, "rows")
    kept, last = [], ""
    for name, line in zip(names, layout.body, strict=True):
        last = name if not row_meaning(name) else last
        if last == label:
            kept.append(line)
    notes = layout.notes
    if len(known) > 1:
        notes = (*notes, f"sample '{label}' of {layout.name} is read, {_listed([n for n in known if n != label])} not")
    return replace(layout, body=tuple(kept), notes=notes)


def _sample_columns(layout: Layout, *, named: bool) -> dict[str, list[Column]]:
    """Columns of each sample of a wide table by the sample's name; empty for a table of one sample."""
    values = layout.of_kind("value")
    names = [column.meaning.name for column in values]
    found: dict[str, list[Column]] = {}
    if values:
        if len(set(names)) < len(names) or (named and any(column.meaning.rest for column in values)):
            for column in values:
                found.setdefault(_name_of(column), []).append(column)
            if len(found) == 1 and not named:
                two = next(column for column in values if names.count(column.meaning.name) > 1)
                raise fault(
                    layout.header.place,
                    f"{names.count(two.meaning.name)} columns are named '{two.header}'",
                    "name the sample of each, or leave one",
                )
        return found
    for column in layout.of_kind("unknown"):
        cells = [column.cell(line) for line in layout.body]
        numbers = [cell for cell in cells if cell.numeric]
        if column.header and numbers and 2 * len(numbers) >= len([cell for cell in cells if cell.text]):
            found.setdefault(column.header, []).append(column)
    return found


def _name_of(column: Column) -> str:
    """Name of the sample in a header such as "S1 passing (%)"."""
    return column.meaning.rest.upper() if column.meaning.rest else column.header

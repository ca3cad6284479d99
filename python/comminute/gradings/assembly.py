"""From the columns of a table to one curve: marks of numbers, totals, and columns that say the same."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from comminute._core import ParameterError
from comminute.gradings import values as quantities
from comminute.gradings.agreement import require_agreement
from comminute.gradings.faults import fault
from comminute.gradings.layout import Column
from comminute.gradings.numbers import numeral_in, value_of
from comminute.gradings.numerals import Numeral, decimal_mark
from comminute.gradings.openings import numerals_in, row_meaning

if TYPE_CHECKING:
    from comminute.gradings.body import Body
    from comminute.gradings.layout import Layout
    from comminute.gradings.options import Reading
    from comminute.gradings.sizing import Sized

PER_MM = {"um": 1e3, "nm": 1e6, "m": 1e-3, "cm": 0.1, "in": 1.0 / 25.4}
LARGEST_MM = 1000.0  # an opening beyond this is a thousands mark read as a decimal mark
ROUNDED_TOTAL = 0.005  # share by which a total may miss the sum of its rows
LOST = 0.02  # share by which the mass before sieving may exceed what is found after


class Curve(NamedTuple):
    """Per cent finer than each sieve, notes of what was assumed, and whether the shares count grains."""

    percent_finer: tuple[float, ...]
    notes: tuple[str, ...]
    number: bool


def mark_of(layout: Layout, body: Body, sizes: list[Column], values: list[Column]) -> str:
    """Decimal mark of the file, from the numbers of all its size and value columns."""
    numerals = []
    for line in body.sieves:
        for column in sizes:
            cell = column.cell(line)
            if cell.number is None:
                per_mm = PER_MM.get(column.meaning.unit, 1.0)
                numerals += [Numeral(text, line.place, LARGEST_MM * per_mm) for text in numerals_in(cell.text)]
    for line in (*body.sieves, *body.pan, *body.total, *body.initial, *body.loss, *body.washed):
        for column in layout.of_kind("value") or values:
            text = numeral_in(column.cell(line))
            most = 100.5 if column.meaning.name.startswith(("percent", "share", "cumulative")) else float("inf")
            if text:
                numerals.append(Numeral(text, line.place, most))
    return decimal_mark(layout.name, numerals, comma_separated=layout.comma_separated)


def curve_of(
    layout: Layout, body: Body, rows: Sized, values: list[Column], mark: str, *, number: bool, how: Reading
) -> Curve:
    """Per cent finer of a table, by the first of its value columns that is whole; the others must agree."""
    made: list[tuple[Column, quantities.Column, list[float], list[str]]] = []
    for column in values:
        notes: list[str] = []
        try:
            numbers = quantities.resolved(_numbers(layout, body, rows, column, mark, how), notes)
            made.append((column, numbers, quantities.per_cent_finer(numbers, notes), notes))
        except ParameterError as error:
            if len(values) == 1:
                raise
            failed = error
            whole = all(column.cell(line).text for line in body.sieves)
            if whole:
                raise
            layout = replace(layout, notes=(*layout.notes, f"column '{column.header}' of {layout.name} is not used"))
    if not made:
        raise failed
    made.sort(key=lambda one: one[1].name in quantities.RETAINED and one[1].pan is None and one[1].whole is None)
    read, numbers, finer, notes = made[0]
    for column, others, curve, _ in made[1:]:
        beside = curve
        if others.name in ("mass_retained_g", "count") and others.pan is None and others.whole is None:
            share = quantities.as_per_cent(finer)[-1] / 100.0
            rest = share / (1.0 - share) * sum(others.value) if share < 1.0 else 0.0
            beside = quantities.per_cent_finer(replace(others, pan=rest), [])
        curves = (quantities.as_per_cent(finer), quantities.as_per_cent(beside))
        require_agreement(read, column, curves, rows.line, mark)
        notes.append(f"column '{column.header}' of {layout.name} agrees with '{read.header}', which is read")
    if number and numbers.name.startswith("mass"):
        raise fault(
            layout.name,
            f"column '{read.header}' holds masses, which count no grains",
            "leave number out, or name the column count",
        )
    _require_applied(layout, numbers, rows, how)
    _require_rising(layout, numbers, rows, finer)
    unused = [column for column in layout.of_kind("unknown") if column.header and column.header != read.header]
    unused += layout.of_kind("unused")
    said = [f"column '{column.header}' of {layout.name} is not used" for column in unused if column not in values]
    all_notes = (*layout.notes, *said, *rows.notes, *notes, *body.notes)
    by_number = read.meaning.number or numbers.name == "count"
    return Curve(tuple(finer), all_notes, by_number)


def _numbers(layout: Layout, body: Body, rows: Sized, column: Column, mark: str, how: Reading) -> quantities.Column:
    """Numbers of one column on the sieves, with what its pan, its total and its losses say."""
    name = column.meaning.name
    if name == "share" and rows.classes:
        name = "percent_retained"
    adds_up = name in quantities.RETAINED or name in ("share",)
    value = tuple(0.0 if line is None else value_of(column, line, mark) for line in rows.line)
    if name in ("percent_finer", "cumulative", "share") and rows.line.count(None):
        raise fault(
            layout.name,
            f"column '{column.header}' gives one value for each class between two sieves",
            "name the sieve that it is finer than",
        )
    pan_lines = [*body.pan, *([rows.pan] if rows.pan else [])]
    if len(pan_lines) > 1:
        raise fault(pan_lines[1].place, "a second pan", "a table has one")
    pan = next(
        (
            value_of(column, line, mark)
            for line in pan_lines
            if column.cell(line).text or len(layout.of_kind("value")) < 2
        ),
        None,
    )
    washed = [value_of(column, line, mark) for line in body.washed if column.cell(line).text]
    if washed and adds_up:
        pan = (pan or 0.0) + sum(washed)
    upper = (how.edges or rows.edge) == "upper" and name in quantities.RETAINED and not rows.classes
    if upper and pan:
        raise fault(pan_lines[0].place, "a pan stands below the finest class, whose size is its upper edge")
    loss = sum(value_of(column, line, mark) for line in body.loss if column.cell(line).numeric)
    whole = how.total_mass_g if name in quantities.WEIGHED else None
    made = quantities.Column(
        layout.name,
        column.header,
        name,
        tuple(rows.size),
        value,
        pan,
        whole,
        loss,
        upper,
        pan_lines[0].place if pan_lines else "",
    )
    _require_total(layout, body, column, made, mark)
    if whole is None and name in ("mass_finer", "mass_cumulative_retained", "mass_cumulative"):
        wholes = [value_of(column, line, mark) for line in (*body.total, *body.initial) if column.cell(line).numeric]
        made = replace(made, whole=wholes[0] if wholes else None)
    return made


def _require_total(layout: Layout, body: Body, column: Column, made: quantities.Column, mark: str) -> None:
    """Refuse a table whose rows do not add up to what its row of totals says: a row may be missing."""
    if made.name not in quantities.RETAINED:
        return
    total = sum(made.value) + (made.pan or 0.0)
    for line in body.total:
        if not column.cell(line).numeric:
            continue
        said = value_of(
            replace(column, meaning=replace(column.meaning, name="mass_retained_g", unit=column.meaning.unit)),
            line,
            mark,
        )
        near = ROUNDED_TOTAL * max(said, total) + 1e-9
        if min(abs(said - total), abs(said - total - made.loss)) > near:
            raise fault(
                line.place,
                f"the total says {said:.4g}, but the rows above add up to {total:.4g}",
                "is a row missing, or was some washed out (total_mass_g)?",
            )
    for line in (*body.initial, *(one for one in layout.above if row_meaning(one.cells[0].text) == "initial")):
        cells = [cell for cell in line.filled[1:] if cell.numeric]
        if not cells or not made.name.startswith("mass") or made.whole is not None:
            continue
        said = value_of(Column(line.cells.index(cells[0]), column.header, column.meaning), line, mark)
        if abs(said - total - made.loss) > LOST * max(said, total):
            raise fault(
                line.place,
                f"{said:.4g} g before sieving, but the rows add up to {total:.4g} g",
                "was some washed out? give total_mass_g",
            )


def _require_applied(layout: Layout, read: quantities.Column, rows: Sized, how: Reading) -> None:
    """Refuse an option that this table has no use for, rather than ignore it."""
    if how.total_mass_g is not None and read.name not in quantities.WEIGHED:
        raise fault(
            "",
            f"total_mass_g is {how.total_mass_g:.4g}, but column '{read.header}' of {layout.name} holds no masses",
            "leave it out",
            parameter="total_mass_g",
        )
    if how.edges is not None:
        if rows.edge and rows.edge != how.edges:
            raise fault(
                "",
                f"edges is '{how.edges}', but the header of {layout.name} names {rows.edge} edges",
                parameter="edges",
            )
        if rows.classes or read.name not in quantities.RETAINED:
            raise fault(
                "",
                f"edges is '{how.edges}', but the values of {layout.name} belong to "
                f"{'classes with both their edges' if rows.classes else 'sieves, not to classes'}",
                "leave it out",
                parameter="edges",
            )


def _require_rising(layout: Layout, read: quantities.Column, rows: Sized, finer: list[float]) -> None:
    """Refuse a curve that falls where two methods overlap; the remedy for any other falling curve would mislead."""
    if read.name != "percent_finer":
        return
    falls = [q for q in range(1, len(finer)) if finer[q] > finer[q - 1] + 1e-9]
    for q in falls:
        line, above = rows.line[q], rows.line[q - 1]
        near = finer[q] - finer[q - 1] <= 0.25 * finer[q - 1] and rows.size[q - 1] <= 1.5 * rows.size[q]
        if len(falls) == 1 and near and line is not None and above is not None:
            raise fault(
                line.place,
                f"{finer[q]:.4g} % finer at {rows.size[q]:.4g} {rows.unit} is more than {finer[q - 1]:.4g} % at "
                f"{rows.size[q - 1]:.4g} {rows.unit}",
                "two methods that overlap, such as sieves and a hydrometer? leave out the points of one",
            )

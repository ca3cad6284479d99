"""Sizes of a table's rows: columns that name one sieve agree, and classes become what stays on their finer sieve."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.agreement import is_numbered, require_same_sieves, same_opening
from comminute.gradings.faults import fault
from comminute.gradings.layout import is_blank
from comminute.gradings.openings import Size, Style, read_size
from comminute.gradings.sieves import SERIES_OF_NUMBERS, convert
from comminute.gradings.words import LENGTHS
from comminute.util.errors import reworded
from comminute.util.names import shorten

if TYPE_CHECKING:
    from comminute.gradings.layout import Column, Layout
    from comminute.gradings.sheets import Line

LENGTH_UNITS = frozenset(LENGTHS.values())


@dataclass
class Sized:
    """Rows with their sizes, coarse to fine.

    Attributes
    ----------
    unit : str
    size : list of float
    line : list of Line or None
        None for the sieve that all of the coarsest class passes, which has no row.
    pan : Line or None
        Row of what passes the finest sieve, where it is written as a class.
    edge : str
        Edge that the header gives to the sizes, "upper" or "lower", or nothing.
    classes : bool
        Whether rows are classes between two sieves.
    """

    unit: str
    size: list[float]
    line: list[Line | None]
    pan: Line | None = None
    edge: str = ""
    classes: bool = False
    notes: list[str] = field(default_factory=list)


def style_of(column: Column, mark: str, mesh: str, lines: list[Line]) -> Style:
    """How the cells of a size column are to be read."""
    meaning = column.meaning
    unit = {"phi": "phi", "designation": "no", "sieve": "no"}.get(meaning.name, meaning.unit)
    pairs = [re.fullmatch(r"([0-9.,]+)\s*/\s*([0-9.,]+)", column.cell(line).text) for line in lines]
    edges = [
        (float(p[1].replace(",", ".")), float(p[2].replace(",", ".")))
        for p in pairs
        if p and p[1].count(".") < 2 and p[2].count(".") < 2 and p[1].count(",") + p[2].count(",") < 2
    ]
    joined = sum(a[0] == b[1] or a[1] == b[0] for a, b in pairwise(edges))
    slashes = unit not in ("no", "in", "") and len(edges) > 1 and joined == len(edges) - 1
    return Style(unit, mark, mesh, slashes)


def sized(
    layout: Layout,
    columns: list[Column],
    lines: list[Line],
    *,
    unit: str | None,
    mark: str,
    mesh: str | None,
    finer: bool,
) -> Sized:
    """Sizes of all rows.

    Parameters
    ----------
    layout : Layout
    columns : list of Column
        Size columns.
    lines : list of Line
        Rows of sieves.
    unit : str or None
        Unit wanted.
    mark : str
        Decimal mark.
    mesh : {"astm", "tyler"} or None
        Series of sieve numbers; None takes ASTM E11.
    finer : bool
        Whether the values are what is finer than each size, so that "<4" is the sieve itself.

    Raises
    ------
    ParameterError
        Naming row, column and cell.
    """
    if any(column.meaning.edge == "middle" for column in columns):
        header = next(column.header for column in columns if column.meaning.edge == "middle")
        raise fault(f"{layout.header.place}, column {header}", "middles of classes", "give the sieves between them")
    main, others, low, high = _roles(layout, columns)
    styles = {column.index: style_of(column, mark, mesh or "astm", lines) for column in columns}
    rows: list[tuple[Line, Size]] = []
    for line in lines:
        if low is not None and high is not None:
            size = _from_edges(line, low, high, styles)
        else:
            size = _one(line, main, others, styles, finer=finer)
        rows.append((line, size))
    if main.meaning.name == "sieve":
        _require_order_of_numbers(layout, main, rows)
    require_same_sieves(rows, others, styles, mesh)
    numbers = any(size.named == "mesh" for _, size in rows) or any(
        is_numbered(c, line, styles) for c in others for line in lines
    )
    if mesh is not None and not numbers:
        raise fault(
            "", f"mesh is '{mesh}', but {layout.name} names no sieve by a number", "leave it out", parameter="mesh"
        )
    to = unit or _unit_of(main, rows)
    made = _ordered(layout, rows, to, finer=finer)
    made.edge = main.meaning.edge if high is None else ""
    made.notes = _notes(layout, main, rows, to, mesh) + made.notes
    for column in others:
        made.notes.append(f"column '{column.header}' of {layout.name} agrees with '{main.header}', which is read")
    return made


def _roles(layout: Layout, columns: list[Column]) -> tuple[Column, list[Column], Column | None, Column | None]:
    """Column to read sizes from, those that name the same sieves, and the two edges of classes."""
    edges = {edge: [column for column in columns if column.meaning.edge == edge] for edge in ("lower", "upper")}
    if len(edges["lower"]) == len(edges["upper"]) == 1:
        return edges["upper"][0], [], edges["lower"][0], edges["upper"][0]
    rank = {"opening": 0, "phi": 1, "designation": 3, "sieve": 3}
    order = sorted(columns, key=lambda c: (rank[c.meaning.name] if c.meaning.unit != "in" else 2, not c.meaning.unit))
    main, others = order[0], order[1:]
    twins = [c for c in others if c.meaning.name == main.meaning.name and c.meaning.unit == main.meaning.unit]
    if twins:
        raise fault(
            layout.header.place,
            f"'{main.header}' and '{twins[0].header}' both name sizes",
            "two tables side by side? give each a file or a sheet of its own",
        )
    return main, others, None, None


def _from_edges(line: Line, low: Column, high: Column, styles: dict[int, Style]) -> Size:
    cells = {column.index: column.cell(line) for column in (low, high)}
    if is_blank(cells[high.index]):
        one = _parsed(line, low, styles)
        return Size("coarser", one.opening, one.unit)
    upper = _parsed(line, high, styles)
    if is_blank(cells[low.index]) or upper.kind == "class":
        return Size("finer", upper.opening, upper.unit) if upper.kind == "sieve" else upper
    lower = _parsed(line, low, styles)
    to = upper.unit if upper.unit == lower.unit else "mm"
    edges = sorted(convert(size.opening, size.unit, to) for size in (lower, upper))
    return Size("class", edges[0], to, edges[1])


def _one(line: Line, main: Column, others: list[Column], styles: dict[int, Style], *, finer: bool) -> Size:
    column = main
    if is_blank(main.cell(line)):
        column = next((other for other in others if not is_blank(other.cell(line))), main)
    return _parsed(line, column, styles, finer=finer)


def _parsed(line: Line, column: Column, styles: dict[int, Style], *, finer: bool = False) -> Size:
    cell, style = column.cell(line), styles[column.index]
    where = line.at(column.header)
    if not cell.text:
        raise fault(where, "the value is empty", "it must be a size, or the row's name, such as pan")
    hashed = cell.text.startswith("#") and style.unit in LENGTH_UNITS
    if hashed:
        raise fault(where, f"'{shorten(cell.text)}' may be a sieve number or a comment", "write No. for the former")
    if cell.number is not None and style.unit in LENGTH_UNITS | {"phi"}:
        number = cell.number
        if style.unit in LENGTH_UNITS:
            size = Size("sieve", number, style.unit)
        else:
            size = read_size(repr(number), Style("phi", "."))
    else:
        try:
            size = read_size(cell.text, style)
        except ParameterError as error:
            changed = {"parameter": "sieve"} if style.unit == "no" else {}
            raise reworded(error, outer=where, changed=changed) from None
    minus = size.kind == "finer" and re.match(r"\s*[-\u2212]\s*[0-9.,]", cell.text) and style.unit in LENGTH_UNITS
    shown = -size.opening if minus else size.opening
    if not math.isfinite(size.opening) or size.opening < 0.0 or (minus and finer):
        raise fault(where, f"the value is {shown:.4g}", "a size must be greater than 0")
    return size


def _require_order_of_numbers(layout: Layout, column: Column, rows: list[tuple[Line, Size]]) -> None:
    """Refuse bare numbers that fall from row to row: they may be openings in mm as well as numbers of sieves."""
    bare = [float(text) for line, _ in rows if re.fullmatch(r"[0-9.]+", text := column.cell(line).text)]
    if len(bare) == len(rows) > 1 and all(b < a for a, b in pairwise(bare)):
        raise fault(
            f"{layout.header.place}, column {column.header}",
            f"{bare[0]:.4g}, {bare[1]:.4g} may be openings or numbers of sieves",
            "name the column size_mm, or write No. before the numbers",
        )


def _unit_of(main: Column, rows: list[tuple[Line, Size]]) -> str:
    if main.meaning.unit:
        return main.meaning.unit
    units = {size.unit for _, size in rows}
    return units.pop() if len(units) == 1 else "mm"


def _ordered(layout: Layout, rows: list[tuple[Line, Size]], to: str, *, finer: bool) -> Sized:
    """Rows from coarse to fine, each on the sieve on which its values stand."""
    made = Sized(to, [], [])
    entries: list[tuple[float, Line | None]] = []
    classes = [(line, size) for line, size in rows if size.kind == "class"]
    made.classes = bool(classes)
    single = [convert(s.opening, s.unit, to) for _, s in rows if s.kind in ("sieve", "coarser") and s.opening > 0.0]
    single += [convert(s.opening, s.unit, to) for _, s in classes if s.opening > 0.0]
    below: list[tuple[Line, float]] = []
    for line, size in rows:
        edge = convert(size.opening, size.unit, to)
        if size.kind == "finer" and finer:
            entries.append((edge, line))
        elif size.kind == "finer" or (size.kind == "class" and edge == 0.0):
            below.append((line, edge if size.kind == "finer" else convert(size.upper, size.unit, to)))
        elif size.kind == "sieve" and edge == 0.0:
            if finer:
                header = next(c.header for c in layout.of_kind("size"))
                raise fault(f"{line.place}, column {header}", "the value is 0", "a size must be greater than 0")
            below.append((line, 0.0))
        else:
            entries.append((edge, line))
    if len(below) > 1:
        raise fault(below[1][0].place, "a second row for what passes the finest sieve", "a table has one pan")
    if below:
        line, edge = below[0]
        if edge > 0.0 and not (single and same_opening(edge, min(single))):
            finest = f"{min(single):.4g}" if single else "none"
            raise fault(line.place, f"finer than {edge:.4g} {to}, but the finest sieve is {finest}")
        made.pan = line
    if classes:
        _close_classes(layout, classes, entries, to)
    entries.sort(key=lambda entry: -entry[0])
    made.size = [size for size, _ in entries]
    made.line = [line for _, line in entries]
    return made


def _close_classes(
    layout: Layout, classes: list[tuple[Line, Size]], entries: list[tuple[float, Line | None]], to: str
) -> None:
    """Require classes without gap or overlap, and add the sieve that the coarsest of them passes."""
    edges = sorted(
        ((convert(size.upper, size.unit, to), convert(size.opening, size.unit, to), line) for line, size in classes),
        key=lambda edge: -edge[0],
    )
    for (_, low, _), (high, _, next_line) in pairwise(edges):
        if not same_opening(low, high):
            raise fault(
                next_line.place,
                f"the class begins at {high:.4g} {to}, and the next coarser one ends at {low:.4g} {to}",
                "classes follow each other without a gap",
            )
    top = edges[0][0]
    for size, line in entries:
        if (
            line is not None
            and size > edges[0][1]
            and not any(line is one for _, _, one in edges)
            and not same_opening(size, top)
        ):
            raise fault(line.place, f"{size:.4g} {to} lies beside classes that end at {top:.4g} {to}")
    if not any(same_opening(size, top) for size, _ in entries):
        entries.append((top, None))


def _notes(layout: Layout, main: Column, rows: list[tuple[Line, Size]], to: str, mesh: str | None) -> list[str]:
    notes = []
    named = {size.named for _, size in rows} - {""}
    if main.meaning.name == "phi":
        notes.append(f"phi of {layout.name} read as openings in {to}")
    elif named:
        series = SERIES_OF_NUMBERS[mesh or "astm"]
        other = "" if mesh or "mesh" not in named else "; mesh = 'tyler' takes Tyler's"
        notes.append(f"sieve designations of {layout.name} read as openings in {to}, by {series}{other}")
    elif main.meaning.unit and to != main.meaning.unit:
        notes.append(f"sizes of {layout.name} converted from {main.meaning.unit} to {to}")
    return notes

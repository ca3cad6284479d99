"""Layout of a sheet: the line in which its table begins, the contents of each column, and the lines around it."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.faults import fault
from comminute.gradings.headers import SIZES, VALUES, Meaning, meaning_of, near_word, unit_in, units_of
from comminute.gradings.openings import Style, read_size, row_meaning
from comminute.gradings.sheets import Cell, Line, Sheet, require_size, text_sheets
from comminute.gradings.words import NO_UNITS, plain
from comminute.util.names import shorten

if TYPE_CHECKING:
    from pathlib import Path

WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods", ".xlsb", ".numbers")
MOST_LINES_ABOVE = 80
MOST_LINES_BELOW = 100  # by which a header is judged
MOST_COLUMNS = 200  # of a table that is read sideways


@dataclass(frozen=True)
class Column:
    """One column: its index, its header as written, and what it holds."""

    index: int
    header: str
    meaning: Meaning

    def cell(self, line: Line) -> Cell:
        """Cell of this column in a line; empty where the line is too short."""
        return line.cells[self.index] if self.index < len(line.cells) else Cell("")


@dataclass(frozen=True)
class Layout:
    """A table found in a sheet.

    Attributes
    ----------
    name, title : str
        Names of the file and, where there are several, of the sheet.
    header : Line
    columns : tuple of Column
    body : tuple of Line
        All lines below the header but comments.
    above : tuple of Line
        Lines above the header.
    width : int
        Number of columns that the header names.
    comma_separated : bool
    notes : tuple of str
    """

    name: str
    title: str
    header: Line
    columns: tuple[Column, ...]
    body: tuple[Line, ...]
    above: tuple[Line, ...]
    width: int
    comma_separated: bool
    notes: tuple[str, ...] = ()

    def of_kind(self, kind: str) -> list[Column]:
        """Columns that hold one kind of thing."""
        return [column for column in self.columns if column.meaning.kind == kind]


def open_layout(path: Path, sheet: str | int | None) -> Layout:
    """Table of a file: of the sheet asked for, or of the first sheet that has one.

    Raises
    ------
    ParameterError
        Saying what is missing or doubtful, and what to write instead.
    ImportError
        For .xlsx where openpyxl is missing.
    """
    require_size(path)
    if path.suffix.lower() not in WORKBOOKS:
        if sheet is not None:
            raise fault(
                "",
                f"sheet is '{sheet}', but {path.name} is a text file, which has no sheets",
                "leave it out",
                parameter="sheet",
            )
        return _of_text(text_sheets(path))
    from comminute.gradings.workbooks import workbook_sheets  # noqa: PLC0415  (openpyxl is optional)

    sheets = workbook_sheets(path)
    if not sheets:
        raise _empty(path.name)
    names = [one.title for one in sheets]
    if sheet is not None:
        wanted = [one for one in sheets if one.title.casefold() == str(sheet).casefold()]
        number = int(sheet) if str(sheet).isdecimal() else 0
        wanted = wanted or sheets[number - 1 : number]
        if not wanted or (number < 1 and not wanted):
            raise fault("", f"sheet is '{sheet}'", f"{path.name} has {', '.join(map(repr, names))}", parameter="sheet")
        return _of_text(wanted[:1])
    found = [layout for one in sheets if (layout := find_layout(one)) is not None]
    if not found:
        if len(sheets) == 1:
            return _of_text(sheets)
        raise fault(path.name, f"none of its sheets {', '.join(map(repr, names))} has a table of sieves")
    first = found[0]
    others = [name for name in names if name != first.title]
    if others:
        one = len(others) == 1
        note = (
            f"sheet '{first.title}' of {path.name} is read, {', '.join(map(repr, others))} {'is' if one else 'are'} not"
        )
        first = replace(first, notes=(*first.notes, f"{note}; sheet = names another"))
    return first


def _empty(name: str) -> ParameterError:
    return fault("", f"{name} is empty", "it needs a header line and at least two sieves")


def _of_text(sheets: list[Sheet]) -> Layout:
    """Table of the first reading of a text that has one, or the reason why none has."""
    first: Layout | ParameterError | None = None
    for sheet in sheets:
        try:
            layout = find_layout(sheet)
        except ParameterError as error:
            first = first or error
            continue
        if layout is None:
            continue
        wide = [line for line in layout.body if len(line.filled) > 1]
        if len(layout.columns) > 1 and 2 * len(wide) >= len(layout.body):
            return layout
        first = first or layout
    if isinstance(first, Layout):
        return first
    raise first or _why_none(sheets[0])


def find_layout(sheet: Sheet) -> Layout | None:
    """Table of a sheet, upright, or sideways with sizes along a row; None where no header is found.

    A header names a size and a quantity; or else a size and samples, whose names are words rather than numbers where
    there is a choice.
    """
    ways = [sheet]
    sideways = sheet.sideways()
    if 2 <= len(sideways.lines) <= MOST_COLUMNS and all(len(line.cells) <= MOST_COLUMNS for line in sideways.lines):
        ways.append(sideways)
    for strong, numbers in ((True, False), (False, False), (False, True)):
        for way in ways:
            layout = _upright(way, strong=strong, numbers=numbers)
            if layout is not None and (layout.body or way is sheet):
                return layout
    if any(line.comment for line in sheet.lines):
        bare = tuple(_uncommented(line) for line in sheet.lines)
        return _upright(replace(sheet, lines=bare), strong=True, numbers=False, comments=sheet.lines)
    return None


def _uncommented(line: Line) -> Line:
    """Line without the # of a comment, in which programs write the header of numbers."""
    if line.cells and line.cells[0].text.startswith("#") and not re.match(r"#\s*[0-9]", line.cells[0].text):
        cells = (Cell(line.cells[0].text.lstrip("# ")), *line.cells[1:])
        return replace(line, cells=cells if cells[0].text else cells[1:], comment=False)
    return line


def _upright(sheet: Sheet, *, strong: bool, numbers: bool, comments: tuple[Line, ...] | None = None) -> Layout | None:
    """Table whose header names a size and, if `strong`, a quantity; `numbers` lets names of samples be numbers."""
    lines = [line for line in sheet.lines if not line.comment]
    best: tuple[int, int, int] | None = None
    for at, _ in enumerate(lines[:MOST_LINES_ABOVE]):
        for high in (1, 2):
            score = _score(lines, at, high, strong=strong, numbers=numbers)
            if score > 0 and (best is None or score > best[0]):
                best = (score, at, high)
    if best is None:
        return None
    _, at, high = best
    titles = _titles(lines[at : at + high])
    below = at + high
    if below < len(lines) and _is_units(lines[below]):
        titles = [_with_unit(sheet, lines[below], title, k) for k, title in enumerate(titles)]
        below += 1
    body = tuple(lines[below:])
    if comments is not None:
        body = tuple(line for line in body if line in comments)
    columns = _size_by_content(_columns(titles), body)
    return Layout(
        sheet.name,
        sheet.title,
        lines[at],
        tuple(columns),
        body,
        tuple(lines[:at]),
        len(titles),
        sheet.delimiter in ("", ","),
    )


def _titles(lines: list[Line]) -> list[str]:
    width = max(len(line.cells) for line in lines)
    return [
        " ".join(line.cells[k].text for line in lines if k < len(line.cells) and line.cells[k].text).strip()
        for k in range(width)
    ]


def _is_units(line: Line) -> bool:
    """Tell whether a line holds nothing but units."""
    return (
        bool(line.filled)
        and all(unit_in(cell.text) or cell.text in NO_UNITS for cell in line.filled)
        and not any(cell.number is not None or cell.text.isdecimal() for cell in line.filled)
    )


def _with_unit(sheet: Sheet, line: Line, title: str, index: int) -> str:
    text = line.cells[index].text if index < len(line.cells) else ""
    unit = unit_in(text)
    if not unit or not title:
        return title
    said = units_of(title)[0]
    if said - {unit, "%"} and unit != "%":
        raise fault(line.place, f"'{text}' stands below '{title}', whose unit is {', '.join(sorted(said))}")
    return title if said else f"{title} [{unit}]"


def _score(lines: list[Line], at: int, high: int, *, strong: bool, numbers: bool) -> int:
    """Rank of a header that begins at a line and is so many lines high; 0 for none."""
    used = lines[at : at + high]
    if len(used) < high or len(used[0].filled) < 2:
        return 0
    if (not numbers or high == 2) and any(cell.numeric for line in used for cell in line.filled):
        return 0
    if high == 2:
        kinds = [column.meaning.kind for column in _columns(_titles(used[:1]))]
        if _is_units(used[1]) or kinds.count("size") + kinds.count("value") < 2:
            return 0
    columns = _columns(_titles(used))
    body = tuple(line for line in lines[at + high : at + high + MOST_LINES_BELOW] if not _is_units(line))
    kinds = [column.meaning.kind for column in _size_by_content(columns, body) if column.header]
    filled = any(cell.numeric for line in body for cell in line.filled)
    if "size" not in kinds or len(kinds) < 2 or (strong and "value" not in kinds):
        return 0
    if (body and not filled) or not (strong or body):
        return 0
    known = kinds.count("size") + kinds.count("value")
    return 10 * known + 5 * filled + (high == 2) - kinds.count("unknown")


def _columns(titles: list[str]) -> list[Column]:
    """Columns by their headers; a header that is itself a size, as in a table of samples by rows, is none."""
    columns = []
    for k, title in enumerate(titles):
        meaning = meaning_of(title) if title and not _explicit(title) else Meaning("unknown", rest=title)
        columns.append(Column(k, shorten(title), meaning))
    return columns


def _size_by_content(columns: list[Column], body: tuple[Line, ...]) -> list[Column]:
    """Columns, one of them made the size column where no header says so but its cells are sizes with their units."""
    if any(column.meaning.kind == "size" for column in columns):
        return columns
    for k, column in enumerate(columns):
        if column.meaning.kind not in ("unknown", "sample", "unused"):
            continue
        texts = [column.cell(line).text for line in body if column.cell(line).text]
        sizes = [text for text in texts if _explicit(text)]
        if len(sizes) >= 2 and all(text in sizes or row_meaning(text) for text in texts):
            made = Column(column.index, column.header, Meaning("size", "opening"))
            return [*columns[:k], made, *columns[k + 1 :]]
    return columns


def _explicit(text: str) -> bool:
    try:
        read_size(text, Style("", "," if "," in text else "."))
    except ParameterError:
        return False
    return True


def _why_none(sheet: Sheet) -> ParameterError:
    """Reason why a sheet has no header, and what to write."""
    lines = [line for line in sheet.lines if not line.comment]
    if not lines:
        return _empty(sheet.name)
    widest = max(len(line.filled) for line in lines)
    numbers = [line for line in lines if line.filled and all(cell.numeric for cell in line.filled)]
    first = lines[0]
    if widest == 1 and len(numbers) >= 2:
        return fault(
            "",
            f"{sheet.name} has one column of numbers: a list of grains is no table of sieves",
            "count them by classes, or weigh them, and give a column of sizes and one of values (size_mm,count)",
        )
    named = any(meaning_of(cell.text).kind in ("size", "value") for cell in first.filled if not _explicit(cell.text))
    if (numbers and numbers[0] is first) or (any(cell.numeric for cell in first.filled) and not named):
        return fault(
            "", f"{first.place} holds numbers", "a header is missing: write one above, such as size_mm,percent_finer"
        )
    rows = [(line, [meaning_of(cell.text) for cell in line.filled]) for line in lines[:MOST_LINES_ABOVE]]
    line, meanings = max(rows, key=lambda row: sum(m.kind in ("size", "value") for m in row[1]))
    texts = [cell.text for cell in line.filled]
    sizes = [m for m in meanings if m.kind == "size"]
    unknown = [text for text, m in zip(texts, meanings, strict=True) if m.kind not in ("size", "value")]
    hints = [(text, near_word(text)) for text in unknown]
    what, known = ("value", VALUES) if sizes else ("size", SIZES)
    meant = next((f"; did you mean {near} by '{shorten(text)}'?" for text, near in hints if near in known), "")
    return fault(line.place, f"the header names no {what} column", f"it must name one of {', '.join(known)}{meant}")


def is_blank(cell: Cell) -> bool:
    """Tell whether a cell holds nothing, or a dash for nothing."""
    return plain(cell.text) in ("", "-", "--", "---", "/", "n/a", "na")

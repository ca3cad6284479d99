"""Cells of text files and spreadsheets, each row with its place; no meaning is read into them here."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from comminute._core import Place
from comminute.gradings.faults import fault
from comminute.gradings.words import meanings_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOST_BYTES = 16_000_000  # of a sieve table; anything larger is another kind of file
ENCODINGS = ("cp1252", "cp932", "gb18030", "latin-1")  # of text that is not UTF-8
DELIMITERS = ("\t", ";", "|", ",", r"\s{2,}", r"\s+")
MOST_LINES_OF_A_CELL = 3
NO_DELIMITER = r"(?!)"  # which matches nowhere
NUMERIC = re.compile(r"[<>≤≥+-]?\s?[0-9.,' ]*[0-9][.,]?\s?(?:%|[a-zA-Zµμ]{1,2})?")


@dataclass(frozen=True)
class Cell:
    """One cell: its text, and its number where the file stores one rather than text."""

    text: str
    number: float | None = None

    @property
    def numeric(self) -> bool:
        """Tell whether this looks like a number, in whatever notation."""
        return self.number is not None or NUMERIC.fullmatch(self.text) is not None


@dataclass(frozen=True)
class Line:
    """One row of a sheet, or one column of a sheet that is read sideways: its place, its cells, and its number."""

    place: str
    cells: tuple[Cell, ...]
    comment: bool = False
    number: int = 0
    file: str = ""

    def at(self, column: str) -> Place:
        """Place of a cell by the header of its column."""
        return Place(self.file, row=self.number, column=column) if self.file else Place(self.place, column=column)

    @property
    def filled(self) -> list[Cell]:
        """Cells in which something stands."""
        return [cell for cell in self.cells if cell.text]


@dataclass(frozen=True)
class Sheet:
    """Rows of one table with the name of its file, and of its sheet where the file has several."""

    name: str
    lines: tuple[Line, ...]
    title: str = ""
    delimiter: str = ""

    def sideways(self) -> Sheet:
        """Give the same cells with rows and columns exchanged."""
        lines = [line for line in self.lines if not line.comment]
        width = max((len(line.cells) for line in lines), default=0)
        columns = [
            Line(f"{self.name} column {_letters(k)}", tuple(_cell_at(line, k) for line in lines), number=k + 1)
            for k in range(width)
        ]
        return replace(self, lines=tuple(column for column in columns if column.filled))


def _cell_at(line: Line, index: int) -> Cell:
    return line.cells[index] if index < len(line.cells) else Cell("")


def _letters(index: int) -> str:
    """Name of a column as spreadsheets count them: A, B, ... Z, AA."""
    name = ""
    index += 1
    while index:
        index, rest = divmod(index - 1, 26)
        name = chr(65 + rest) + name
    return name


def require_size(path: Path) -> None:
    """Refuse a file too large to be a table of sieves."""
    if path.stat().st_size > MOST_BYTES:
        raise fault("", f"{path.name} has {path.stat().st_size / 1e6:.0f} MB", "a sieve table has a few lines")


def text_sheets(path: Path, *, one_column: bool = False) -> list[Sheet]:
    """Ways in which a text file's lines split into cells, the likeliest first; `one_column` leaves lines whole.

    Raises
    ------
    ParameterError
        For a file that is no text, or a quotation mark without an end.
    """
    text = _decoded(path)
    lines = list(enumerate(re.split(r"\r\n|\r|\n", text), 1))
    if one_column:
        return [_split(path.name, lines, NO_DELIMITER)]
    told = re.fullmatch(r'"?sep=(.)"?[,;]*', lines[0][1].strip()) if lines else None
    if told or (lines and lines[0][1].lower().startswith("sep=\t")):
        return [_split(path.name, lines[1:], told[1] if told else "\t")]
    body = [line for _, line in lines if line.strip() and not line.lstrip(' "').startswith("#")]
    sheets = []
    for delimiter in DELIMITERS:
        if any(re.search(delimiter if len(delimiter) > 1 else re.escape(delimiter), line.strip()) for line in body):
            sheets.append(_split(path.name, lines, delimiter))
    return sheets or [_split(path.name, lines, ",")]


def _decoded(path: Path) -> str:
    """Text of a file: UTF-8 or UTF-16, else the encoding in which most words of a header are known."""
    raw = path.read_bytes()
    encoding = "utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        readings = []
        for other in ENCODINGS:
            try:
                readings.append(raw.decode(other))
            except UnicodeDecodeError:
                continue
        text = max(readings, key=lambda reading: len(meanings_of(reading[:2000])[0]))
    if "\x00" in text:
        raise fault("", f"{path.name} is no text file (it holds zero bytes)", "save the table as CSV")
    return text


def _split(name: str, lines: list[tuple[int, str]], delimiter: str) -> Sheet:
    rows = []
    for number, line in _joined(name, lines, delimiter):
        content = line if delimiter == "\t" else line.strip()
        if delimiter == "|":
            content = content.strip("|")
        content = re.split(r"\s#\s(?!\s*[0-9])", content, maxsplit=1)[0]
        if len(delimiter) > 1:
            cells = re.split(delimiter, content)
        else:
            cells = next(csv.reader([content], delimiter=delimiter), [])
        row = Line(f"{name} row {number}", tuple(Cell(cell.strip()) for cell in cells), number=number, file=name)
        ruled = all(re.fullmatch(r"[-=:+_\s]+", cell.text) for cell in row.filled) and len(line.strip()) > 4
        if row.filled and not ruled:
            rows.append(replace(row, comment=is_comment(row.cells)))
    return Sheet(name, tuple(rows), delimiter=delimiter)


def _joined(name: str, lines: list[tuple[int, str]], delimiter: str) -> Iterator[tuple[int, str]]:
    """Lines with their numbers; cells that a quotation mark carries over a line end are joined."""
    if len(delimiter) > 1:
        yield from lines
        return
    waiting: tuple[int, str, str] | None = None
    for number, line in lines:
        first, text = (number, line) if waiting is None else (waiting[0], f"{waiting[1]} {line}")
        if waiting is None and line.lstrip(' "').startswith("#") and delimiter not in line:
            yield first, text.replace('"', "")
            continue
        try:
            next(csv.reader([text], delimiter=delimiter, strict=True), None)
        except csv.Error as error:
            waiting = (first, text, str(error) if waiting is None else waiting[2])
            if number - first < MOST_LINES_OF_A_CELL:
                continue
            break
        waiting = None
        yield first, text
    if waiting is not None:
        raise fault(f"{name} row {waiting[0]}", waiting[2], "close every quotation mark")


def is_comment(cells: tuple[Cell, ...]) -> bool:
    """Tell whether a row that begins with # says something in words, rather than naming a sieve such as #200."""
    first = cells[0].text if cells else ""
    if not first.startswith("#") or re.fullmatch(r"#(REF!|N/A|NAME\?|DIV/0!|VALUE!|NUM!|NULL!)", first):
        return False
    return not (re.match(r"#\s*[0-9]", first) and any(cell.numeric for cell in cells[1:]))

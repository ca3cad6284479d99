"""Tables of numbers in text and spreadsheet files, every cell with its place for messages."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from comminute._core import Place
from comminute.gradings.rows import Row
from comminute.gradings.spreadsheets import spreadsheet_rows
from comminute.util.errors import parameter_error, wrong_file
from comminute.util.names import is_file, shorten

if TYPE_CHECKING:
    from collections.abc import Iterator

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma"}
MOST_BYTES = 16_000_000  # largest sieve table; anything larger is another kind of file
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")


@dataclass(frozen=True)
class Table:
    """Header and rows of a file; a cell is text until it is read as a number."""

    name: str
    header: Row
    rows: tuple[Row, ...]
    decimal_comma: bool

    def place(self, row: Row, column: str = "") -> Place:
        """File, number and column of a cell, or of a whole row, for errors."""
        return Place(self.name, row=row.number, column=column)

    def columns(self) -> Iterator[tuple[int, str]]:
        """Index and name of each column, names in small letters with underscores for blanks."""
        for index, name in enumerate(self.header.cells):
            yield index, re.sub(r"[\s.-]+", "_", name.strip().lower())

    def number(self, row: Row, column: int) -> float:
        """One cell as a finite number.

        Raises
        ------
        ParameterError
            For a cell that is no finite number; the message names file, row, column and text.
        """
        text = row.cells[column].strip()
        plain = text.removesuffix("%").rstrip()
        if self.decimal_comma and plain.count(",") == 1 and "." not in plain:
            plain = plain.replace(",", ".")
        if NUMBER.fullmatch(plain):
            value = float(plain)
            if math.isfinite(value):
                return value
        name = self.header.cells[column].strip()
        rule = "it must be a number"
        if "," in plain and not self.decimal_comma:
            rule += " (a decimal comma needs semicolons or tabs between columns)"
        found = f"'{shorten(text)}'" if text else "empty"
        raise parameter_error(name, found, rule, subject="the value", place=self.place(row, name))


def read_table(path: Path) -> Table:
    """Table in a .csv, .txt, .tsv or .xlsx file.

    Raises
    ------
    ParameterError
        For a file that is missing, empty, no text, or uneven; the message names file and row.
    ImportError
        For .xlsx where openpyxl is missing.
    """
    if not is_file(path):
        raise wrong_file(str(path), "is no file", "give a sieve table (.csv or .xlsx)")
    if path.stat().st_size > MOST_BYTES:
        size = f"{path.stat().st_size / 1e6:.0f} MB"
        raise wrong_file(path.name, f"has {size}", "a sieve table has a few lines")
    if path.suffix.lower() in (".xlsx", ".xls", ".ods"):
        return _table(path.name, spreadsheet_rows(path), decimal_comma=False)
    return _text_table(path)


def _text_table(path: Path) -> Table:
    raw = path.read_bytes()
    encoding = "utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        text = raw.decode("latin-1")  # older spreadsheets write it; only comments and units can differ
    if "\x00" in text:
        raise wrong_file(path.name, "is no text file (it holds zero bytes)", "save the table as CSV")
    lines = [
        (number, line)
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if line.strip(" \t;,") and not line.lstrip(' "').startswith("#")
    ]
    if not lines:
        raise wrong_file(path.name, "is empty", "it needs a header line and at least two sieves")
    delimiter = next((d for d in DELIMITERS if d in lines[0][1]), ",")
    _refuse_sieves_as_comments(path.name, text, delimiter)
    rows = []
    for number, line in lines:
        content = line if delimiter == "\t" else line.strip()
        try:
            cells = next(csv.reader([_without_comment(content)], delimiter=delimiter, strict=True))
        except csv.Error as error:
            place = Place(path.name, row=number)
            raise parameter_error(subject=str(error), rule="close every quotation mark", place=place) from None
        rows.append(Row(number, tuple(cell.strip() for cell in cells)))
    return _table(path.name, rows, decimal_comma=delimiter != ",")


def _refuse_sieves_as_comments(name: str, text: str, delimiter: str) -> None:
    """Refuse lines such as "#200,12.5": as comments they would be lost, and as sieves they may not be meant."""
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        if re.match(rf"\s*#\s*[0-9.]+\s*{re.escape(delimiter)}\s*[0-9.,]+\s*$", line):
            found = shorten(line.strip())
            raise parameter_error(
                subject=f"'{found}'",
                finding="begins with # and would be skipped as a comment",
                rule="write a sieve as No. 200, or a comment with a word in it",
                place=Place(name, row=number),
            )


def _without_comment(line: str) -> str:
    """Cut a line before a # between blanks; "#200" is a sieve."""
    return re.split(r"\s#\s", line, maxsplit=1)[0]


def _table(name: str, rows: list[Row], *, decimal_comma: bool) -> Table:
    if not rows:
        raise wrong_file(name, "is empty", "it needs a header line and at least two sieves")
    first, *body = rows
    header = Row(first.number, tuple(shorten(cell) for cell in first.cells))
    width = len(header.cells)
    for row in body:
        extra = [cell for cell in row.cells[width:] if cell]
        if extra or len(row.cells) < width:
            commas = " (decimal commas need semicolons or tabs between columns)"
            raise parameter_error(
                subject=f"{len(row.cells)} columns,",
                finding=f"but the header names {width}",
                rule="give every row one value for each column" + (commas if extra and not decimal_comma else ""),
                place=Place(name, row=row.number),
            )
    return Table(name, header, tuple(Row(row.number, row.cells[:width]) for row in body), decimal_comma)

"""Tables of numbers in text and spreadsheet files, every cell with its place for messages."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from comminute._core import ParameterError
from comminute.gradings.rows import Row
from comminute.gradings.spreadsheets import spreadsheet_rows
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

    def place(self, row: Row) -> str:
        """Name of a row in messages: file and number."""
        return f"{self.name} row {row.number}"

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
        what = "is empty" if not text else f"is '{shorten(text)}'"
        remedy = "; it must be a number"
        if "," in plain and not self.decimal_comma:
            remedy += " (a decimal comma needs semicolons or tabs between columns)"
        raise ParameterError(f"{self.place(row)}, column {name}: the value {what}{remedy}")


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
        raise ParameterError(f"{shorten(str(path), 200)} is no file; give a sieve table (.csv or .xlsx)")
    if path.stat().st_size > MOST_BYTES:
        raise ParameterError(f"{path.name} has {path.stat().st_size / 1e6:.0f} MB; a sieve table has a few lines")
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
        raise ParameterError(f"{path.name} is no text file (it holds zero bytes); save the table as CSV")
    lines = [
        (number, line)
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if line.strip(" \t;,") and not line.lstrip(' "').startswith("#")
    ]
    if not lines:
        raise ParameterError(f"{path.name} is empty; it needs a header line and at least two sieves")
    delimiter = next((d for d in DELIMITERS if d in lines[0][1]), ",")
    _refuse_sieves_as_comments(path.name, text, delimiter)
    rows = []
    for number, line in lines:
        content = line if delimiter == "\t" else line.strip()
        try:
            cells = next(csv.reader([_without_comment(content)], delimiter=delimiter, strict=True))
        except csv.Error as error:
            raise ParameterError(f"{path.name} row {number}: {error}; close every quotation mark") from None
        rows.append(Row(number, tuple(cell.strip() for cell in cells)))
    return _table(path.name, rows, decimal_comma=delimiter != ",")


def _refuse_sieves_as_comments(name: str, text: str, delimiter: str) -> None:
    """Refuse lines such as "#200,12.5": as comments they would be lost, and as sieves they may not be meant."""
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        if re.match(rf"\s*#\s*[0-9.]+\s*{re.escape(delimiter)}\s*[0-9.,]+\s*$", line):
            found = shorten(line.strip())
            raise ParameterError(
                f"{name} row {number}: '{found}' begins with # and would be skipped as a comment; "
                "write a sieve as No. 200, or a comment with a word in it"
            )


def _without_comment(line: str) -> str:
    """Cut a line before a # between blanks; "#200" is a sieve."""
    return re.split(r"\s#\s", line, maxsplit=1)[0]


def _table(name: str, rows: list[Row], *, decimal_comma: bool) -> Table:
    if not rows:
        raise ParameterError(f"{name} is empty; it needs a header line and at least two sieves")
    first, *body = rows
    header = Row(first.number, tuple(shorten(cell) for cell in first.cells))
    width = len(header.cells)
    for row in body:
        extra = [cell for cell in row.cells[width:] if cell]
        if extra or len(row.cells) < width:
            raise ParameterError(
                f"{name} row {row.number}: {len(row.cells)} columns, but the header names {width}; "
                "give every row one value for each column"
                + (" (decimal commas need semicolons or tabs between columns)" if extra and not decimal_comma else "")
            )
    return Table(name, header, tuple(Row(row.number, row.cells[:width]) for row in body), decimal_comma)

"""Sieve tables from files: the meaning of their columns, and per cent finer from a laboratory's numbers."""

from __future__ import annotations

import difflib
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from comminute._core import Grading, ParameterError, Place, defaults
from comminute.gradings.rows import Row
from comminute.gradings.sieves import IN_MM, convert, sieve_size, unit_of
from comminute.gradings.tables import Table, read_table
from comminute.util.errors import parameter_error, reworded, wrong_file

Top = Literal["error", "extend"]
SIEVES = defaults["from_sieves"]
VALUES = ("percent_finer", "percent_retained", "percent_cumulative_retained", "mass_retained_g")
ALIASES = {"percent_passing": "percent_finer", "percent_coarser": "percent_cumulative_retained"}
SIZES = ("size_mm", "size_um", "size_cm", "size_m", "size_in", "phi", "sieve")
SIZE_WORDS = "sieve|sieve_size|sieve_opening|opening|aperture|diameter|grainsize|grain_size"  # followed by a unit
ROUNDED = 0.5  # [per cent] largest distance of the sum of rounded shares from 100


@dataclass(frozen=True)
class SieveData:
    """Sieves of a file in its order, per cent finer, and the assumptions made in reading it.

    Attributes
    ----------
    size, percent_finer : tuple of float
        One of each for every sieve.
    unit : str
        Unit of the sizes.
    places : tuple of str
        Place of each sieve, "sand.csv row 5"; empty for sieves that stand in a case.
    notes : tuple of str
        The assumptions, in plain words.
    name : str
        Name of the file, or of the table of a case.
    """

    size: tuple[float, ...]
    percent_finer: tuple[float, ...]
    unit: str
    places: tuple[str, ...]
    notes: tuple[str, ...]
    name: str

    def grading(self, *, top: Top, number: bool) -> Grading:
        """Grading of these sieves; errors name the file and its rows."""
        try:
            return Grading.from_sieves(
                self.size, self.percent_finer, self.unit, top=top, number=number, notes=self.notes
            )
        except ParameterError as error:
            raise self._in_file(error) from None

    def _in_file(self, error: ParameterError) -> ParameterError:
        """Give an error, whose rows count the sieves, the rows of the file and a remedy for its columns."""
        place = error.place and self._place(error.place[0])
        changed: dict[str, object] = {
            "place": place or (Place(self.name),),
            "also": error.also and self._place(error.also)[-1],
        }
        if error.remedy == "cumulate_retained" and self.places:
            changed["remedy"] = "name_retained_column"
        return reworded(error, changed=changed)

    def _place(self, sieve: Place) -> tuple[Place, ...]:
        """Place in the file of a sieve that the core knows by its row in the lists, counted from 1."""
        return (Place(self.places[sieve.row - 1]),) if self.places else (Place(self.name), sieve)


def read_grading(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    top: Top = SIEVES["top"],
    number: bool = SIEVES["number"],
) -> Grading:
    r"""Measured curve from a sieve table: .csv, .txt, .tsv, or .xlsx with the extra `xlsx`.

    The header names a size column, `size_mm` (or um, cm, m, in), `phi`, or `sieve` (ASTM E11 numbers and
    inches, or openings with their unit), and one of `percent_finer`, `percent_retained` (on each sieve),
    `percent_cumulative_retained`, `mass_retained_g`. Rows in any order; one may be the `pan`. Columns are
    separated by commas, semicolons or tabs, and with the last two decimal commas are read. Lines that begin
    with # are comments.

    Parameters
    ----------
    path : path-like
    unit : str, optional
        Unit of the sizes of the grading; left out: the unit of the file, mm for phi and sieve.
    top : {"error", "extend"}
        See `Grading.from_sieves`.
    number : bool
        The shares count grains; see `Grading.from_sieves`.

    Returns
    -------
    Grading
        Its `notes` say what was converted or assumed.

    Raises
    ------
    ParameterError
        For a table that makes no grading; it names file, row, column and value, the rule, and the remedy.
    ImportError
        For .xlsx where openpyxl is missing.

    Examples
    --------
    >>> import comminute as cm, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "sand.csv")
    >>> _ = path.write_text("size_mm;mass_retained_g\n2,0;0\n1,0;30\n0,5;50\npan;20\n")
    >>> cm.Grading.read(path).finer([2.0, 1.0, 0.5])
    array([1. , 0.7, 0.2])
    """
    return read_sieves(path, unit=unit).grading(top=top, number=number)


def read_sieves(path: str | os.PathLike[str], *, unit: str | None = None) -> SieveData:
    """Sieves and per cent finer from a file; see `read_grading`."""
    table = read_table(Path(path))
    size_column, size_name, file_unit, value_column, value_name, unused = _columns(table)
    to = file_unit if unit is None else unit_of(unit)
    if not to:
        raise parameter_error("unit", f"'{unit}'", f"it must be one of {', '.join(IN_MM)}")
    sizes, values, rows, pan = [], [], [], None
    for row in table.rows:
        if row.cells[size_column].strip().lower() == "pan":
            if pan is not None:
                raise parameter_error("pan", subject="a second pan", rule="a table has one", place=table.place(row))
            pan = row
            continue
        sizes.append(convert(_size(table, row, size_column, size_name), file_unit, to))
        values.append(_value(table, row, value_column, value_name))
        rows.append(row)
    if not rows:
        raise wrong_file(table.name, "has a header but no sieves", "it needs at least two")
    notes = [f"column '{name}' of {table.name} is not used" for name in unused]
    if size_name in ("phi", "sieve"):
        what = "phi" if size_name == "phi" else "sieve designations"
        notes.append(f"{what} of {table.name} read as openings in {to}")
    elif to != file_unit:
        notes.append(f"sizes of {table.name} converted from {file_unit} to {to}")
    in_pan = None if pan is None else _value(table, pan, value_column, value_name)
    if value_name == "percent_finer":
        if in_pan:
            raise parameter_error(
                "percent_finer",
                in_pan,
                "the pan holds all",
                subject=f"{in_pan:g} %",
                finding="is finer than the pan",
                place=table.place(pan or rows[0]),
                remedy="leave_out",
            )
        finer = values
    elif value_name == "percent_cumulative_retained":
        finer = _from_cumulative(table, values, in_pan, notes)
    else:
        finer = _from_retained(table, value_name, sizes, values, in_pan, notes)
    places = tuple(str(table.place(row)) for row in rows)
    return SieveData(tuple(sizes), tuple(finer), to, places, tuple(notes), table.name)


def _columns(table: Table) -> tuple[int, str, str, int, str, list[str]]:
    """Index and name of the size column, unit of the sizes, index and name of the value column, and unused columns."""
    found_sizes, found_values, unused = [], [], []
    for index, raw in table.columns():
        name = _usual(raw)
        unit = unit_of(name.removeprefix("size_")) if name.startswith("size_") else ""
        if unit or name in ("phi", "sieve"):
            found_sizes.append((index, name, unit or "mm"))
        elif name in VALUES:
            found_values.append((index, name))
        else:
            unused.append(table.header.cells[index].strip())
    if len(found_sizes) != 1:
        raise _wrong_header(table, "size", [name for _, name, _ in found_sizes], SIZES, unused)
    if len(found_values) != 1:
        raise _wrong_header(table, "value", [name for _, name in found_values], VALUES, unused)
    return (*found_sizes[0], *found_values[0], unused)


def _usual(name: str) -> str:
    """Bring "% passing", "Passing (%)" and "sieve opening (mm)" to the names that this module knows."""
    words = [word for word in re.split(r"[_()\[\]]+", name.replace("%", "_percent_")) if word]
    if "percent" in words:
        words = ["percent", *(word for word in words if word != "percent")]
    plain = "_".join(words)
    plain = re.sub(rf"^({SIZE_WORDS})_(?=[^_]+$)", "size_", plain)
    return ALIASES.get(plain, plain)


def _wrong_header(
    table: Table, kind: str, found: list[str], known: tuple[str, ...], unused: list[str]
) -> ParameterError:
    """Make the error of a header that lacks a column or has one too many, with the nearest name that would do."""
    place = table.place(table.header)
    if found:
        names = " and ".join(found)
        rule = f"leave one {kind} column"
        return parameter_error(kind, subject=names, finding="are both named", rule=rule, place=place)
    if kind == "size" and "size" in (name.lower() for name in unused):
        rule = "name it size_mm or size_um"
        return parameter_error(kind, subject="the size column", finding="has no unit", rule=rule, place=place)
    near = [(name, difflib.get_close_matches(name.lower(), known, n=1, cutoff=0.5)) for name in unused]
    meant = next((f"; did you mean {match[0]} by '{name}'?" for name, match in near if match), "")
    rule = f"it must name one of {', '.join(known)}{meant}"
    return parameter_error(kind, subject="the header", finding=f"names no {kind} column", rule=rule, place=place)


def _size(table: Table, row: Row, column: int, name: str) -> float:
    """One sieve opening, in the unit of its column (mm for phi and designations)."""
    if name == "sieve":
        try:
            return sieve_size(row.cells[column])
        except ParameterError as error:
            raise reworded(error, outer=table.place(row, "sieve")) from None
    number = table.number(row, column)
    size = 2.0**-number if name == "phi" and abs(number) < 1000.0 else number
    if not (size > 0.0 and math.isfinite(size)) or (name == "phi" and abs(number) >= 1000.0):
        rule = "phi must be between -1000 and 1000" if name == "phi" else "a size must be greater than 0"
        raise _wrong_value(table, row, name, number, rule)
    return size


def _value(table: Table, row: Row, column: int, name: str) -> float:
    value = table.number(row, column)
    if value < 0.0 or (value > 100.0 and name != "mass_retained_g"):
        rule = "at least 0" if name == "mass_retained_g" else "between 0 and 100"
        raise _wrong_value(table, row, name, value, f"it must be {rule}")
    return value


def _wrong_value(table: Table, row: Row, column: str, value: float, rule: str) -> ParameterError:
    return parameter_error(column, value, rule, subject="the value", place=table.place(row, column))


def _from_cumulative(table: Table, values: list[float], in_pan: float | None, notes: list[str]) -> list[float]:
    whole = 100.0
    largest = max(values) if in_pan is None else in_pan
    if largest == 1.0:
        whole = 1.0
        notes.append("the values end at 1: read as fractions, not per cent")
    elif largest < 1.0:
        name = "percent_cumulative_retained"
        raise parameter_error(name, largest, "give per cent", subject=f"the largest {name}", place=table.name)
    if in_pan is not None and in_pan != whole:
        raise parameter_error(
            "percent_cumulative_retained",
            in_pan,
            "it must hold all: 100 %",
            subject=f"{in_pan:g} %",
            finding="is retained down to the pan",
            place=table.name,
        )
    return [100.0 * ((whole - value) / whole) for value in values]


def _from_retained(
    table: Table, name: str, sizes: list[float], values: list[float], in_pan: float | None, notes: list[str]
) -> list[float]:
    """Per cent finer on each sieve, from the mass or share retained on each and in the pan."""
    total = math.fsum(values) + (in_pan or 0.0)
    if not total > 0.0:
        raise _wrong_total(table, name, total, "some mass must be on the sieves")
    whole = total
    if name == "mass_retained_g":
        if in_pan is None:
            notes.append(f"{table.name} has no pan row: nothing taken as finer than the finest sieve")
    elif total <= 1.0 + ROUNDED / 100.0:
        if in_pan is None or abs(total - 1.0) > ROUNDED / 100.0:
            raise _wrong_total(table, name, total, "give per cent, not fractions")
        notes.append("the values add up to 1: read as fractions, not per cent")
    elif total > 100.0 + ROUNDED or (in_pan is not None and total < 100.0 - ROUNDED):
        raise _wrong_total(
            table, name, total, "it must be 100 %", "name_cumulative_column" if total > 100.0 else "", unit=" %"
        )
    elif in_pan is None and total < 100.0:
        whole = 100.0
        notes.append(
            f"{table.name} has no pan row: the missing {100.0 - total:.4g} % taken as finer than the finest sieve"
        )
    if name == "percent_retained" and abs(whole - 100.0) > 1e-9 and whole > 2.0:
        notes.append(f"percent_retained of {table.name} adds up to {total:.6g} %: scaled to 100 %")
    # summed from the fine end, so that the share that passes the finest sieve is exactly that of the pan
    rest = in_pan if in_pan is not None else max(whole - total, 0.0)
    order = sorted(range(len(sizes)), key=lambda q: sizes[q])
    finer = [0.0] * len(sizes)
    passed: list[float] = []
    for q in order:
        finer[q] = 100.0 * min(math.fsum([rest, *passed]) / whole, 1.0)
        passed.append(values[q])
    # a sieve is passed by all where nothing stays on it or above, whatever the rounding
    for q in reversed(order):
        if values[q] != 0.0:
            break
        finer[q] = 100.0
    return finer


def _wrong_total(
    table: Table, column: str, total: float, rule: str, remedy: str = "", unit: str = ""
) -> ParameterError:
    finding = f"adds up to {total:.6g}{unit}"
    subject = f"column {column}"
    return parameter_error(column, total, rule, subject=subject, finding=finding, place=table.name, remedy=remedy)

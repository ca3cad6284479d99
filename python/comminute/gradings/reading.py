"""Sieve tables from files: the meaning of their columns, and per cent finer from a laboratory's numbers."""

from __future__ import annotations

import difflib
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from comminute._core import Grading, ParameterError
from comminute.gradings.rows import Row
from comminute.gradings.sieves import convert, sieve_size, unit_of
from comminute.gradings.tables import Table, read_table

Top = Literal["error", "extend"]
VALUES = ("percent_finer", "percent_retained", "percent_cumulative_retained", "mass_retained_g")
ALIASES = {"percent_passing": "percent_finer", "percent_coarser": "percent_cumulative_retained"}
SIZES = ("size_mm", "size_um", "size_cm", "size_m", "size_in", "phi", "sieve")
SIZE_WORDS = "sieve|sieve_size|sieve_opening|opening|aperture|diameter|grainsize|grain_size"  # followed by a unit
ROUNDED = 0.5  # [per cent] largest distance of the sum of rounded shares from 100


@dataclass(frozen=True)
class SieveData:
    """Content of a sieve table: its sieves in their order, per cent finer, and the assumptions made in reading it."""

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
                self.size,
                self.percent_finer,
                self.unit,
                top=top,
                number=number,
                places=self.places,
                notes=self.notes,
                if_retained="name the column percent_retained.",
            )
        except ParameterError as error:
            message = str(error)
            raise ParameterError(message if message.startswith(self.name) else f"{self.name}: {message}") from None


def read_grading(path: str | os.PathLike[str], *, unit: str | None, top: Top, number: bool) -> Grading:
    """Grading from a sieve table; see `Grading.read`."""
    return read_sieves(path, unit=unit).grading(top=top, number=number)


def read_sieves(path: str | os.PathLike[str], *, unit: str | None = None) -> SieveData:
    """Sieves and per cent finer from a file; see `Grading.read`."""
    table = read_table(Path(path))
    size_column, size_name, file_unit, value_column, value_name, unused = _columns(table)
    to = file_unit if unit is None else unit_of(unit)
    if not to:
        raise ParameterError(f"unit is '{unit}'; it must be one of nm, um, mm, cm, m, in")
    sizes, values, rows, pan = [], [], [], None
    for row in table.rows:
        if row.cells[size_column].strip().lower() == "pan":
            if pan is not None:
                raise ParameterError(f"{table.place(row)}: a second pan; a table has one")
            pan = row
            continue
        sizes.append(convert(_size(table, row, size_column, size_name), file_unit, to))
        values.append(_value(table, row, value_column, value_name))
        rows.append(row)
    if not rows:
        raise ParameterError(f"{table.name} has a header but no sieves; it needs at least two")
    notes = [f"column '{name}' of {table.name} is not used" for name in unused]
    if size_name in ("phi", "sieve"):
        what = "phi" if size_name == "phi" else "sieve designations"
        notes.append(f"{what} of {table.name} read as openings in {to}")
    elif to != file_unit:
        notes.append(f"sizes of {table.name} converted from {file_unit} to {to}")
    in_pan = None if pan is None else _value(table, pan, value_column, value_name)
    if value_name == "percent_finer":
        if in_pan:
            raise ParameterError(
                f"{table.place(pan or rows[0])}: {in_pan:g} % finer than the pan, which holds all: leave it out"
            )
        finer = values
    elif value_name == "percent_cumulative_retained":
        finer = _from_cumulative(table, values, in_pan, notes)
    else:
        finer = _from_retained(table, value_name, sizes, values, in_pan, notes)
    places = tuple(table.place(row) for row in rows)
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
    where = f"{table.name} row {table.header.number}"
    if len(found_sizes) != 1:
        raise ParameterError(where + _wrong_header("size", [name for _, name, _ in found_sizes], SIZES, unused))
    if len(found_values) != 1:
        raise ParameterError(where + _wrong_header("value", [name for _, name in found_values], VALUES, unused))
    return (*found_sizes[0], *found_values[0], unused)


def _usual(name: str) -> str:
    """Bring "% passing", "Passing (%)" and "sieve opening (mm)" to the names that this module knows."""
    words = [word for word in re.split(r"[_()\[\]]+", name.replace("%", "_percent_")) if word]
    if "percent" in words:
        words = ["percent", *(word for word in words if word != "percent")]
    plain = "_".join(words)
    plain = re.sub(rf"^({SIZE_WORDS})_(?=[^_]+$)", "size_", plain)
    return ALIASES.get(plain, plain)


def _wrong_header(kind: str, found: list[str], known: tuple[str, ...], unused: list[str]) -> str:
    """Say what a header lacks or has too much of, with the nearest name that would do."""
    if found:
        return f": {' and '.join(found)} are both named; leave one {kind} column"
    if kind == "size" and "size" in (name.lower() for name in unused):
        return ": the size column has no unit; name it size_mm or size_um"
    near = [(name, difflib.get_close_matches(name.lower(), known, n=1, cutoff=0.5)) for name in unused]
    meant = next((f"; did you mean {match[0]} by '{name}'?" for name, match in near if match), "")
    return f": the header names no {kind} column; it must name one of {', '.join(known)}{meant}"


def _size(table: Table, row: Row, column: int, name: str) -> float:
    """One sieve opening, in the unit of its column (mm for phi and designations)."""
    if name == "sieve":
        try:
            return sieve_size(row.cells[column])
        except ParameterError as error:
            raise ParameterError(f"{table.place(row)}, column sieve: {error}") from None
    number = table.number(row, column)
    size = 2.0**-number if name == "phi" and abs(number) < 1000.0 else number
    if not (size > 0.0 and math.isfinite(size)) or (name == "phi" and abs(number) >= 1000.0):
        rule = "phi must be between -1000 and 1000" if name == "phi" else "a size must be greater than 0"
        raise ParameterError(f"{table.place(row)}, column {name}: the value is {number:g}; {rule}")
    return size


def _value(table: Table, row: Row, column: int, name: str) -> float:
    value = table.number(row, column)
    if value < 0.0 or (value > 100.0 and name != "mass_retained_g"):
        rule = "at least 0" if name == "mass_retained_g" else "between 0 and 100"
        raise ParameterError(f"{table.place(row)}, column {name}: the value is {value:g}; it must be {rule}")
    return value


def _from_cumulative(table: Table, values: list[float], in_pan: float | None, notes: list[str]) -> list[float]:
    whole = 100.0
    largest = max(values) if in_pan is None else in_pan
    if largest == 1.0:
        whole = 1.0
        notes.append("the values end at 1: read as fractions, not per cent")
    elif largest < 1.0:
        raise ParameterError(f"{table.name}: the largest percent_cumulative_retained is {largest:g}; give per cent")
    if in_pan is not None and in_pan != whole:
        raise ParameterError(f"{table.name}: {in_pan:g} % is retained down to the pan, which must hold all: 100 %")
    return [100.0 * ((whole - value) / whole) for value in values]


def _from_retained(
    table: Table, name: str, sizes: list[float], values: list[float], in_pan: float | None, notes: list[str]
) -> list[float]:
    """Per cent finer on each sieve, from the mass or share retained on each and in the pan."""
    total = math.fsum(values) + (in_pan or 0.0)
    if not total > 0.0:
        raise ParameterError(f"{table.name}: column {name} adds up to 0; some mass must be on the sieves")
    whole = total
    if name == "mass_retained_g":
        if in_pan is None:
            notes.append(f"{table.name} has no pan row: nothing taken as finer than the finest sieve")
    elif total <= 1.0 + ROUNDED / 100.0:
        if in_pan is None or abs(total - 1.0) > ROUNDED / 100.0:
            raise ParameterError(f"{table.name}: percent_retained adds up to {total:.6g}; give per cent, not fractions")
        notes.append("the values add up to 1: read as fractions, not per cent")
    elif total > 100.0 + ROUNDED or (in_pan is not None and total < 100.0 - ROUNDED):
        cumulative = " Cumulative values? name the column percent_cumulative_retained." if total > 100.0 else ""
        raise ParameterError(f"{table.name}: percent_retained adds up to {total:.6g} %, not 100 %.{cumulative}")
    elif in_pan is None and total < 100.0:
        whole = 100.0
        notes.append(
            f"{table.name} has no pan row: the missing {100.0 - total:.4g} % taken as finer than the finest sieve"
        )
    if name == "percent_retained" and abs(whole - 100.0) > 1e-9 and whole > 2.0:
        notes.append(f"percent_retained of {table.name} adds up to {total:.6g} %: scaled to 100 %")
    # from the fine end, so that what passes the finest sieve is exactly what is in the pan
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

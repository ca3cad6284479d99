"""Per cent finer than each sieve, from whatever a laboratory weighed, counted or added up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from comminute.gradings.faults import fault

ROUNDED = 0.5  # per cent by which a laboratory's rounded shares may miss 100
RESIDUE = 1e-9  # per cent by which a spreadsheet's sums may miss 0 and 100
FRACTIONS = (0.9, 1.1)  # a curve whose top lies between these is one of fractions
RETAINED = ("mass_retained_g", "percent_retained", "count", "retained")
WEIGHED = ("mass_retained_g", "mass_cumulative_retained", "mass_finer", "mass_cumulative")


@dataclass(frozen=True)
class Column:
    """Numbers of one column, sieves from coarse to fine.

    Attributes
    ----------
    file, header : str
        Names, for messages.
    name : str
        Quantity.
    size : tuple of float
    value : tuple of float
    pan, whole : float or None
        Content of the pan, and the total, where a row or an option says so.
    loss : float
        Mass lost in sieving.
    upper : bool
        Whether each value belongs to the class below its size rather than above it.
    pan_place : str
        Row of the pan, for messages.
    """

    file: str
    header: str
    name: str
    size: tuple[float, ...]
    value: tuple[float, ...]
    pan: float | None = None
    whole: float | None = None
    loss: float = 0.0
    upper: bool = False
    pan_place: str = ""


def clean(value: float, whole: float = 100.0) -> float:
    """Value without the residue of a spreadsheet's sums: 100.00000000000001 is 100, and -5e-15 is 0."""
    if abs(value - whole) <= RESIDUE * whole / 100.0:
        return whole
    return 0.0 if abs(value) <= RESIDUE * whole / 100.0 else value


def resolved(column: Column, notes: list[str]) -> Column:
    """Column whose quantity is said: one that is left open by its header is told by its numbers, where they can.

    Raises
    ------
    ParameterError
        For numbers that may be more than one quantity, or none.
    """
    name, of = column.name, f"column '{column.header}' of {column.file}"
    if name not in ("share", "cumulative", "mass_cumulative", "retained"):
        return column
    falls = all(b <= a + RESIDUE for a, b in pairwise(column.value))
    rises = all(b >= a - RESIDUE for a, b in pairwise(column.value))
    top, total = max(column.value), math.fsum(column.value) + (column.pan or 0.0)
    last = column.value[-1] if column.pan is None else column.pan
    near = [whole for whole in (1.0, 100.0) if abs(total - whole) <= whole * ROUNDED / 100.0]
    found = []
    if (
        falls
        and name != "retained"
        and (name == "mass_cumulative" or any(abs(top - w) <= 1e-3 * w for w in (1.0, 100.0)))
    ):
        found.append("mass_finer" if name == "mass_cumulative" else "percent_finer")
    if rises and (name in ("cumulative", "mass_cumulative") or any(abs(last - w) <= 1e-3 * w for w in (1.0, 100.0))):
        found.append("mass_cumulative_retained" if name == "mass_cumulative" else "percent_cumulative_retained")
    if name in ("share", "retained") and (near or (column.pan is None and name == "retained" and total < 100.0)):
        found.append("percent_retained")
    if name == "retained" and not near:
        found.append("mass_retained_g")
    if len(found) == 1:
        why = {
            "percent_finer": "its values never rise from coarse to fine and begin at 100 %",
            "percent_retained": "its values add up to 100 %",
            "mass_retained_g": "shares of what is on the sieves and in the pan",
        }.get(found[0], "its values never fall from coarse to fine")
        notes.append(f"{of} read as {found[0]}: {why}")
        return Column(**(vars(column) | {"name": found[0]}))
    what = f"its values may be {' or '.join(found)}" if found else "its values do not tell what they are"
    raise fault(
        "",
        f"{of}: the header names no quantity, and {what}",
        "name it percent_finer, percent_retained, percent_cumulative_retained or mass_retained_g",
    )


def per_cent_finer(column: Column, notes: list[str]) -> list[float]:
    """Per cent finer than each sieve of a column.

    Raises
    ------
    ParameterError
        For values that do not add up.
    """
    if column.name == "percent_finer":
        if clean(column.pan or 0.0):
            said = f"{column.pan:.4g} % is finer than the pan"
            raise fault(column.pan_place, said, "the pan holds all", remedy="leave_out")
        return list(column.value)
    if column.name == "mass_finer":
        return _from_mass_finer(column, notes)
    if column.name == "percent_cumulative_retained":
        return _from_cumulative(column, notes)
    if column.name == "mass_cumulative_retained":
        return _from_cumulative_mass(column)
    return _from_retained(column, notes)


def as_per_cent(values: list[float]) -> list[float]:
    """Values of a curve in per cent where they are fractions."""
    top = max(values)
    return [100.0 * value for value in values] if FRACTIONS[0] <= top <= FRACTIONS[1] else list(values)


def _from_mass_finer(column: Column, notes: list[str]) -> list[float]:
    whole = column.whole
    if whole is None:
        whole = max(column.value)
        notes.append(f"{whole:.4g} g, the largest mass finer in {column.file}, taken as all of it")
    if not whole > 0.0 or max(column.value) > whole * (1.0 + 1e-9):
        raise fault(
            "",
            f"{column.file}: {max(column.value):.4g} g are finer than a sieve, of {whole:.4g} g in all",
            "the whole cannot be less than a part",
        )
    return [clean(100.0 * (value / whole)) for value in column.value]


def _from_cumulative(column: Column, notes: list[str]) -> list[float]:
    largest = max(column.value) if column.pan is None else column.pan
    whole = 100.0
    if FRACTIONS[0] <= largest <= FRACTIONS[1] and max(column.value) <= FRACTIONS[1]:
        if column.pan is None and clean(largest, 1.0) != 1.0:
            raise fault(
                "", f"{column.file}: the largest {column.name} is {largest:.4g}", "are these fractions? give per cent"
            )
        whole = 1.0
        notes.append("the values end at 1: read as fractions, not per cent")
    elif largest < 1.0:
        raise fault("", f"{column.file}: the largest {column.name} is {largest:.4g}", "give per cent")
    if column.pan is not None:
        if abs(column.pan - whole) > whole * ROUNDED / 100.0:
            raise fault(column.file, f"{column.pan:.4g} % is retained down to the pan", "it must hold all: 100 %")
        if clean(column.pan, whole) != whole:
            notes.append(f"{column.name} of {column.file} ends at {column.pan:.4g}: scaled to {whole:.4g}")
            whole = column.pan
    if max(column.value) > whole * (1.0 + 1e-9):
        raise fault("", f"{column.file}: {max(column.value):.4g} is retained, more than the whole, {whole:.4g}")
    return [clean(100.0 * ((whole - value) / whole)) for value in column.value]


def _from_cumulative_mass(column: Column) -> list[float]:
    whole = column.pan if column.whole is None else column.whole
    if whole is None:
        raise fault(
            "",
            f"{column.file}: column '{column.header}' says what stays down to each sieve, but not what there is in all",
            "add a pan row, or give total_mass_g",
        )
    if not whole > 0.0 or max(column.value) > whole * (1.0 + 1e-9):
        raise fault(
            "",
            f"{column.file}: {max(column.value):.4g} g are retained, of {whole:.4g} g in all",
            "the whole cannot be less",
        )
    return [clean(100.0 * ((whole - value) / whole)) for value in column.value]


def _from_retained(column: Column, notes: list[str]) -> list[float]:
    """Per cent finer from what stays on each sieve and in the pan."""
    name, file = column.name, column.file
    total = math.fsum(column.value) + (column.pan or 0.0)
    if not total > 0.0:
        raise fault("", f"{file}: column {column.header} adds up to 0", "some mass must be on the sieves")
    whole = total
    if name in ("mass_retained_g", "count"):
        whole = _whole_mass(column, total, notes)
    elif total <= 1.0 + ROUNDED / 100.0:
        if column.pan is None or abs(total + column.loss - 1.0) > ROUNDED / 100.0:
            raise fault("", f"{file}: {name} adds up to {total:.4g}", "give per cent, not fractions")
        notes.append("the values add up to 1: read as fractions, not per cent")
    elif total > 100.0 + ROUNDED or (column.pan is not None and total + column.loss < 100.0 - ROUNDED):
        remedy = "name_cumulative_column" if total > 100.0 else ""
        said = f"column {column.header} adds up to {total:.4g} %"
        raise fault(file, said, "it must be 100 %", remedy=remedy)
    elif column.pan is None and total < 100.0 - RESIDUE and not column.upper:
        whole = 100.0
        missing = 100.0 - total
        notes.append(f"{file} has no pan row: the missing {missing:.4g} % taken as finer than the finest sieve")
    if column.loss:
        notes.append(f"{column.loss:.4g} lost from {file}: shares are of what is on the sieves and in the pan")
    if name == "percent_retained" and abs(whole - 100.0) > RESIDUE and whole > 2.0:
        notes.append(f"{name} of {file} adds up to {total:.6g} %: scaled to 100 %")
    rest = max(whole - math.fsum(column.value), 0.0) if column.pan is None or whole != total else column.pan
    return _summed(column, rest, whole)


def _whole_mass(column: Column, total: float, notes: list[str]) -> float:
    """Mass of the sample: what is on the sieves and in the pan, or what it was before washing."""
    if column.whole is not None:
        if column.whole < total * (1.0 - 1e-9):
            raise fault(
                "",
                f"total_mass_g is {column.whole:.4g}, less than the {total:.4g} g on the sieves and in the pan of "
                f"{column.file}",
                "it is the dry mass before washing",
                parameter="total_mass_g",
            )
        washed = max(column.whole - total - column.loss, 0.0)
        notes.append(f"{washed:.4g} g of {column.whole:.4g} g washed out of {column.file}: finer than the finest sieve")
        return max(column.whole - column.loss, total)
    if column.pan is None and not column.upper:
        notes.append(f"{column.file} has no pan row: nothing taken as finer than the finest sieve")
    return total


def _summed(column: Column, rest: float, whole: float) -> list[float]:
    """Per cent finer, added up from the fine end: what passes the finest sieve is exactly what is in the pan."""
    finer = [0.0] * len(column.value)
    passed: list[float] = []
    for q in reversed(range(len(column.value))):
        if column.upper:
            passed.append(column.value[q])
        finer[q] = clean(100.0 * min(math.fsum([rest, *passed]) / whole, 1.0))
        if not column.upper:
            passed.append(column.value[q])
    # all of it passes the sieves above the coarsest on which anything stays, whatever the rounding
    for q, value in enumerate(column.value):
        if value != 0.0 and not column.upper:
            break
        finer[q] = 100.0
        if column.upper:
            break
    return finer

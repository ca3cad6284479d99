"""Which indices of a curve rest on sizes that nobody measured: its tail below the finest sieve, or an extended top."""

from __future__ import annotations

import math
from typing import Any

from comminute.gradings.breakage import HARDIN_SILT
from comminute.gradings.curves import SizeCurve
from comminute.gradings.sieves import convert, unit_of

SIGNS = {"extrapolated": "*", "extended": "^"}
PARTS = {"phi50": (50,), "Cu": (10, 60), "Cc": (10, 30, 60)}
FOLK_WARD = (5, 16, 50, 84, 95)
MATTERS = 1e-3  # share of the mass in the tail from which on an integral over all sizes rests on it


def marks_of(found: dict[str, Any], curve: SizeCurve, silt: float, measured_top: float | None) -> dict[str, list[str]]:
    """Names of the indices that rest on the tail ("extrapolated") or on an extended top ("extended").

    Parameters
    ----------
    found : dict
        Indices by name; None for one without a value.
    curve : SizeCurve
    silt : float
        Size [mm] whose share of fines is among the indices.
    measured_top : float or None
        Coarsest sieve of a curve that was carried on beyond it.
    """
    low = float(curve.size[0]) if curve.finer[0] > 0.0 else 0.0
    high = math.inf if measured_top is None else measured_top
    marks: dict[str, list[str]] = {name: [] for name in SIGNS}
    for name, value in found.items():
        if not isinstance(value, float):
            continue
        percents = _percents(name)
        if percents:
            sizes = [curve.percentile(percent, extrapolate=True) for percent in percents]
            tail, extended = min(sizes) < low * (1.0 - 1e-12), max(sizes) > high * (1.0 + 1e-12)
        else:
            tail = low > 0.0 and _reaches_tail(name, curve, silt)
            extended = measured_top is not None and not name.startswith("finer than")
        if tail:
            marks["extrapolated"].append(name)
        if extended:
            marks["extended"].append(name)
    return {kind: names for kind, names in marks.items() if names}


def _percents(name: str) -> tuple[int, ...]:
    """Percentiles from which an index is made; none for an integral over all sizes."""
    if name.startswith("Folk-Ward"):
        return FOLK_WARD
    return PARTS.get(name, (int(name[1:]),) if name[1:].isdecimal() and name.startswith("D") else ())


def _reaches_tail(name: str, curve: SizeCurve, silt: float) -> bool:
    """Tell whether an integral over sizes rests on the tail of a curve that has one."""
    finest = convert(float(curve.size[0]), curve.unit, "mm") if unit_of(curve.unit) else 0.0
    if name.startswith("finer than"):
        return finest > silt
    if name.startswith("Hardin"):
        return finest > HARDIN_SILT and float(curve.finer[0]) > MATTERS
    return name in ("Einav B", "void ratio") and float(curve.finer[0]) > MATTERS


def footnotes(rows: list[dict[str, Any]]) -> list[str]:
    """Say what the signs behind numbers mean, for those that stand there."""
    there = {kind for row in rows for kind in row["marks"]}
    words = {
        "extrapolated": "rests on the tail below the finest size, which is not measured",
        "extended": "rests on the curve carried on beyond the coarsest sieve, which is not measured",
    }
    return [f"{SIGNS[kind]}: {words[kind]}" for kind in SIGNS if kind in there]


def cell_of(row: dict[str, Any], name: str) -> str:
    """Text of one index of a grading, with the signs of what it rests on."""
    if row.get(name) is None:
        return "-"
    return f"{row[name]:.4g}" + "".join(SIGNS[kind] for kind, names in row["marks"].items() if name in names)

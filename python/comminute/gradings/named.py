"""Indices of gradings by their names, as plots, tables and reports ask for them."""

from __future__ import annotations

from collections.abc import Callable

from comminute.gradings import breakage, indices
from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error

ALIASES = {"breakage": "B", "relative_breakage": "Br", "uniformity": "Cu", "curvature": "Cc"}
LABELS = {
    "Cu": "Cu = D60 / D10",
    "Cc": "Cc = D30² / (D10 D60)",
    "B": "breakage index B (Einav)",
    "Br": "relative breakage (Hardin)",
}


def percent_of(name: str) -> float | None:
    """Per cent of a size such as "D50" or "d50"; None for a name of another form."""
    digits = name[1:].replace(".", "", 1)
    return float(name[1:]) if name[:1] in ("D", "d") and digits.isdecimal() else None


def named_index(name: str, start: SizeCurve) -> Callable[[SizeCurve], float]:
    """Give the function of a curve that an index is; those of breakage compare with the start.

    Parameters
    ----------
    name : str
        A size such as "D50", "Cu" or "uniformity", "Cc" or "curvature", "B" or "breakage" (Einav), "Br" or
        "relative_breakage" (Hardin).
    start : SizeCurve

    Raises
    ------
    ParameterError
        For a name it does not know.
    """
    known: dict[str, Callable[[SizeCurve], float]] = {
        "Cu": indices.uniformity,
        "Cc": indices.curvature,
        "B": lambda curve: breakage.breakage_index(start, curve).index,
        "Br": lambda curve: breakage.relative_breakage(start, curve),
    }
    if (short := ALIASES.get(name, name)) in known:
        return known[short]
    percent = percent_of(name)
    if percent is not None and percent <= 100.0:
        return lambda curve: curve.percentile(percent)
    rule = f"it must be a size such as D50, or one of {', '.join(known)}, crushes, fines"
    raise parameter_error("index", f"'{name}'", rule)

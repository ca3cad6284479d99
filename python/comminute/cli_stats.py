"""Indices of a file's gradings, as records and as text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from comminute._core import Grading, ParameterError
from comminute.breakage import breakage_index, breakage_potential, relative_breakage
from comminute.curves import SizeCurve
from comminute.indices import curvature, fines_share, folk_ward, phi, uniformity
from comminute.sieves import convert, unit_of
from comminute.storage import open_result

SILT = 0.063  # mm, ISO 14688


def stats_of(file: Path, *, number: bool = False, top: str = "error") -> dict[str, Any]:
    """Compute the indices of a sieve table, or of the start and every load of a result file.

    Returns
    -------
    dict
        `unit`, `notes`, and `gradings`: one record each, in which None stands for what cannot be said, with the
        reason under `because`.
    """
    if file.suffix == ".nc":
        result = open_result(file)
        start = result.start_curve
        rows = [{"of": "start"} | indices_of(start)]
        for k, ratio in enumerate(result.stress_ratio):
            curve = result.curve(k)
            rows.append({"of": f"stress ratio {ratio:.4g}"} | indices_of(curve) | _breakage(start, curve))
        return {"file": str(file), "unit": result.unit, "notes": list(result.notes), "gradings": rows}
    grading = Grading.read(file, number=number, top=top)  # type: ignore[arg-type]
    rows = [{"of": file.name} | indices_of(SizeCurve.of(grading))]
    return {"file": str(file), "unit": grading.unit, "notes": list(grading.notes), "gradings": rows}


def indices_of(curve: SizeCurve) -> dict[str, Any]:
    """Every index of one curve."""
    found: dict[str, Any] = {"because": {}}

    def add(name: str, make: Callable[[], float]) -> None:
        try:
            found[name] = make()
        except ParameterError as error:
            found[name] = None
            found["because"][name] = str(error)

    for percent in (5, 10, 16, 30, 50, 60, 80, 84, 95):
        add(f"D{percent}", lambda percent=percent: curve.percentile(percent))  # type: ignore[misc]
    add("phi50", lambda: float(phi(curve.percentile(50), curve.unit)))
    add("Cu", lambda: uniformity(curve))
    add("Cc", lambda: curvature(curve))
    for name in ("mean", "sorting", "skewness", "kurtosis"):
        add(f"Folk-Ward {name}", lambda name=name: getattr(folk_ward(curve), name))  # type: ignore[misc]
    add("Hardin Bp", lambda: breakage_potential(curve))
    if unit_of(curve.unit):
        add("finer than 0.063 mm", lambda: fines_share(curve, convert(SILT, "mm", curve.unit)))
    return found


def _breakage(start: SizeCurve, curve: SizeCurve) -> dict[str, Any]:
    found: dict[str, Any] = {"Hardin Br": None, "Einav B": None}
    try:
        breakage = breakage_index(start, curve)
        found["Einav B"] = breakage.index
        found["Einav d_m"], found["Einav d_M"] = breakage.smallest, breakage.largest
        found["Hardin Br"] = relative_breakage(start, curve)
    except ParameterError:
        pass  # the start says why, under `because`
    return found


def as_text(found: dict[str, Any]) -> str:
    """Write a line per index, a column per grading."""
    rows = found["gradings"]
    names = [name for name in rows[-1] if name not in ("of", "because")]
    unit = f", sizes in {found['unit']}" if found["unit"] else ""
    width = max(12, *(len(row["of"]) + 2 for row in rows))
    lines = [found["file"] + unit, " " * 20 + "".join(f"{row['of']:>{width}}" for row in rows)]
    for name in names:
        cells = ["-" if row.get(name) is None else f"{row[name]:.4g}" for row in rows]
        lines.append(f"{name:20}" + "".join(f"{cell:>{width}}" for cell in cells))
    lines += [f"note: {note}" for note in found["notes"]]
    reasons = {reason for row in rows for reason in row["because"].values()}
    return "\n".join(lines + [f"-: {reason}" for reason in sorted(reasons)])

"""Indices of a file's gradings, as records and as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from comminute._core import Grading, ParameterError
from comminute.cli.marks import cell_of, footnotes, marks_of
from comminute.cli.messages import WORDS
from comminute.gradings.breakage import breakage_index, breakage_potential, relative_breakage
from comminute.gradings.curves import SizeCurve
from comminute.gradings.indices import curvature, fines_share, folk_ward, phi, uniformity
from comminute.gradings.options import Reading
from comminute.gradings.reading import SIEVES, Top, read_sieves
from comminute.gradings.sieves import convert, unit_of
from comminute.opening import open_result
from comminute.packing.models import PACKING, calibrate, void_ratio
from comminute.runs.remarks import load_labels
from comminute.util.errors import parameter_error, reworded

SILT = 0.063  # mm, ISO 14688


PERCENTS = (5, 10, 16, 30, 50, 60, 80, 84, 95)


def stats_of(
    file: Path,
    *,
    extrapolate: bool = False,
    percents: Sequence[float] = PERCENTS,
    initial_void_ratio: float | None = None,
    **table: Any,
) -> dict[str, Any]:
    """Compute the indices of a sieve table, or of the start and every load of a result file.

    Parameters
    ----------
    file : Path
    extrapolate : bool
        Follow tails below the finest size.
    percents : sequence of float
        Per cent of the mass of the sizes D_x.
    initial_void_ratio : float, optional
        Measured void ratio of the grading, or of the start of a result, to which the packing model is calibrated.
    **table
        Options of `Grading.read`, which a result has no use for.

    Returns
    -------
    dict
        `unit`, `notes`, and `gradings`: one record each, in which None stands for an index without a value, with the
        error under `because`, and `marks` names those that rest on sizes that were not measured; `of` names the
        grading in the words of the record's `quantity`.
    """
    if file.suffix == ".nc":
        require_no_options(file, table)
        result = open_result(file)
        start = result.start_curve
        beta = _packing(start, initial_void_ratio)
        quantity, names = load_labels(result)
        rows = [{"of": "start"} | indices_of(start, extrapolate=extrapolate, percents=percents, packing=beta)]
        for k, name in enumerate(names):
            curve = result.curve(k)
            loads = {"stress_ratio": float(result.stress_ratio[k])}
            loads |= {} if result.stress is None else {"stress": float(result.stress[k])}
            found = indices_of(curve, extrapolate=extrapolate, percents=percents, packing=beta)
            found |= _breakage(start, curve)
            found["marks"] = marks_of(found, curve, SILT, None)
            rows.append({"of": name} | loads | found)
        unit, notes = result.unit, result.notes
    else:
        grading, measured_top = read_sieve_table(file, **table)
        curve = SizeCurve.of(grading)
        beta = _packing(curve, initial_void_ratio)
        found = indices_of(curve, extrapolate=extrapolate, percents=percents, packing=beta)
        found["marks"] = marks_of(found, curve, SILT, measured_top)
        rows = [{"of": file.name} | found]
        quantity, unit, notes = "", grading.unit, grading.notes
    origin = "a mere default; --void-ratio calibrates it" if initial_void_ratio is None else "calibrated"
    packed = f"void ratio: mixed, by the compressible packing model at K = 9, virtual packing {beta:.4g} ({origin})"
    return {"file": str(file), "unit": unit, "quantity": quantity, "notes": [*notes, packed], "gradings": rows}


def _packing(start: SizeCurve, initial_void_ratio: float | None) -> float:
    """Packing of single sizes: calibrated to a measured void ratio, where there is one."""
    return PACKING if initial_void_ratio is None else calibrate(start, initial_void_ratio)


def read_sieve_table(
    file: Path, *, number: bool = SIEVES["number"], top: Top = SIEVES["top"], **options: Any
) -> tuple[Grading, float | None]:
    """Grading of a sieve table, and its coarsest sieve where the curve is carried on beyond it.

    Errors name the options of the command line.
    """
    try:
        data = read_sieves(file, number=number, how=Reading(**options))
        grading = data.grading(top=top, number=number)
    except ParameterError as error:
        raise reworded(error, words=WORDS) from None
    coarsest = max(data.size)
    return grading, coarsest if grading.largest > coarsest * (1.0 + 1e-12) else None


def require_no_options(file: Path, table: dict[str, Any]) -> None:
    """Refuse options of sieve tables for a result, which would ignore them."""
    for name, value in table.items():
        if value is not None and value != SIEVES.get(name):
            option = f"--{name.replace('_', '-')}"
            rule = "it is an option of sieve tables; leave it out"
            raise parameter_error(option, value, rule, finding=f"is given, but {file.name} is a result")


def indices_of(
    curve: SizeCurve,
    *,
    extrapolate: bool = False,
    percents: Sequence[float] = PERCENTS,
    packing: float = PACKING,
) -> dict[str, Any]:
    """Every index of one curve; `extrapolate` follows its tail below the finest size.

    Returns
    -------
    dict
        A number by name, or None with the error under `because`; the curve itself under `curve`.
    """
    found: dict[str, Any] = {"because": {}, "marks": {}, "curve": curve}

    def add(name: str, make: Callable[[], float]) -> None:
        try:
            found[name] = make()
        except ParameterError as error:
            found[name] = None
            found["because"][name] = reworded(error, words=WORDS)

    for percent in percents:
        add(f"D{percent:g}", lambda percent=percent: curve.percentile(percent, extrapolate=extrapolate))  # type: ignore[misc]
    add("phi50", lambda: float(phi(curve.percentile(50, extrapolate=extrapolate), curve.unit)))
    add("Cu", lambda: uniformity(curve, extrapolate=extrapolate))
    add("Cc", lambda: curvature(curve, extrapolate=extrapolate))
    for name in ("mean", "sorting", "skewness", "kurtosis"):
        add(f"Folk-Ward {name}", lambda name=name: getattr(folk_ward(curve, extrapolate=extrapolate), name))  # type: ignore[misc]
    add("Hardin Bp", lambda: breakage_potential(curve))
    if unit_of(curve.unit):
        add("finer than 0.063 mm", lambda: fines_share(curve, convert(SILT, "mm", curve.unit)))
    add("void ratio", lambda: void_ratio(curve, packing=packing))
    found["marks"] = marks_of(found, curve, SILT, None)
    return found


def _breakage(start: SizeCurve, curve: SizeCurve) -> dict[str, Any]:
    found: dict[str, Any] = {"Hardin Br": None, "Einav B": None}
    try:
        breakage = breakage_index(start, curve)
        found["Einav B"] = breakage.index
        found["Einav d_m"], found["Einav d_M"] = breakage.smallest, breakage.largest
        found["Hardin Br"] = relative_breakage(start, curve)
    except ParameterError:
        pass  # the start has the reason under `because`
    return found


def as_text(found: dict[str, Any]) -> str:
    """Write a line per index, a column per grading."""
    rows = found["gradings"]
    names = [name for name in rows[-1] if name not in ("of", "stress", "stress_ratio", "because", "marks", "curve")]
    unit = f", sizes in {found['unit']}" if found["unit"] else ""
    width = max(11, *(len(row["of"]) + 2 for row in rows))
    lines = [found["file"] + unit, f"{found['quantity']:20}" + "".join(f"{row['of']:>{width}}" for row in rows)]
    for name in names:
        cells = [cell_of(row, name) for row in rows]
        lines.append(f"{name:20}" + "".join(f"{cell:>{width}}" for cell in cells))
    lines += [*footnotes(rows), *(f"note: {note}" for note in found["notes"])]
    return "\n".join(lines + [f"-: {reason}" for reason in _reasons(rows)])


def as_json(found: dict[str, Any]) -> dict[str, Any]:
    """Give the same as plain values, the reasons as text."""
    rows = []
    for row in found["gradings"]:
        plain = {name: value for name, value in row.items() if name != "curve"}
        rows.append(plain | {"because": {name: str(error) for name, error in row["because"].items()}})
    return found | {"gradings": rows}


def _reasons(rows: list[dict[str, Any]]) -> list[str]:
    """List the reasons for missing indices, each once; percentiles below the finest size share a line."""
    errors = [error for row in rows for error in row["because"].values()]
    others = sorted({str(error) for error in errors if error.remedy != "extrapolate"})
    below = {error.number for error in errors if error.remedy == "extrapolate"}
    if not below:
        return others
    names = ", ".join(f"D{percent:g}" for percent in sorted(below))
    curve = next(row["curve"] for row in rows if any(e.remedy == "extrapolate" for e in row["because"].values()))
    share = f", which {100 * curve.finer[0]:.4g} % are finer than" if len(rows) == 1 else ""
    verb = "lies" if len(below) == 1 else "lie"
    return [f"{names} {verb} below {curve.finest()}{share}; {WORDS['extrapolate']}", *others]

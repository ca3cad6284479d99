"""The command `fit`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from comminute._core import Grading, Material, WeibullFragments, __version__
from comminute.cli.measured import measured_of, one_unit
from comminute.cli.stats import read_sieve_table
from comminute.fitting.fit import fit
from comminute.fitting.outcome import FitResult
from comminute.fitting.parameters import FRAGMENTS, OF_MATERIAL
from comminute.util.errors import parameter_error

SETTABLE = (*OF_MATERIAL, *FRAGMENTS)


def fitted(
    files: list[str],
    *,
    start: Path | None,
    free: list[str],
    fixed: list[str],
    reference_size: float | None,
    table: dict[str, Any],
    **options: Any,
) -> tuple[FitResult, str]:
    """Fit the gradings of files; the result, and the unit of the stresses.

    Parameters
    ----------
    files : list of str
        Measured gradings with their stresses; see `measured_of`. One under stress 0 is the start.
    start : Path, optional
        Sieve table of the start, where no file has stress 0.
    free : list of str
        Free parameters.
    fixed : list of str
        Values of others, "fabric_width=0.3".
    reference_size : float, optional
        Left out, the largest grain of the start.
    table : dict
        Options of sieve tables.
    **options
        Of `fit`.

    Raises
    ------
    ParameterError
        For files, stresses or names that it cannot use.
    """
    others = [text for text in files if start is None or Path(text) != start]
    measured = [measured_of(text, table) for text in others]
    starts: list[Grading] = [one.grading for one in measured if one.stress == 0.0]
    if start is not None:
        starts.append(read_sieve_table(start, **table)[0])
    if len(starts) != 1:
        rule = "name one, by --start FILE or as FILE@0"
        raise parameter_error("--start", len(starts), rule, finding=f"is wanted once: {len(starts)} starts are named")
    crushed = [one for one in measured if one.stress > 0.0]
    unit = one_unit(crushed)
    values = _values(fixed, free)
    material = Material(
        reference_size=reference_size if reference_size is not None else starts[0].largest,
        fragments=WeibullFragments(
            **{FRAGMENTS[name]: values.pop(name) for name in tuple(values) if name in FRAGMENTS}
        ),
        **values,  # type: ignore[arg-type]  # names of numbers, as `_values` requires
    )
    return fit([(one.stress, one.grading) for one in crushed], starts[0], material, free, **options), unit


def _values(fixed: list[str], free: list[str]) -> dict[str, float]:
    """Values by name of "name=value"."""
    values = {}
    for text in fixed:
        name, equals, number = text.partition("=")
        try:
            values[name] = float(number)
        except ValueError:
            equals = ""
        if not equals or name not in SETTABLE:
            rule = f"it must be NAME=NUMBER, with one of {', '.join(SETTABLE)}"
            raise parameter_error("--fix", f"'{text}'", rule)
        if name in free:
            raise parameter_error(
                "--fix", f"'{text}'", "take it out of one of the two", finding=f"fixes {name}, which is free"
            )
    return values


def record(found: FitResult, unit: str) -> dict[str, Any]:
    """Give the numbers of the fit, for JSON."""
    closure = None if found.closure == "lattice" else found.closure_error._asdict()
    return {"version": __version__, "stress_unit": unit} | found.to_dict() | {"closure_error": closure}

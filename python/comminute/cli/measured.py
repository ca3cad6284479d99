"""Measured gradings named on the command line, with the sample and the stress of each: FILE[#SAMPLE][@STRESS]."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

from comminute._core import Grading
from comminute.cli.stats import read_sieve_table
from comminute.util.errors import parameter_error

UNITS = ("Pa", "kPa", "MPa", "GPa", "bar", "psi")
NUMBER = r"(?P<number>\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)"
AT = re.compile(rf"^{NUMBER}\s*(?P<unit>[A-Za-z]*)$")
IN_NAME = re.compile(rf"(?<![\d.]){NUMBER}[ _-]?(?P<unit>{'|'.join(UNITS)})(?![A-Za-z])")


class Measured(NamedTuple):
    """A grading under a stress.

    Attributes
    ----------
    file : Path
    stress : float
        0 for a start.
    unit : str
        Unit of the stress, as written; empty where there is none.
    grading : Grading
    """

    file: Path
    stress: float
    unit: str
    grading: Grading


def measured_of(text: str, table: dict[str, Any]) -> Measured:
    """Read one such argument.

    Parameters
    ----------
    text : str
        "after.csv@12MPa", "tests.xlsx#B3@12", or "sand-12MPa.csv", whose name has the stress.
    table : dict
        Options of sieve tables.

    Raises
    ------
    ParameterError
        For a stress that is missing or none, and for what the table says.
    """
    name, at, stress_text = text.rpartition("@") if "@" in text and not Path(text).exists() else (text, "", "")
    name, _, sample = name.partition("#") if not Path(name).exists() else (name, "", "")
    if at:
        found = AT.match(stress_text.strip())
        if found is None or (found["unit"] and found["unit"] not in UNITS):
            rule = f"it must be a number, with one of {', '.join(UNITS)} or none, as in {name}@12MPa"
            raise parameter_error("the stress", f"'{stress_text}'", rule, finding=f"of {name} is '{stress_text}'")
    else:
        in_name = list(IN_NAME.finditer(Path(name).stem))
        if len(in_name) != 1:
            rule = f"write it behind the file, {name}@12MPa, or into its name, as in sand-12MPa.csv"
            raise parameter_error("the stress", "", rule, finding=f"of {name} is not known")
        found = in_name[0]
    options = table | ({"sample": sample} if sample else {})
    grading, _ = read_sieve_table(Path(name), **options)
    return Measured(Path(name), float(found["number"]), found["unit"], grading)


def one_unit(measured: list[Measured]) -> str:
    """Give the unit of all stresses.

    Raises
    ------
    ParameterError
        For units that differ.
    """
    units = sorted({one.unit for one in measured})
    if len(units) > 1:
        found = ", ".join(unit or "none" for unit in units)
        raise parameter_error("the stresses", found, "write them in one", finding=f"have different units: {found}")
    return units[0] if units else ""

"""Sieve series by name, sieves by their designation, and units of length."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    import numpy.typing as npt

IN_MM = {"nm": 1e-6, "um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1e3, "in": 25.4}
PER_MM = {"nm": 1e6, "um": 1e3}  # dividing by these rounds once: 300 um is 0.3 mm, not 0.30000000000000004
SPELLINGS = {"µm": "um", "μm": "um", "micron": "um", "microns": "um", "inch": "in", '"': "in"}

# ISO 565, ISO 3310-1: openings in mm.
_R20_3 = [125, 90, 63, 45, 31.5, 22.4, 16, 11.2, 8, 5.6, 4, 2.8, 2, 1.4, 1]
_R20_3 += [0.71, 0.5, 0.355, 0.25, 0.18, 0.125, 0.09, 0.063, 0.045]
_R40_3 = [125, 106, 90, 75, 63, 53, 45, 37.5, 31.5, 26.5, 22.4, 19, 16, 13.2, 11.2, 9.5, 8, 6.7, 5.6, 4.75, 4]
_R40_3 += [3.35, 2.8, 2.36, 2, 1.7, 1.4, 1.18, 1, 0.85, 0.71, 0.6, 0.5, 0.425, 0.355, 0.3, 0.25, 0.212, 0.18]
_R40_3 += [0.15, 0.125, 0.106, 0.09, 0.075, 0.063, 0.053, 0.045, 0.038]

# ASTM E11: alternative designation (inches as written on the sieve, then numbers) to opening in mm.
ASTM_INCHES: dict[str, float] = {
    "5": 125,
    "4.24": 106,
    "4": 100,
    "3-1/2": 90,
    "3": 75,
    "2-1/2": 63,
    "2.12": 53,
    "2": 50,
    "1-3/4": 45,
}
ASTM_INCHES |= {"1-1/2": 37.5, "1-1/4": 31.5, "1.06": 26.5, "1": 25, "7/8": 22.4, "3/4": 19, "5/8": 16, "0.530": 13.2}
ASTM_INCHES |= {"1/2": 12.5, "7/16": 11.2, "3/8": 9.5, "5/16": 8, "0.265": 6.7, "1/4": 6.3}
ASTM_NUMBERS: dict[float, float] = {
    3.5: 5.6,
    4: 4.75,
    5: 4,
    6: 3.35,
    7: 2.8,
    8: 2.36,
    10: 2,
    12: 1.7,
    14: 1.4,
    16: 1.18,
    18: 1,
}
ASTM_NUMBERS |= {20: 0.85, 25: 0.71, 30: 0.6, 35: 0.5, 40: 0.425, 45: 0.355, 50: 0.3, 60: 0.25, 70: 0.212, 80: 0.18}
ASTM_NUMBERS |= {100: 0.15, 120: 0.125, 140: 0.106, 170: 0.09, 200: 0.075, 230: 0.063, 270: 0.053, 325: 0.045}
ASTM_NUMBERS |= {400: 0.038, 450: 0.032, 500: 0.025, 635: 0.02}

# Tyler's numbers, with the openings that the series has had since it was brought to those of ISO 565.
TYLER_NUMBERS: dict[float, float] = {2.5: 8, 3: 6.7, 3.5: 5.6, 4: 4.75, 5: 4, 6: 3.35, 7: 2.8, 8: 2.36, 9: 2, 10: 1.7}
TYLER_NUMBERS |= {12: 1.4, 14: 1.18, 16: 1, 20: 0.85, 24: 0.71, 28: 0.6, 32: 0.5, 35: 0.425, 42: 0.355, 48: 0.3}
TYLER_NUMBERS |= {60: 0.25, 65: 0.212, 80: 0.18, 100: 0.15, 115: 0.125, 150: 0.106, 170: 0.09, 200: 0.075, 250: 0.063}
TYLER_NUMBERS |= {270: 0.053, 325: 0.045, 400: 0.038, 450: 0.032, 500: 0.025, 635: 0.02}

SIEVE_SERIES = {
    "ISO R20/3": tuple(float(size) for size in _R20_3),
    "ISO R40/3": tuple(float(size) for size in _R40_3),
    "ASTM E11": tuple(float(size) for size in (*ASTM_INCHES.values(), *ASTM_NUMBERS.values())),
}


def unit_of(text: str) -> str:
    """Name of a unit of length in this library, "um" for "µm"; empty for a unit that it does not know."""
    word = text.strip()
    word = SPELLINGS.get(word, word)
    return word if word in IN_MM else SPELLINGS.get(word.lower(), "")


def convert(value: float, unit: str, to: str) -> float:
    """Convert a length to another unit, with as few roundings as possible.

    Parameters
    ----------
    value : float
    unit, to : str
        Units before and after: "nm", "um", "mm", "cm", "m" or "in".

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        For a unit that is not known, and for sizes without a unit, which cannot be converted.

    Examples
    --------
    >>> from comminute.gradings.sieves import convert
    >>> convert(300.0, "um", "mm"), convert(0.5, "in", "mm")
    (0.3, 12.7)
    """
    for name in (unit, to):
        if not unit_of(name):
            raise parameter_error("unit", f"'{name}'", f"it must be one of {', '.join(IN_MM)} to be converted")
    unit, to = unit_of(unit), unit_of(to)
    if unit == to:
        return value
    in_mm = value / PER_MM[unit] if unit in PER_MM else value * IN_MM[unit]
    return in_mm * PER_MM[to] if to in PER_MM else in_mm / IN_MM[to]


def millimetres(unit: str, wanted_for: str) -> float:
    """Millimetres in a unit; `wanted_for` names, for an error message, the quantity that needs it."""
    if not unit_of(unit):
        rule = f"{wanted_for} needs sizes in a known unit ({', '.join(IN_MM)})"
        raise parameter_error("unit", f"'{unit}'", rule, remedy="name_unit")
    return convert(1.0, unit, "mm")


def sieve_sizes(series: str, unit: str = "mm") -> npt.NDArray[np.float64]:
    """List the openings of a sieve series, coarse to fine.

    Parameters
    ----------
    series : {"ISO R20/3", "ISO R40/3", "ASTM E11"}
        Name of the series; capitals, blanks and dashes do not matter.
    unit : str
        Unit of the openings.

    Returns
    -------
    ndarray

    Raises
    ------
    ParameterError
        For a series or unit that is not known.

    Notes
    -----
    ISO 565 and ISO 3310-1 (principal sizes R20/3 and R40/3), ASTM E11.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.sieve_sizes("ISO R20/3")[-3:]
    array([0.09 , 0.063, 0.045])
    """
    plain = {_plain(name): name for name in SIEVE_SERIES} | {"r20/3": "ISO R20/3", "r40/3": "ISO R40/3"}
    plain |= {"iso565r20/3": "ISO R20/3", "iso565r40/3": "ISO R40/3", "astm": "ASTM E11", "e11": "ASTM E11"}
    if _plain(series) not in plain:
        known = ", ".join(f"'{name}'" for name in SIEVE_SERIES)
        raise parameter_error("series", f"'{series}'", f"it must be one of {known}")
    return np.array([convert(size, "mm", unit) for size in SIEVE_SERIES[plain[_plain(series)]]])


def _plain(series: str) -> str:
    return re.sub(r"[\s_-]", "", series.lower())


def require_mesh(mesh: str) -> None:
    """Raise ParameterError unless `mesh` names a series of sieve numbers."""
    if mesh not in SERIES_OF_NUMBERS:
        known = ", ".join(f"'{name}'" for name in SERIES_OF_NUMBERS)
        raise parameter_error("mesh", f"'{mesh}'", f"it must be one of {known}")


SERIES_OF_NUMBERS = {"astm": "ASTM E11", "tyler": "Tyler"}
_NEAR = 0.15  # relative difference up to which a sieve may be the one that was meant


def designated(number: float, mesh: str) -> tuple[float | None, str]:
    """Find the opening in mm of the sieve that a number of a series names, or else why there is none.

    Parameters
    ----------
    number : float
    mesh : {"astm", "tyler", "inch"}

    Returns
    -------
    float or None
    str
        The rule, and the sieve that may have been meant where one is near; empty for a sieve that there is.
    """
    if mesh == "inch":
        table = {_inches(name): float(size) for name, size in ASTM_INCHES.items()}
        names = {_inches(name): f"{name} in" for name in ASTM_INCHES}
        found = next((size for inch, size in table.items() if abs(inch - number) < 0.002 * inch), None)
        series = SERIES_OF_NUMBERS["astm"]
    else:
        table = {float(no): float(size) for no, size in (TYLER_NUMBERS if mesh == "tyler" else ASTM_NUMBERS).items()}
        names = {no: f"No. {no:g}" for no in table}
        found = table.get(number)
        series = SERIES_OF_NUMBERS[mesh]
    if found is not None:
        return found, ""
    near = min(table, key=lambda known: abs(known - number))
    meant = f" Did you mean {names[near]}?" if abs(near - number) <= _NEAR * number else ""
    return None, f"{series} has no such sieve.{meant}"


def _inches(name: str) -> float:
    """Read the number of inches in a designation such as "1-1/2"."""
    whole, _, part = name.rpartition("-")
    over, _, under = part.partition("/")
    return float(whole or 0) + (float(over) / float(under) if under else float(over))

"""Decimal and thousands marks, decided once for a whole file from all its numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from comminute.gradings.faults import fault

if TYPE_CHECKING:
    from collections.abc import Iterable

GROUPED = re.compile(r"[0-9]{1,3}(?:[ '][0-9]{3})+(?:[.,][0-9]*)?")
FORMS = {
    mark: re.compile(rf"[0-9]+(?:{re.escape(mark)}[0-9]*)?|{re.escape(mark)}[0-9]+|"
                     rf"[1-9][0-9]{{0,2}}(?:{re.escape(other)}[0-9]{{3}})+(?:{re.escape(mark)}[0-9]*)?")
    for mark, other in ((".", ","), (",", "."))
}  # fmt: skip
NUMBER = re.compile(r"(?P<sign>[+-]?)\s?(?P<digits>[0-9.,' ]*[0-9][.,]?)(?P<power>[eE][+-]?[0-9]{1,3})?")


@dataclass(frozen=True)
class Numeral:
    """One number as it stands in a file, with its place and the largest value that its column can hold."""

    text: str
    place: str
    most: float


def digits_of(text: str, mark: str) -> float | None:
    """Value of a number's text if `mark`, "." or ",", is the decimal mark; None for text that is then no number.

    Examples
    --------
    >>> from comminute.gradings.numerals import digits_of
    >>> digits_of("1,250", "."), digits_of("1,250", ","), digits_of("1.5", ",")
    (1250.0, 1.25, None)
    """
    whole = NUMBER.fullmatch(text.strip())
    if whole is None:
        return None
    digits = whole["digits"].strip()
    if " " in digits or "'" in digits:
        if not GROUPED.fullmatch(digits):
            return None
        digits = re.sub(r"[ ']", "", digits)
        if digits.count("." if mark == "," else ",") > 0:
            return None
    if not FORMS[mark].fullmatch(digits):
        return None
    plain = digits.replace("," if mark == "." else ".", "").replace(mark, ".")
    value = float(f"{whole['sign']}{plain}{whole['power'] or ''}")
    return value if abs(value) < 1e300 else None


def decimal_mark(name: str, numerals: Iterable[Numeral], *, comma_separated: bool) -> str:
    """Decimal mark of a file: the one with which every number of it can be read, and as one value.

    Parameters
    ----------
    name : str
        Name of the file, for messages.
    numerals : iterable of Numeral
        All numbers of the table.
    comma_separated : bool
        Whether commas stand between columns, so that a lone point is a decimal point.

    Returns
    -------
    str
        "." or ",".

    Raises
    ------
    ParameterError
        For a file that mixes both marks, or whose numbers can be read either way; it shows both readings.
    """
    points: list[Numeral] = []
    commas: list[Numeral] = []
    either: list[Numeral] = []
    for numeral in numerals:
        point, comma = digits_of(numeral.text, "."), digits_of(numeral.text, ",")
        if (point is None and comma is None) or point == comma:
            continue
        if point is None or (comma is not None and abs(point) > numeral.most >= abs(comma)):
            commas.append(numeral)
        elif comma is None or abs(comma) > numeral.most >= abs(point):
            points.append(numeral)
        else:
            either.append(numeral)
    if points and commas:
        one, two = points[0], commas[0]
        raise fault(
            two.place,
            f"'{two.text}' is {digits_of(two.text, ','):.4g} with a decimal comma, but {one.place} has "
            f"'{one.text}', {digits_of(one.text, '.'):.4g} with a decimal point",
            "write one decimal mark throughout",
        )
    if not either or points or commas:
        return "," if commas else "."
    if comma_separated and all("," not in numeral.text for numeral in either):
        return "."
    first = either[0]
    raise fault(
        first.place,
        f"'{first.text}' may be {digits_of(first.text, '.'):.4g} or {digits_of(first.text, ','):.4g}, "
        f"and no other number of {name} tells a decimal mark from a thousands mark",
        "write numbers without thousands marks",
    )

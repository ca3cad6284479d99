"""Contents of one column of a sieve table, by the words of its header."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass

from comminute.gradings.words import GRAMS, HEADER_WORDS, LENGTHS, NO_UNITS, PERCENTS, folded, meanings_of, plain

VALUES: tuple[str, ...] = ("percent_finer", "percent_retained", "percent_cumulative_retained", "mass_retained_g")
SIZES: tuple[str, ...] = ("size_mm", "size_um", "size_cm", "size_m", "size_in", "phi", "sieve")


@dataclass(frozen=True)
class Meaning:
    """Contents of a column.

    Attributes
    ----------
    kind : str
        "size", "value", "sample", "unused", or "unknown" where no word is known.
    name : str
        For sizes "opening", "phi" or "designation"; for values the quantity, such as "percent_finer"; for an unused
        column the reason.
    unit : str
        Unit of length or mass, empty where the header names none.
    edge : str
        For sizes the edge of a class, "upper", "lower" or "middle", where the header says which.
    rest : str
        Words of the header without a meaning, such as the name of a sample.
    number : bool
        Whether the values count grains.
    """

    kind: str
    name: str = ""
    unit: str = ""
    edge: str = ""
    rest: str = ""
    number: bool = False


def unit_in(text: str) -> str:
    """Find the unit that a word names: one of nm, um, mm, cm, m, in, "phi", "%", a unit of mass, or nothing."""
    word = plain(text).strip(" []().").replace(" ", "")
    if word in ("M", "G"):
        return ""
    low = word.casefold()
    if low in LENGTHS:
        return LENGTHS[low]
    if low in ("φ", "phi"):
        return "phi"
    if low in PERCENTS or re.fullmatch(r"(wt|m|ma|mass|vol|gew|w)\.?-?%", low):
        return "%"
    return low if low in GRAMS else ""


def units_of(header: str) -> tuple[set[str], str]:
    """Units that a header names in brackets or at its end, and the header without them."""
    text = plain(header)
    found = set()
    for inner in re.findall(r"[\[({]([^\])}]*)[\])}]", text):
        unit = unit_in(inner)
        if unit or inner.strip() in NO_UNITS:
            found |= {unit} - {""}
            text = re.sub(r"[\[({]" + re.escape(inner) + r"[\])}]", " ", text)
    words = [word for word in re.split(r"[\s_,/;:=]+", text.strip()) if word]
    if len(words) > 1 and unit_in(words[-1]) and (words[-1] not in ("m", "M", '"') or "/" in text or "_" in text):
        found.add(unit_in(words[-1]))
        words = words[:-1]
        if words[-1].lower() in ("in", "en", "em", "im"):
            words = words[:-1]
        text = " ".join(words)
    return found, text.strip()


def meaning_of(header: str) -> Meaning:  # noqa: PLR0911  (one return for each kind of column)
    """Meaning of a header, by its words and its unit."""
    units, words = units_of(header)
    found, left = meanings_of(words)
    rest = " ".join(left)
    lengths = units & set(LENGTHS.values())
    grams = units & set(GRAMS)
    unit = next(iter(lengths or grams), "")
    if len(units - {"phi"}) > 1:
        return Meaning("unknown", rest=header)
    if "limit" in found and not lengths:
        return Meaning("unused", "a limit")
    if "phi" in units or ("phi" in found and not lengths):
        return Meaning("size", "phi", edge=_edge(found))
    value = found & {"finer", "retained", "coarser", "cumulative", "mass", "count", "percent", "fraction", "each"}
    if "sample" in found and "size" not in found and not value:
        return Meaning("sample")
    if lengths:
        if value and not found & {"size", "finer", "retained", "upper", "lower"} and "each" not in value:
            return Meaning("unknown", rest=header)
        if not found and left and not re.fullmatch(r"[a-z]", rest):
            return Meaning("unknown", unit=unit, rest=rest)
        return Meaning("size", "opening", unit, _edge(found), rest)
    if grams or "%" in units or value - {"each"} or (value and not found & {"size", "sample"}):
        return _value(found | ({"percent"} if "%" in units else set()), unit, rest, header)
    if found & {"mesh"}:
        return Meaning("size", "designation", edge=_edge(found), rest=rest)
    if found & {"size", "upper", "lower"} and "sample" not in found:
        if rest and folded(header).startswith("size_"):
            return Meaning("unknown", rest=header)
        bare = found == {"size"} and set(folded(words).split()) <= {
            "sieve",
            "sieves",
            "sieb",
            "tamis",
            "tamiz",
            "peneira",
        }
        return Meaning("size", "sieve" if bare else "opening", "", _edge(found), rest)
    if "sample" in found:
        return Meaning("sample")
    return Meaning("unknown", rest=rest or header)


def _edge(found: frozenset[str]) -> str:
    if "middle" in found:
        return "middle"
    if found & {"finer", "upper"}:
        return "upper"
    return "lower" if found & {"retained", "lower"} else ""


def _value(found: frozenset[str], unit: str, rest: str, header: str) -> Meaning:
    """Meaning of a header that names a quantity."""
    percent = bool(found & {"percent", "fraction"}) and not unit
    mass = bool(unit) or ("mass" in found and not percent)
    count = "count" in found and not unit
    if mass and (
        "vessel" in found or "+" in header or ("size" in found and not found & {"retained", "finer", "coarser"})
    ):
        return Meaning("unused", "a sieve's own mass")
    if {"finer", "retained"} <= found or {"finer", "coarser"} <= found:
        return Meaning("unknown", rest=header)
    if "finer" in found:
        name = "mass_finer" if mass else "percent_finer"
    elif "coarser" in found or ("retained" in found and "cumulative" in found):
        name = "mass_cumulative_retained" if mass else "percent_cumulative_retained"
    elif "retained" in found:
        name = "mass_retained_g" if mass else "percent_retained" if percent else "count" if count else "retained"
    elif "cumulative" in found:
        name = "mass_cumulative" if mass else "cumulative"
    elif mass:
        name = "mass_retained_g"
    elif count and not percent:
        name = "count"
    elif "each" in found:
        name = "percent_retained"
    else:
        name = "share"
    return Meaning("value", name, unit, rest=rest, number=count and (percent or name == "count"))


def near_word(header: str) -> str:
    """Name that a header is a misspelling of, among names of the same quantity; empty where none is near."""
    units, words = units_of(header)
    found, _ = meanings_of(words)
    low = re.sub(r"[\s.-]+", "_", folded(header).strip())
    if units & set(LENGTHS.values()):
        unit = next(iter(units & set(LENGTHS.values())))
        known = [folded(word) for line in HEADER_WORDS["size"].values() for word in line.split(", ")]
        near = difflib.get_close_matches(folded(words), known, n=1, cutoff=0.7)
        return f"size_{unit}" if near else ""
    quantities = found & {"finer", "retained", "coarser", "mass"}
    allowed = [name for name in VALUES if not quantities or any(word in name for word in quantities)]
    return next(iter(difflib.get_close_matches(low, [*allowed, *([] if found - {"size"} else SIZES)], 1, 0.8)), "")

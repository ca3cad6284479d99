"""One size as a laboratory writes it: an opening, a designation, inches, a class between two sieves, or the pan."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

from comminute._core import ParameterError
from comminute.gradings.headers import unit_in
from comminute.gradings.numerals import digits_of
from comminute.gradings.sieves import convert, designated, require_mesh
from comminute.gradings.words import LENGTHS, begins_with, folded, meanings_of, plain
from comminute.util.errors import parameter_error, reworded
from comminute.util.names import shorten

WITH_REST = frozenset(("summary", "washed", "initial", "signature"))
AGREE = 0.03  # relative difference of openings up to which a designation and an opening name one sieve
Kind = Literal["sieve", "finer", "coarser", "class"]
_FINER = r"<=?|≤|less than|smaller than|finer than|passing|passes|passed|minus|under|below|thru|through|unter"
_FINER += r"|kleiner als|kleiner"
_FINER += r"|menor que|menor a|menos de|inferieur a|moins de|pasa|passante|minore di|minus no"
_COARSER = r">=?|≥|\+|greater than|larger than|coarser than|retained on|retained|plus|over|above"
_COARSER += r"|uber|grosser als|grosser|mayor que"
_COARSER += r"|superieur a|maior que|maggiore di"
_BETWEEN = r"\s*(?:~|\bto\b|\bbis\b|\ba\b|\bate\b|\band\b|/|-)\s*"
_NAMES = (
    r"(?:u\.?\s?s\.?|astm|iso|din|bs|std\.?|standard|sieve|no\.?|nr\.?|num\.?|#|mesh|tamiz|malla|peneira|tamis|sieb"
)
_NAMES += r"|tyler|series|alternative|ふるい|筛)\s*"
_FRACTION = re.compile(r"(?:([0-9]+)\s?[- ]\s?)?([0-9]+)\s?/\s?([0-9]+)")
_INCH = r'(?:"|in\.?|inch(?:es)?|inches|zoll|pulg\.?|pulgadas?|pol\.?|polegadas?|pouces?|pollici|pollice|po)'


@dataclass(frozen=True)
class Size:
    """One size cell.

    Attributes
    ----------
    kind : str
        "sieve" for an opening; "finer" and "coarser" for a class open at one end; "class" for one between two sieves.
    opening : float
        Opening in `unit`; of a class the finer edge.
    upper : float
        The coarser edge of a class.
    unit : str
    named : str
        "mesh" or "inch" where a designation was looked up, else empty.
    """

    kind: Kind
    opening: float
    unit: str
    upper: float = 0.0
    named: str = ""


@dataclass(frozen=True)
class Style:
    """How the cells of a size column are to be read.

    Attributes
    ----------
    unit : str
        Unit of bare numbers: a unit of length, "phi", "no" for sieve numbers, or empty where none is known.
    mark : str
        Decimal mark of the file.
    mesh : str
        Series of sieve numbers, "astm" or "tyler".
    slashes : bool
        Whether 2/4 is a class from 2 to 4, as European aggregates are named, and not a fraction.
    """

    unit: str
    mark: str
    mesh: str = "astm"
    slashes: bool = False


def numerals_in(text: str) -> list[str]:
    """Numbers in a size cell that may carry a decimal or a thousands mark."""
    return re.findall(r"[0-9][0-9.,']*[0-9]|[0-9]{1,3}(?: [0-9]{3})+(?:[.,][0-9]+)?", plain(text))


class _NoSizeError(Exception):
    """Reason why a cell names no size: the rule, and the value where that says more than the text."""

    def __init__(self, rule: str, value: str = "") -> None:
        super().__init__(rule)
        self.rule, self.value = rule, value


def read_size(text: str, style: Style) -> Size:
    """Size that a cell names.

    Raises
    ------
    ParameterError
        For a cell that names none; its parameter is "the value".
    """
    words = folded(text)
    try:
        return _open_class(words, style) or _closed_class(words, style) or _single(words, style)
    except _NoSizeError as reason:
        raise parameter_error("the value", reason.value or repr(shorten(text)), reason.rule) from None


def _open_class(words: str, style: Style) -> Size | None:
    """Size of a cell such as "<0.063", "passing No. 200" or ">4", or of a class written with both, "-150+106"."""
    signs = {"finer": rf"(?:{_FINER}|-)", "coarser": rf"(?:{_COARSER})"}
    if style.unit == "phi":
        signs = {"finer": r"(?:<=?|≤)", "coarser": r"(?:>=?|≥)"}
    both = re.fullmatch(
        rf"({signs['finer']}|{signs['coarser']})\s*(.+?)\s*[,;/]?\s*(?:{signs['coarser']}|{signs['finer']})\s*(.+)",
        words,
    )
    if both and style.unit != "phi" and _is_size(both[2], style) and _is_size(both[3], style):
        return _class(_single(both[2], style), _single(both[3], style))
    between = re.fullmatch(r"(.+?)\s*(?:<=?|≤)\s*[a-z]\s*(?:<=?|≤)\s*(.+)", words)
    if between:
        return _class(_single(between[1], style), _single(between[2], style))
    for kind, sign in signs.items():
        match = re.fullmatch(rf"{sign}\s*(.+)", words)
        if match and _is_size(match[1], style):
            one = _single(match[1], style)
            # a phi grows as its grain gets finer: what lies above phi 4 is finer than 0.063 mm
            other = {"finer": "coarser", "coarser": "finer"}[kind] if style.unit == "phi" else kind
            return Size(other, one.opening, one.unit, named=one.named)  # type: ignore[arg-type]
    match = re.fullmatch(r"(.+?)\s+(passing|minus|finer|retained|plus|und kleiner|et moins)", words)
    if match and _is_size(match[1], style):
        one = _single(match[1], style)
        return Size("coarser" if match[2] in ("retained", "plus") else "finer", one.opening, one.unit, named=one.named)
    return None


def _closed_class(words: str, style: Style) -> Size | None:
    """Size of a cell such as "2-1", "No. 4 to No. 8" or "P4/R8"; None where the cell is no class."""
    if style.unit == "phi":
        match = re.fullmatch(r"([+-]?[0-9.,]+)\s*(?:~|to|bis|-|/)\s*([+-]?[0-9.,]+)(?:\s*(?:phi|φ))?", words)
        return _class(_single(match[1], style), _single(match[2], style)) if match else None
    bare = re.sub(r"\s*\(.*?\)", "", words)
    if _FRACTION.fullmatch(re.sub(rf"\s*{_INCH}$", "", bare)):
        parts = _FRACTION.fullmatch(re.sub(rf"\s*{_INCH}$", "", bare))
        if parts and not (style.slashes and parts[1] is None):
            return None
    for match in re.finditer(_BETWEEN, words):
        left, right = words[: match.start()], words[match.end() :]
        if not (left and right):
            continue
        unit = re.search(r"(?<=[0-9])\s*(mm|[uμ]m|cm|microns?|in|\")$", right)
        if unit and re.fullmatch(r"[0-9.,]+", left) and not style.unit:
            left += unit[0]
        if style.unit not in ("", "in") and "/" in match[0] and not style.slashes:
            continue
        if _is_size(left, style) and _is_size(right, style):
            return _class(_single(left, style), _single(right, style))
    return None


def _class(one: Size, two: Size) -> Size:
    """Class between two sieves, whichever is named first."""
    to = one.unit if one.unit == two.unit else "mm"
    sizes = sorted(convert(size.opening, size.unit, to) for size in (one, two))
    return Size("class", sizes[0], to, sizes[1], one.named or two.named)


def _is_size(words: str, style: Style) -> bool:
    try:
        return _single(words, style).opening >= 0.0
    except _NoSizeError:
        return False


def _single(words: str, style: Style) -> Size:
    """One size without a sign of more or less, "#10 (2.00 mm)" among them."""
    bracket = re.fullmatch(r"(.*?)\s*[(\[=]\s*(.*[0-9].*?)\s*[)\]]?", words)
    if bracket and bracket[1]:
        outer = _bare(bracket[1], style)
        inner = _bare(
            bracket[2], Style("mm" if style.unit in ("", "no", "in", "phi") else style.unit, style.mark, style.mesh)
        )
        here, there = (convert(size.opening, size.unit, "mm") for size in (outer, inner))
        if not (here > 0.0 and there > 0.0 and abs(math.log(here / there)) <= AGREE):
            raise _NoSizeError(f"it names two sizes, {here:.4g} mm and {there:.4g} mm; give one")
        return inner if outer.named else outer
    return _bare(words, style)


def _bare(words: str, style: Style) -> Size:
    text = re.sub(r"^(?:ø|d|w)\s*(?=[0-9])", "", words.strip())
    measured = re.fullmatch(r"([0-9][0-9.,' ]*|[.,][0-9]+)\s*([^\W\d_]+\.?)", text)
    if measured:
        unit = unit_in(measured[2].rstrip("."))
        if unit in set(LENGTHS.values()) - {"in"}:
            return Size("sieve", _number(measured[1], style, words), unit)
        if unit == "phi" or (measured[2] in ("phi", "φ")):
            return _from_phi(_number(measured[1], style, words))
    inches = re.fullmatch(rf"([0-9.,][0-9.,/ -]*?)\s*-?\s*{_INCH}\s*(?:sieve)?", text)
    if inches or (_FRACTION.fullmatch(text) and style.unit in ("", "no", "in")):
        return _inches(inches[1] if inches else text, style, words)
    named = re.fullmatch(rf"((?:{_NAMES})*)([0-9]+(?:[.,]5|[ -]1/2)?)\s*(mesh|m|目|メッシュ)?", text)
    if named and (named[1] or named[3] or style.unit == "no"):
        number = float(re.sub(r"[ -]1/2|,5", ".5", named[2]))
        return Size("sieve", _designated(number, style.mesh), "mm", named="mesh")
    if style.unit == "phi":
        return _from_phi(_number(text, style, words))
    value = _number(text, style, words)
    if style.unit == "no":
        raise _NoSizeError("no sieve is called so; sizes need their unit, in the header (size_mm) or in the cell")
    if not style.unit:
        raise _NoSizeError("it has no unit; name it in the header, size_mm or size_um")
    return Size("sieve", value, style.unit)


def _inches(text: str, style: Style, words: str) -> Size:
    """Inches: exact in a column of inches, else those that ASTM E11 gives to a sieve."""
    parts = _FRACTION.fullmatch(text.strip())
    if parts:
        if int(parts[3]) == 0:
            raise _NoSizeError("it must be a size")
        value = int(parts[1] or 0) + int(parts[2]) / int(parts[3])
    else:
        value = _number(text, style, words)
    if style.unit == "in":
        return Size("sieve", value, "in")
    if parts and text.strip() in ("3-1/2", "3 1/2") and not re.search(_INCH + "$", words.replace("sieve", "").strip()):
        raise _NoSizeError("it may be 3-1/2 in or No. 3-1/2; write which")
    return Size("sieve", _designated(value, "inch"), "mm", named="inch")


def _designated(number: float, mesh: str) -> float:
    opening, remedy = designated(number, mesh)
    if opening is None:
        raise _NoSizeError(remedy)
    return opening


def _from_phi(value: float) -> Size:
    if abs(value) >= 1000.0:
        raise _NoSizeError("phi must be between -1000 and 1000", f"{value:.4g}")
    return Size("sieve", 2.0**-value, "mm")


def _number(text: str, style: Style, words: str) -> float:
    value = digits_of(text, style.mark)
    if value is None:
        date = "; a spreadsheet has made a date of a fraction: format the column as text" if "date" in words else ""
        raise _NoSizeError(f"it must be a number{date}")
    return value


def row_meaning(label: str) -> str:
    """Meaning of a row by its label: "pan", "washed", "total", "initial", "loss", "summary", or nothing."""
    words = re.sub(r"\((?:g|kg|%|mm)\)|\bg\b|[%:=]", " ", folded(label)).strip()
    found, rest = meanings_of(words, "row")
    if rest:  # such a row goes on after its name, which a size or a remark on one does not begin with
        found = frozenset(name for name in found & WITH_REST if begins_with(words, name))
    if "signature" in found:
        return "summary"
    order = ("initial", "washed", "loss", "summary", "pan", "total")
    return next((name for name in order if name in found), "")


def sieve_size(name: str, *, mesh: str = "astm") -> float:
    """Find the opening in mm of one sieve by its designation.

    Parameters
    ----------
    name : str
        A sieve number ("200", "No. 200", "#200", "200 mesh"), inches ('3/8 in', '1-1/2"'), or an opening with
        its unit as ISO 565 writes it ("355 µm", "1.4 mm").
    mesh : {"astm", "tyler"}
        Series of the numbers: ASTM E11, or Tyler's, whose 35 mesh is 0.425 mm where ASTM's No. 35 is 0.5 mm.

    Returns
    -------
    float

    Raises
    ------
    ParameterError
        For a designation that the series does not have; the message names the nearest where one is near.

    Examples
    --------
    >>> import comminute as cm
    >>> cm.sieve_size("No. 200"), cm.sieve_size("3/8 in"), cm.sieve_size("355 µm"), cm.sieve_size("35", mesh="tyler")
    (0.075, 9.5, 0.355, 0.425)
    """
    require_mesh(mesh)
    mark = "," if "," in name else "."
    try:
        size = read_size(name, Style("no", mark, mesh))
    except ParameterError as error:
        raise reworded(error, changed={"parameter": "sieve"}) from None
    if size.kind != "sieve":
        raise parameter_error("sieve", f"'{shorten(name)}', a class", "it must be one sieve")
    return convert(size.opening, size.unit, "mm")

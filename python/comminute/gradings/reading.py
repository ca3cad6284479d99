"""Sieve tables from files: from the cells of a file to sieves and per cent finer, with notes of what was assumed."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from comminute._core import Grading, ParameterError, Place, defaults
from comminute.gradings import values as quantities
from comminute.gradings.agreement import require_agreement
from comminute.gradings.body import Body, chosen_sample, sorted_body
from comminute.gradings.headers import Meaning, meaning_of, near_word
from comminute.gradings.layout import Column, Layout, open_layout
from comminute.gradings.numerals import Numeral, decimal_mark
from comminute.gradings.openings import numerals_in, row_meaning
from comminute.gradings.numbers import numeral_in, value_of
from comminute.gradings.sheets import Line
from comminute.gradings.sieves import IN_MM, require_mesh, unit_of
from comminute.gradings.sizing import Sized, sized
from comminute.util.errors import parameter_error, reworded, wrong_file
from comminute.util.names import is_file, shorten

Top = Literal["error", "extend"]
SIEVES = defaults["from_sieves"]
EDGES = ("lower", "upper")
PRIORITY = ("mass_retained_g", "count", "mass_cumulative_retained", "mass_finer", "percent_finer")
PRIORITY += ("percent_cumulative_retained", "percent_retained", "retained", "cumulative", "mass_cumulative", "share")
LARGEST_MM = 1000.0  # an opening beyond this is a thousands mark read as a decimal mark


@dataclass(frozen=True)
class Reading:
    """How a table is to be read, where the table itself leaves a choice; each is refused where it does not apply.

    Attributes
    ----------
    sheet : str or int, optional
        Sheet of a workbook, by name or by its number from 1.
    sample : str, optional
        Sample of a table of several.
    mesh : {"astm", "tyler"}, optional
        Series of sieve numbers.
    total_mass_g : float, optional
        Dry mass before washing.
    edges : {"lower", "upper"}, optional
        Edge of a class that its size is.
    """

    sheet: str | int | None = None
    sample: str | int | None = None
    mesh: str | None = None
    total_mass_g: float | None = None
    edges: str | None = None

    def require_valid(self) -> None:
        """Raise ParameterError for a value that no table could take."""
        if self.mesh is not None:
            require_mesh(self.mesh)
        if self.edges is not None and self.edges not in EDGES:
            raise parameter_error("edges", f"'{self.edges}'", "it must be one of 'lower', 'upper'")
        if self.total_mass_g is not None and not 0.0 < self.total_mass_g < float("inf"):
            raise parameter_error("total_mass_g", float(self.total_mass_g), "it must be greater than 0 and finite")


@dataclass(frozen=True)
class SieveData:
    """Sieves of a file from coarse to fine, per cent finer, and what was assumed in reading it.

    Attributes
    ----------
    size, percent_finer : tuple of float
    unit : str
    places : tuple of str
        Row of each sieve, for messages.
    notes : tuple of str
    name : str
        Name of the file.
    number : bool
        Whether the shares count grains, as the file says.
    """

    size: tuple[float, ...]
    percent_finer: tuple[float, ...]
    unit: str
    places: tuple[str, ...]
    notes: tuple[str, ...]
    name: str
    number: bool = False

    def grading(self, *, top: Top, number: bool) -> Grading:
        """Grading of these sieves; errors name the file and its rows."""
        try:
            return Grading.from_sieves(
                self.size, self.percent_finer, self.unit, top=top, number=number or self.number, notes=self.notes
            )
        except ParameterError as error:
            raise self._in_file(error) from None

    def _in_file(self, error: ParameterError) -> ParameterError:
        """Give an error, whose rows count the sieves, the rows of the file and a remedy for its columns."""
        place = error.place and self._place(error.place[0])
        changed: dict[str, object] = {
            "place": place or (Place(self.name),),
            "also": error.also and self._place(error.also)[-1],
        }
        if error.remedy == "cumulate_retained" and self.places:
            changed["remedy"] = "name_retained_column"
        return reworded(error, changed=changed)

    def _place(self, sieve: Place) -> tuple[Place, ...]:
        """Place in the file of a sieve that the core knows by its row in the lists, counted from 1."""
        return (Place(self.places[sieve.row - 1]),) if self.places else (Place(self.name), sieve)


def read_grading(  # noqa: PLR0913  (each option is asked for by name)
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    top: Top = SIEVES["top"],
    number: bool = SIEVES["number"],
    sheet: str | int | None = None,
    sample: str | None = None,
    mesh: Literal["astm", "tyler"] | None = None,
    total_mass_g: float | None = None,
    edges: Literal["lower", "upper"] | None = None,
) -> Grading:
    r"""Measured curve from a sieve table: .csv, .txt, .tsv, or .xlsx with the extra `xlsx`.

    The header names a size and a quantity in words that laboratories use, in any of eight languages: `size_mm`,
    `Sieve size (mm)`, `phi` or `sieve` (numbers of ASTM E11, inches), and `percent_finer`, `% retained`,
    `percent_cumulative_retained`, `mass_retained_g` or `count`. The page "Sieve tables we read" lists the words, and
    what may stand around a table. Rows read are rows given, or the table is refused. An option that the table has no
    use for is an error.

    Parameters
    ----------
    path : path-like
    unit : str, optional
        Unit of the sizes of the grading; left out: the unit of the file, mm for phi and sieve.
    top : {"error", "extend"}
        See `Grading.from_sieves`.
    number : bool
        The shares count grains; see `Grading.from_sieves`. A column of counts says so itself.
    sheet : str or int, optional
        Sheet of a workbook by its name, or its number from 1; left out: the first that holds a table.
    sample : str, optional
        Sample of a table of several.
    mesh : {"astm", "tyler"}, optional
        Series of the sieve numbers; left out: ASTM E11.
    total_mass_g : float, optional
        Dry mass before washing [g]; what the sieves and the pan do not hold of it passed the finest sieve.
    edges : {"lower", "upper"}, optional
        Edge of its class that a size is, for values of classes; left out: lower, as what stays on a sieve.

    Returns
    -------
    Grading
        Its `notes` say what was converted or assumed.

    Raises
    ------
    ParameterError
        For a table that makes no grading; it names file, row, column and value, the rule, and the remedy.
    ImportError
        For .xlsx where openpyxl is missing.

    Examples
    --------
    >>> import comminute as cm, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "sand.csv")
    >>> _ = path.write_text("Siebweite (mm);Rückstand (g)\n2,0;0\n1,0;30\n0,5;50\nSchale;20\n", encoding="utf-8")
    >>> cm.Grading.read(path).finer([2.0, 1.0, 0.5])
    array([1. , 0.7, 0.2])
    """
    how = Reading(sheet, sample, mesh, total_mass_g, edges)
    return read_sieves(path, unit=unit, number=number, how=how).grading(top=top, number=number)


def read_sieves(
    path: str | os.PathLike[str], *, unit: str | None = None, number: bool = False, how: Reading = Reading()
) -> SieveData:
    """Sieves and per cent finer from a file; see `Grading.read`.

    Parameters
    ----------
    path : path-like
    unit : str, optional
        Unit of the sizes wanted; left out: that of the file.
    number : bool
        Whether the caller takes the shares for counts, which masses cannot be.
    how : Reading
        What the table leaves open.

    Returns
    -------
    SieveData

    Raises
    ------
    ParameterError
        Naming file, row, column and value, the rule, and what to do.
    ImportError
        For .xlsx where openpyxl is missing.
    """
    file = Path(path)
    how.require_valid()
    if unit is not None and not unit_of(unit):
        raise parameter_error("unit", f"'{unit}'", f"it must be one of {', '.join(IN_MM)}")
    if not is_file(file):
        raise wrong_file(str(file), "is no file", "give a sieve table (.csv or .xlsx)")
    layout = chosen_sample(open_layout(file, how.sheet), how.sample)
    sizes, values = _columns(layout)
    finer = all(column.meaning.name in ("percent_finer", "mass_finer") for column in values)
    body = sorted_body(layout, sizes, values, finer=finer)
    if not body.sieves:
        raise ParameterError(f"{layout.name} has a header but no sieves; it needs at least two")
    mark = _mark(layout, body, sizes, values)
    to = unit_of(unit) if unit is not None else None
    rows = sized(layout, sizes, body.sieves, unit=to, mark=mark, mesh=how.mesh, finer=finer)
    return _curve(layout, body, rows, values, mark, number=number, how=how)


def _columns(layout: Layout) -> tuple[list[Column], list[Column]]:
    """Size columns, and value columns with that to read first."""
    sizes, values = layout.of_kind("size"), layout.of_kind("value")
    for column in (*values, *layout.of_kind("unknown")):
        near = near_word(column.header) if column.meaning.name in ("", "share") and column.header else ""
        if near and (column.meaning.rest and column.meaning.name == "share" or not values):
            raise ParameterError(
                f"{layout.header.place}: the header names no value column; it must name one of percent_finer, "
                "percent_retained, percent_cumulative_retained, mass_retained_g; "
                f"did you mean {near} by '{column.header}'?"
            )
    bare = [column for column in sizes if column.meaning.name == "opening" and not column.meaning.unit]
    for column in bare:
        if len(sizes) == 1 and all(_is_bare(column.cell(line).text) for line in layout.body if column.cell(line).numeric):
            if any(column.cell(line).numeric for line in layout.body):
                raise ParameterError(f"{layout.header.place}: the size column has no unit; name it size_mm or size_um")
    if not values:
        values = [replace(c, meaning=_open_meaning(layout, c)) for c in layout.of_kind("unknown") if _has_numbers(layout, c)]
        values = values[:1]
    if not values:
        raise ParameterError(
            f"{layout.header.place}: the header names no value column; it must name one of percent_finer, "
            "percent_retained, percent_cumulative_retained, mass_retained_g"
        )
    return sizes, sorted(values, key=lambda column: PRIORITY.index(column.meaning.name))


def _is_bare(text: str) -> bool:
    return all(c in "0123456789.,' " for c in text.strip())


def _has_numbers(layout: Layout, column: Column) -> bool:
    return bool(column.header) and any(column.cell(line).numeric for line in layout.body)


def _open_meaning(layout: Layout, column: Column) -> Meaning:
    """Quantity of a column whose header names a sample: that of the title above the table, or left to its numbers."""
    found = {}
    for line in layout.above:
        for cell in line.filled:
            meaning = meaning_of(cell.text)
            if meaning.kind == "value" and meaning.name != "share":
                found[meaning.name] = meaning
    if len(found) == 1:
        return replace(next(iter(found.values())), rest=column.header)
    return Meaning("value", "share", rest=column.header)


def _mark(layout: Layout, body: Body, sizes: list[Column], values: list[Column]) -> str:
    """Decimal mark of the file, from the numbers of all its size and value columns."""
    numerals = []
    for line in (*body.sieves, *body.pan, *body.total, *body.initial, *body.loss, *body.washed):
        for column in sizes:
            cell = column.cell(line)
            if cell.number is None and line in body.sieves:
                per_mm = {"um": 1e3, "nm": 1e6, "m": 1e-3, "cm": 0.1, "in": 1.0 / 25.4}.get(column.meaning.unit, 1.0)
                most = LARGEST_MM * per_mm
                numerals += [Numeral(text, line.place, most) for text in numerals_in(cell.text)]
        for column in layout.of_kind("value") or values:
            text = numeral_in(column.cell(line))
            most = 100.5 if column.meaning.name.startswith(("percent", "share", "cumulative")) else float("inf")
            if text:
                numerals.append(Numeral(text, line.place, most))
    return decimal_mark(layout.name, numerals, comma_separated=layout.comma_separated)


def _curve(  # noqa: PLR0913
    layout: Layout, body: Body, rows: Sized, values: list[Column], mark: str, *, number: bool, how: Reading
) -> SieveData:
    """Per cent finer of a table, by the first of its value columns that is whole; the others must agree."""
    made: list[tuple[Column, quantities.Column, list[float], list[str]]] = []
    for column in values:
        notes: list[str] = []
        try:
            numbers = quantities.resolved(_numbers(layout, body, rows, column, mark, how), notes)
            made.append((column, numbers, quantities.per_cent_finer(numbers, notes), notes))
        except ParameterError as error:
            if len(values) == 1:
                raise
            failed = error
            whole = all(column.cell(line).text for line in body.sieves)
            if whole:
                raise
            layout = replace(layout, notes=(*layout.notes, f"column '{column.header}' of {layout.name} is not used"))
    if not made:
        raise failed
    made.sort(key=lambda one: one[1].name in quantities.RETAINED and one[1].pan is None and one[1].whole is None)
    read, numbers, finer, notes = made[0]
    for column, others, curve, _ in made[1:]:
        if others.name in ("mass_retained_g", "count") and others.pan is None and others.whole is None:
            share = quantities.as_per_cent(finer)[-1] / 100.0
            rest = share / (1.0 - share) * sum(others.value) if share < 1.0 else 0.0
            curve = quantities.per_cent_finer(replace(others, pan=rest), [])
        curves = (quantities.as_per_cent(finer), quantities.as_per_cent(curve))
        require_agreement(read, column, curves, rows.line, mark)
        notes.append(f"column '{column.header}' of {layout.name} agrees with '{read.header}', which is read")
    if number and numbers.name.startswith("mass"):
        raise ParameterError(
            f"{layout.name}: column '{read.header}' holds masses, which count no grains; leave number out, or name the "
            "column count"
        )
    _require_applied(layout, numbers, rows, how)
    _require_rising(layout, numbers, rows, finer)
    unused = [column for column in layout.of_kind("unknown") if column.header and column.header != read.header]
    unused += layout.of_kind("unused")
    said = [f"column '{column.header}' of {layout.name} is not used" for column in unused if column not in values]
    places = tuple(line.place if line else f"{layout.name}, top of the coarsest class" for line in rows.line)
    all_notes = (*layout.notes, *said, *rows.notes, *notes, *body.notes)
    by_number = read.meaning.number or numbers.name == "count"
    return SieveData(tuple(rows.size), tuple(finer), rows.unit, places, all_notes, layout.name, by_number)


def _numbers(
    layout: Layout, body: Body, rows: Sized, column: Column, mark: str, how: Reading
) -> quantities.Column:
    """Numbers of one column on the sieves, with what its pan, its total and its losses say."""
    name = column.meaning.name
    if name == "share" and rows.classes:
        name = "percent_retained"
    adds_up = name in quantities.RETAINED or name in ("share",)
    value = tuple(0.0 if line is None else value_of(column, line, mark) for line in rows.line)
    if name in ("percent_finer", "cumulative", "share") and rows.line.count(None):
        raise ParameterError(
            f"{layout.name}: column '{column.header}' gives one value for each class between two sieves; name the sieve "
            "that it is finer than"
        )
    pan_lines = [*body.pan, *([rows.pan] if rows.pan else [])]
    if len(pan_lines) > 1:
        raise ParameterError(f"{pan_lines[1].place}: a second pan; a table has one")
    pan = next((value_of(column, line, mark) for line in pan_lines if column.cell(line).text or len(layout.of_kind("value")) < 2), None)
    washed = [value_of(column, line, mark) for line in body.washed if column.cell(line).text]
    if washed and adds_up:
        pan = (pan or 0.0) + sum(washed)
    upper = (how.edges or rows.edge) == "upper" and name in quantities.RETAINED and not rows.classes
    if upper and pan:
        raise ParameterError(f"{pan_lines[0].place}: a pan stands below the finest class, whose size is its upper edge")
    loss = sum(value_of(column, line, mark) for line in body.loss if column.cell(line).numeric)
    whole = how.total_mass_g if name in quantities.WEIGHED else None
    made = quantities.Column(layout.name, column.header, name, tuple(rows.size), value, pan, whole, loss, upper, pan_lines[0].place if pan_lines else "")
    _require_total(layout, body, column, made, mark)
    if whole is None and name in ("mass_finer", "mass_cumulative_retained", "mass_cumulative"):
        wholes = [value_of(column, line, mark) for line in (*body.total, *body.initial) if column.cell(line).numeric]
        made = replace(made, whole=wholes[0] if wholes else None)
    return made


def _require_total(layout: Layout, body: Body, column: Column, made: quantities.Column, mark: str) -> None:
    """Refuse a table whose rows do not add up to what its row of totals says: a row may be missing."""
    if made.name not in quantities.RETAINED:
        return
    total = sum(made.value) + (made.pan or 0.0)
    for line in body.total:
        if not column.cell(line).numeric:
            continue
        said = value_of(replace(column, meaning=replace(column.meaning, name="mass_retained_g", unit=column.meaning.unit)), line, mark)
        near = 0.5 * 10.0 ** -2 * max(said, total) + 1e-9
        if min(abs(said - total), abs(said - total - made.loss)) > near:
            raise ParameterError(
                f"{line.place}: the total says {said:.4g}, but the rows above add up to {total:.4g}; is a row missing, or "
                "was some washed out (total_mass_g)?"
            )
    for line in (*body.initial, *(one for one in layout.above if row_meaning(one.cells[0].text) == "initial")):
        cells = [cell for cell in line.filled[1:] if cell.numeric]
        if not cells or not made.name.startswith("mass") or made.whole is not None:
            continue
        said = value_of(Column(line.cells.index(cells[0]), column.header, column.meaning), line, mark)
        if abs(said - total - made.loss) > 0.02 * max(said, total):
            raise ParameterError(
                f"{line.place}: {said:.4g} g before sieving, but the rows add up to {total:.4g} g; was some washed out? give "
                "total_mass_g"
            )


def _require_applied(layout: Layout, read: quantities.Column, rows: Sized, how: Reading) -> None:
    """Refuse an option that this table has no use for, rather than ignore it."""
    if how.total_mass_g is not None and read.name not in quantities.WEIGHED:
        raise ParameterError(
            f"total_mass_g is {how.total_mass_g:.4g}, but column '{read.header}' of {layout.name} holds no masses; leave it "
            "out"
        )
    if how.edges is not None:
        if rows.edge and rows.edge != how.edges:
            raise ParameterError(f"edges is '{how.edges}', but the header of {layout.name} names {rows.edge} edges")
        if rows.classes or read.name not in quantities.RETAINED:
            raise ParameterError(
                f"edges is '{how.edges}', but the values of {layout.name} belong to "
                f"{'classes with both their edges' if rows.classes else 'sieves, not to classes'}; leave it out"
            )


def _require_rising(layout: Layout, read: quantities.Column, rows: Sized, finer: list[float]) -> None:
    """Refuse a curve that falls where two methods overlap, which the general remedy for a falling curve would mislead."""
    if read.name != "percent_finer":
        return
    falls = [q for q in range(1, len(finer)) if finer[q] > finer[q - 1] + 1e-9]
    for q in falls:
        line, above = rows.line[q], rows.line[q - 1]
        near = finer[q] - finer[q - 1] <= 0.25 * finer[q - 1] and rows.size[q - 1] <= 1.5 * rows.size[q]
        if len(falls) == 1 and near and line is not None and above is not None:
            raise ParameterError(
                f"{line.place}: {finer[q]:.4g} % finer at {rows.size[q]:.4g} {rows.unit} is more than {finer[q - 1]:.4g} % at "
                f"{rows.size[q - 1]:.4g} {rows.unit}; two methods that overlap, such as sieves and a hydrometer? leave out "
                "the points of one"
            )

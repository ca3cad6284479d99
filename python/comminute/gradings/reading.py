"""Sieve tables from files: from the cells of a file to sieves and per cent finer, with notes of what was assumed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from comminute._core import Grading, ParameterError, Place, defaults
from comminute.gradings.assembly import curve_of, mark_of
from comminute.gradings.body import chosen_sample, sorted_body
from comminute.gradings.columns import columns_of
from comminute.gradings.layout import open_layout
from comminute.gradings.options import Reading
from comminute.gradings.sieves import IN_MM, unit_of
from comminute.gradings.sizing import sized
from comminute.util.errors import parameter_error, reworded, wrong_file
from comminute.util.names import is_file

Top = Literal["error", "extend"]
SIEVES = defaults["from_sieves"]
AS_IT_STANDS = Reading()


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


def read_grading(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    top: Top = SIEVES["top"],
    number: bool = SIEVES["number"],
    sheet: str | int | None = None,
    sample: str | int | None = None,
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
    path: str | os.PathLike[str], *, unit: str | None = None, number: bool = False, how: Reading = AS_IT_STANDS
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
        Choices that the table leaves open.

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
    sizes, values = columns_of(layout)
    finer = all(column.meaning.name in ("percent_finer", "mass_finer") for column in values)
    body = sorted_body(layout, sizes, values, finer=finer)
    if not body.sieves:
        raise wrong_file(layout.name, "has a header but no sieves", "it needs at least two")
    mark = mark_of(layout, body, sizes, values)
    to = unit_of(unit) if unit is not None else None
    rows = sized(layout, sizes, body.sieves, unit=to, mark=mark, mesh=how.mesh, finer=finer)
    curve = curve_of(layout, body, rows, values, mark, number=number, how=how)
    places = tuple(line.place if line else f"{layout.name}, top of the coarsest class" for line in rows.line)
    return SieveData(tuple(rows.size), curve.percent_finer, rows.unit, places, curve.notes, layout.name, curve.number)

"""The commands `table` and `compare`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from comminute._core import ParameterError
from comminute.cli.messages import WORDS
from comminute.cli.stats import read_sieve_table, require_no_options
from comminute.files.tables import INDICES, Cell, Table, grading_table, load_table, result_curves, write_workbook
from comminute.gradings.breakage import breakage_index, relative_breakage
from comminute.gradings.curves import SizeCurve
from comminute.gradings.dem import dem_text
from comminute.gradings.indices import milling
from comminute.opening import open_result
from comminute.util.errors import parameter_error, reworded

ENDINGS = (".csv", ".xlsx")


def percents_of(text: str) -> tuple[float, ...]:
    """Numbers of "10,50,90".

    Raises
    ------
    ParameterError
        For what is no per cent of the mass.
    """
    found = []
    for word in text.split(","):
        try:
            percent = float(word)
        except ValueError:
            percent = -1.0
        if not 0.0 < percent <= 100.0:
            raise parameter_error("--percentiles", f"'{word.strip()}'", "it must be numbers up to 100, as in 10,50,90")
        found.append(percent)
    return tuple(found)


def sieves_of(text: str) -> str | list[float]:
    """Give the openings of "2,1,0.5", or the name of a series."""
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        return text


def tables_of(
    files: list[Path], *, sieves: str | None, percents: tuple[float, ...] | None, table: dict[str, Any]
) -> dict[str, Table]:
    """Tables of files: gradings on sieves, and of each result its loads.

    Parameters
    ----------
    files : list of Path
        Sieve tables and results.
    sieves : str, optional
        Series or openings. Left out, the sieves of the first file's measured grading, else the edges of its bins.
    percents : tuple of float, optional
        Sizes D_x of the table of loads.
    table : dict
        Options of sieve tables.

    Returns
    -------
    dict of str to Table
        "gradings", and "loads" or, of several results, "loads of NAME" for each.
    """
    curves: dict[str, SizeCurve] = {}
    loads: dict[str, Table] = {}
    own: list[float] = []
    indices = INDICES if percents is None else (*(f"D{percent:g}" for percent in percents), "fines", "crushes")
    for file in files:
        prefix = f"{file.stem}: " if len(files) > 1 else ""
        if file.suffix == ".nc":
            require_no_options(file, {} if len(files) > 1 else table)
            result = open_result(file)
            curves |= result_curves(result, prefix)
            loads[f"loads of {file.stem}" if len(files) > 1 else "loads"] = load_table(result, indices)
            own = own or list(result.measured.size if result.measured is not None else result.edge_size)
        else:
            curve = SizeCurve.of(read_sieve_table(file, **table)[0])
            curves[file.stem] = curve
            own = own or list(curve.size)
    return {"gradings": grading_table(curves, own if sieves is None else sieves_of(sieves))} | loads


def compared(before: SizeCurve, after: SizeCurve, percents: tuple[float, ...]) -> Table:
    """Put the indices of two gradings beside each other, their ratios, and what needs both."""
    rows: list[tuple[Cell, ...]] = []
    unit = f" ({before.unit})" if before.unit else ""

    def value(make: Any) -> float | None:
        try:
            return float(make())
        except ParameterError:  # below the finest sieve, or without a unit
            return None

    for percent in percents:
        sizes = [value(lambda curve=curve, percent=percent: curve.percentile(percent)) for curve in (before, after)]
        first, second = sizes
        rows.append((f"D{percent:g}{unit}", first, second, second / first if first and second else None))
    rows.append(("Hardin Br", None, value(lambda: relative_breakage(before, after)), None))
    rows.append(("Einav B", None, value(lambda: breakage_index(before, after).index), None))
    try:
        mill = milling(before, after)
        rows.append((f"F80, P80{unit}", mill.f80, mill.p80, mill.p80 / mill.f80))
        rows.append(("t10 (%)", None, mill.t10, None))
    except ParameterError:
        rows.append((f"F80, P80{unit}", None, None, None))
    return Table(("index", "before", "after", "after/before"), tuple(rows))


def curve_of(file: Path, table: dict[str, Any]) -> SizeCurve:
    """Curve of a sieve table."""
    if file.suffix == ".nc":
        rule = "it takes sieve tables; comminute stats has the indices of a result against its start"
        raise parameter_error("compare", file.name, rule, finding=f"is given {file.name}, a result")
    return SizeCurve.of(read_sieve_table(file, **table)[0])


def one_curve(file: Path, load: int, table: dict[str, Any]) -> SizeCurve:
    """Curve of a sieve table, or of one load of a result."""
    if file.suffix != ".nc":
        return curve_of(file, table)
    require_no_options(file, table)
    result = open_result(file)
    if not -result.stress_ratio.size <= load < result.stress_ratio.size:
        rule = f"it must be an index of a load, 0 to {result.stress_ratio.size - 1}"
        raise parameter_error("--load", load, rule)
    return result.curve(load)


def dem(curve: SizeCurve, code: str, **options: Any) -> str:
    """Text for a particle code; errors name the options of the command line."""
    try:
        return dem_text(curve, code, **options)  # type: ignore[arg-type]  # the word is checked there
    except ParameterError as error:
        raise reworded(error, words=WORDS) from None


def compared_files(before: Path, after: Path, *, percents: tuple[float, ...], table: dict[str, Any]) -> Table:
    """Compare two sieve tables, the second in the unit of the first."""
    first, second = curve_of(before, table), curve_of(after, table)
    if first.unit != second.unit:
        try:
            second = second.in_unit(first.unit)
        except ParameterError as error:
            raise reworded(error, words=WORDS) from None
    return compared(first, second, percents)


def save(tables: dict[str, Table], target: Path) -> list[Path]:
    """Write a workbook with all tables, or a file with commas for each: the first as named, others beside it."""
    if target.suffix == ".xlsx":
        return [write_workbook(tables, target)]
    written = []
    for number, (name, table) in enumerate(tables.items()):
        path = target if number == 0 else target.with_name(f"{target.stem}-{name.replace(' ', '-')}.csv")
        written.append(table.to_csv(path))
    return written


def record(tables: dict[str, Table]) -> dict[str, list[dict[str, Cell]]]:
    """Give the rows by their headings, for JSON."""
    return {name: [dict(zip(table.columns, row, strict=True)) for row in table.rows] for name, table in tables.items()}

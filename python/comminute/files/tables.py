"""Tables of gradings on sieves and of indices by load, for spreadsheets and for pandas."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from comminute._core import ParameterError
from comminute.gradings.curves import SizeCurve
from comminute.gradings.named import named_index
from comminute.gradings.sieves import sieve_sizes
from comminute.runs.remarks import load_labels
from comminute.util.errors import parameter_error
from comminute.util.optional import needs
from comminute.util.whole_files import write_whole

if TYPE_CHECKING:
    from comminute.runs.results import Floats, ResultData

SHOWN = 5e-4  # share of the mass below which a series of sieves is cut
INDICES = ("D10", "D50", "D60", "fines", "crushes")
Cell = float | str | None


@dataclass(frozen=True)
class Table:
    """Rows of numbers under headings.

    Attributes
    ----------
    columns : tuple of str
        Headings, with units.
    rows : tuple of tuple
        One cell for each heading; None where there is no value.

    Examples
    --------
    >>> import comminute as cm
    >>> sand = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 60, 0], unit="mm")
    >>> run = cm.Simulation(cm.Material(reference_size=2.0, fabric_width=0.3), sand).run(stress_ratio=[5.0, 50.0])
    >>> print(run.grading_table([2.0, 1.0, 0.5]))
    size (mm)      start  stress ratio 5  stress ratio 50
            2        100             100              100
            1         60           78.74            91.02
          0.5          0           25.25            52.09
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def to_pandas(self) -> Any:
        """DataFrame with the first column as its index; needs pandas.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            import pandas as pd  # noqa: PLC0415  (pandas is optional)
        except ImportError as error:
            raise needs("io", "pandas", "to_pandas") from error
        return pd.DataFrame(list(self.rows), columns=list(self.columns)).set_index(self.columns[0])

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write a file with commas, complete or not at all; numbers keep every digit."""

        def write(target: Path) -> None:
            with target.open("w", newline="", encoding="utf-8") as file:
                csv.writer(file).writerows(
                    [self.columns, *(["" if c is None else c for c in row] for row in self.rows)]
                )

        return write_whole(Path(path), write)

    def to_excel(self, path: str | os.PathLike[str], sheet: str = "table") -> Path:
        """Write a workbook with one sheet, complete or not at all; needs openpyxl.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        return write_workbook({sheet: self}, path)

    def __str__(self) -> str:
        cells = [
            [f"{c:.4g}" if isinstance(c, float) else "-" if c is None else str(c) for c in row] for row in self.rows
        ]
        widths = [max(9, *(len(row[k]) for row in [list(self.columns), *cells])) for k in range(len(self.columns))]
        lines = [self.columns, *cells]
        return "\n".join(
            "".join(f"{cell:>{width + 2 * (k > 0)}}" for k, (cell, width) in enumerate(zip(line, widths, strict=True)))
            for line in lines
        )


def write_workbook(tables: Mapping[str, Table], path: str | os.PathLike[str]) -> Path:
    """Write a workbook with a sheet for each table, complete or not at all; needs openpyxl.

    Raises
    ------
    ImportError
        Naming the extra to install.
    """
    try:
        from openpyxl import Workbook  # noqa: PLC0415  (openpyxl is optional)
    except ImportError as error:
        raise needs("xlsx", "openpyxl", "to_excel") from error

    def write(target: Path) -> None:
        book = Workbook()
        book.remove(book.active)
        for name, table in tables.items():
            sheet = book.create_sheet(name[:31])  # a sheet's name may be no longer
            sheet.append(list(table.columns))
            for row in table.rows:
                sheet.append(list(row))
            sheet.freeze_panes = "B2"
        with target.open("wb") as file:
            book.save(file)

    return write_whole(Path(path), write)


def grading_table(curves: Mapping[str, SizeCurve], sieves: str | Sequence[float] | Floats) -> Table:
    """Tabulate the per cent finer of several curves on the same sieves.

    Parameters
    ----------
    curves : mapping of str to SizeCurve
        By their headings, in one unit.
    sieves : str or sequence of float
        Series of sieves by name ("ISO R20/3"), cut to the part where something lies between them; or openings in the
        unit of the curves, coarse to fine in the table.

    Raises
    ------
    ParameterError
        For curves of two units, and for sieves that are none.
    """
    units = {curve.unit for curve in curves.values()}
    if len(units) > 1:
        finding = f"are in {', '.join(sorted(units))}"
        raise parameter_error("gradings", subject="the gradings", finding=finding, remedy="use_one_unit")
    unit = units.pop()
    named = isinstance(sieves, str)
    openings = np.asarray(sieve_sizes(sieves, unit) if isinstance(sieves, str) else sieves, dtype=np.float64)
    if openings.ndim != 1 or openings.size == 0 or not np.all(openings > 0.0):
        raise parameter_error(
            "sieves", openings.shape, "it must be a list of openings greater than 0", finding="is none"
        )
    openings = np.unique(openings)[::-1]
    finer = np.array([curve.finer_than(openings) for curve in curves.values()])
    if named:
        largest = max(float(curve.size[-1]) for curve in curves.values())
        above, below = np.flatnonzero(openings >= largest * (1.0 - 1e-12)), np.flatnonzero(finer.max(axis=0) < SHOWN)
        first = int(above[-1]) if above.size else 0
        last = int(below[0]) + 1 if below.size else openings.size
        openings, finer = openings[first:last], finer[:, first:last]
    head = f"size ({unit})" if unit else "size"
    rows = tuple(
        (float(size), *(float(100.0 * share) for share in shares))
        for size, shares in zip(openings, finer.T, strict=True)
    )
    return Table((head, *curves), rows)


def load_table(result: ResultData, indices: Sequence[str] = INDICES) -> Table:
    """Tabulate the indices of a result by load.

    Parameters
    ----------
    result : Result
    indices : sequence of str
        Sizes such as "D50" or "D90"; "Cu", "Cc", "B" (Einav), "Br" (Hardin); "fines", "crushes", "mass_error".

    Raises
    ------
    ParameterError
        For a name it does not know.
    """
    start, unit = result.start_curve, f" ({result.unit})" if result.unit else ""
    quantity, _ = load_labels(result)
    own = ("fines", "crushes", "mass_error")
    of_curve = {name: named_index(name, start) for name in indices if name not in own}
    heads, rows = [], []
    if result.stress is not None:
        heads.append(quantity)
    heads.append("stress ratio")
    heads += [name + (unit if name[:1] in "Dd" and name[1:2].isdigit() else "") for name in indices]
    for k in range(result.stress_ratio.size):
        row: list[Cell] = [] if result.stress is None else [float(result.stress[k])]
        row.append(float(result.stress_ratio[k]))
        curve = result.curve(k)
        for name in indices:
            if name in own:
                row.append(float(getattr(result, name)[k]))
                continue
            try:
                row.append(float(of_curve[name](curve)))
            except ParameterError:  # in the fines, or an index that these sizes do not have
                row.append(None)
        rows.append(tuple(row))
    return Table(tuple(heads), tuple(rows))


def result_curves(result: ResultData, prefix: str = "") -> dict[str, SizeCurve]:
    """Curves of a result by its loads, the start first."""
    quantity, names = load_labels(result)
    unit = quantity.partition("(")[2].rstrip(")")
    words = [f"{name} {unit}" if unit else f"{quantity} {name}" for name in names]
    return {f"{prefix}start": result.start_curve} | {f"{prefix}{word}": result.curve(k) for k, word in enumerate(words)}

"""Texts that the command line prints, and the files of a new case."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import sys
import warnings
from collections.abc import Callable
from importlib import resources
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from comminute._core import (
    FullConvolution,
    Grading,
    LogGrid,
    Material,
    ParameterError,
    ResolvedGrid,
    __version__,
    has_fftw,
)
from comminute.cases import schema
from comminute.cases.running import load_rows
from comminute.gradings.breakage import breakage_index, relative_breakage
from comminute.gradings.curves import SizeCurve
from comminute.runs.remarks import NO_CRUSHES, ResolutionWarning
from comminute.simulation import Simulation

if TYPE_CHECKING:
    from comminute.cases.reading import ReadyCase
    from comminute.result import Result

HELP = """Confined comminution with grainsize fabric: from a sieve curve and a stress to the crushed grading.

Exit codes: 0 done, 2 wrong input, 3 a file exists (nothing is overwritten), 4 failed, 5 an extra is missing,
130 interrupted (finished loads are kept)."""

EXTRAS = ("numpy", "typer", "pydantic", "xarray", "h5netcdf", "h5py", "matplotlib", "tqdm", "openpyxl", "zarr")
WIDTHS = {"stress": 11, "stress_ratio": 14, "d10": 10, "d50": 10, "d60": 10, "fines": 11, "crushes": 10}


def new_case() -> dict[str, str]:
    """Files of a new case: name to text."""
    folder = resources.files("comminute.cases") / "templates"
    case = Template((folder / "case.toml").read_text()).substitute(_defaults())
    return {"case.toml": case, "sand.csv": (folder / "sand.csv").read_text()}


def _defaults() -> dict[str, str]:
    """Default of every key that the template names, as it is written in TOML."""
    material = schema.MaterialTable()
    tables = (schema.Units(), material, material.fragments, schema.EngineTable(), schema.OutputTable())
    found = {key: value for table in tables for key, value in table.model_dump().items()}
    keys: dict[str, type[schema.Table]] = {
        "coarse_share": schema.GapGraded,
        "loading_rate": schema.LoadTable,
        "remix_after": schema.LoadTable,
    }
    found |= {key: table.model_fields[key].default for key, table in keys.items()}
    return {key: json.dumps(value) for key, value in found.items()}


def material_line(ready: ReadyCase) -> str:
    """Say what the grains are, with the units of the case."""
    material, units = ready.material, ready.resolved.units
    stress = material.first_crush_stress
    crush = "" if stress is None else f", first crush stress {stress:.4g} {units.stress}"
    if material.stress_measure is not None:
        poisson, k0 = material.stress_measure.poisson, material.k0
        ratio = "" if poisson is None else f", poisson {poisson:.4g}"
        test = "" if k0 is None else f", vertical at K0 {k0:.4g}"
        crush += f" ({material.stress_measure.name} stress{ratio}{test})"
    return (
        f"material: reference size {material.reference_size:.4g} {units.size}{crush}, weibull modulus "
        f"{material.weibull_modulus:.4g}, fabric width {material.fabric_width:.4g}, fragments {material.fragments}"
        f"{', strengths scattered' if material.strength_scatter else ''}"
    )


def case_summary(ready: ReadyCase) -> str:
    """Say what a case would do, in a few lines."""
    case, grading, grid = ready.resolved, ready.grading, ready.grid
    unit = f" {grading.unit}" if grading.unit else ""
    d50 = grading.percentile(50, extrapolate=True)
    count = ready.path().stress_ratio.size
    loads = ", ".join(_extent(key, values, case.units.stress) for key, values in ready.loads().items())
    varied = "".join(f"\n  {key} = {value}" for key, value in ready.varied.items())
    lines = [
        f"{ready.target.name}: {count} loads, {loads}{varied}",
        f"  {material_line(ready)}",
        f"  grading: largest {grading.largest:.4g}{unit}, D50 {d50:.4g}{unit}",
        f"  grid: {grid.bins} bins, {grid.edge_sizes[1]:.3g} to {grid.edge_sizes[-1]:.4g}{unit}, {_bins(grid)}",
        f"  closure: {case.engine.closure}, engine {case.engine.name}, scheme {case.engine.scheme}"
        if isinstance(grid, LogGrid)
        else f"  closure: {case.engine.closure}, which is quasi-static and its own engine",
        *_expected(ready),
        *(f"  note: {note}" for note in grading.notes),
    ]
    return "\n".join(lines)


def _expected(ready: ReadyCase) -> list[str]:
    """Estimate what the largest load does, so that a fabric width with which next to nothing breaks is seen at once."""
    if ready.material.strength_scatter:
        return []  # the paper's closure, which answers in a millisecond, knows none
    path, grading = ready.path(), ready.grading
    most = float(path.stress_ratio.max())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResolutionWarning)  # a run says so
        after = Simulation(ready.material, grading).run(stress_ratio=most, keep_fabrics=[]).curve()
    unit = f" {grading.unit}" if grading.unit else ""
    before, now = (curve.percentile(50, extrapolate=True) for curve in (grading, after))
    index = _breakage_text(grading, after)
    return [f"  expected at stress ratio {most:.4g}: {index}D50 {before:.4g} to {now:.4g}{unit}, before any remixing"]


def _breakage_text(before: Grading, after: SizeCurve) -> str:
    """Hardin's index; Einav's where that has no value, since sizes have no unit; nothing where neither has."""
    indices: dict[str, Callable[[], float]] = {
        "B_r": lambda: relative_breakage(before, after),
        "B": lambda: breakage_index(before, after).index,
    }
    for name, index in indices.items():
        try:
            return f"{name} {index():.2g}, "
        except ParameterError:
            continue
    return ""


def _bins(grid: LogGrid | ResolvedGrid) -> str:
    """Width of the bins and memory of a state."""
    if isinstance(grid, LogGrid):
        return f"{grid.bins**2 * 8 / 1e6:.1f} MB a fabric"
    widths = np.diff(grid.edges)[1:]
    memory = 14 * grid.nodes**3 * 8 / 1e6
    return f"{widths.min():.2g} to {widths.max():.2g} wide in ln(size), {memory:.0f} MB in all"


def _extent(key: str, loads: list[float], stress_unit: str) -> str:
    """Least and largest of the loads by a key."""
    unit = "" if key in ("stress_ratio", "k0") else f" {stress_unit}"
    return f"{key} {min(loads):g} to {max(loads):g}{unit}"


class ProgressBar:
    """Bar of what is finished, on a terminal alone, where tqdm is there; as a context it ends with the block."""

    def __init__(self, unit: str, *, quiet: bool) -> None:
        self._unit = unit
        self._wanted = not quiet and sys.stderr.isatty()
        self._bar: Any = None

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def reach(self, done: int, total: int) -> None:
        """Draw it at so many of all."""
        if self._wanted and self._bar is None:
            try:
                from tqdm.auto import tqdm  # noqa: PLC0415  (optional)

                self._bar = tqdm(total=total, unit=self._unit, leave=False)
            except ImportError:
                self._wanted = False
        if self._bar is not None:
            self._bar.update(done - self._bar.n)

    def print(self, line: str) -> None:
        """Print a line above it."""
        if self._bar is not None:
            self._bar.write(line)
            return
        try:
            print(line, flush=True)
        except BrokenPipeError:  # the reader has gone, as `| head` does; the run goes on, for its file
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())

    def close(self) -> None:
        """Take it away."""
        if self._bar is not None:
            self._bar.close()


class LoadTableText:
    """A table that grows by a line with every finished load, and a bar on a terminal."""

    def __init__(self, ready: ReadyCase, *, quiet: bool) -> None:
        self._quiet = quiet
        self._units = (ready.resolved.units.stress, ready.grading.unit)
        self._shown = 0
        self._total = ready.path().stress_ratio.size
        self._bar = ProgressBar("load", quiet=quiet)
        self._bar.reach(0, self._total)

    def rows_of(self, result: Result) -> None:
        """Print the loads that are not printed yet."""
        rows = load_rows(result)
        if not self._shown:
            self._bar.print(_header(rows[0], *self._units))
        for row in rows[self._shown :]:
            self._bar.print(_line(row, *self._units))
        self._shown = len(rows)

    def add(self, result: Result) -> None:
        """Print the load that has just finished."""
        if self._quiet:
            return
        self.rows_of(result)
        self._bar.reach(self._shown, self._total)

    def close(self) -> None:
        """Take the bar away."""
        self._bar.close()


def _columns(row: dict[str, Any], stress_unit: str, size_unit: str) -> dict[str, tuple[str, int]]:
    """Title and width of each column of a table of loads; two blanks at least stand between titles."""
    units = {"stress": stress_unit, "d10": size_unit, "d50": size_unit, "d60": size_unit}
    titles = {name: f"{name} {units[name]}" if units.get(name) else name.replace("_", " ") for name in WIDTHS}
    return {name: (titles[name], max(width, len(titles[name]) + 2)) for name, width in WIDTHS.items() if name in row}


def _header(row: dict[str, Any], stress_unit: str, size_unit: str) -> str:
    return "".join(f"{title:>{width}}" for title, width in _columns(row, stress_unit, size_unit).values())


def _line(row: dict[str, Any], stress_unit: str, size_unit: str) -> str:
    columns = _columns(row, stress_unit, size_unit)
    cells = {name: "in fines" if row[name] is None else f"{_without_rounding(name, row[name]):.4g}" for name in columns}
    return "".join(f"{cells[name]:>{width}}" for name, (_, width) in columns.items())


def _without_rounding(name: str, value: float) -> float:
    """Amounts that are smaller than any packing has a grain of are 0."""
    return 0.0 if name in ("fines", "crushes") and value <= NO_CRUSHES else value


def result_table(result: Result) -> str:
    """Whole table of a result."""
    rows = load_rows(result)
    stress_unit = result.recipe.stress_unit if result.recipe else ""
    return "\n".join(
        [_header(rows[0], stress_unit, result.unit), *(_line(row, stress_unit, result.unit) for row in rows)]
    )


def print_remarks(result: Result) -> None:
    """Print notes and warnings of a result, below its table."""
    for note in result.notes:
        print(f"note: {note}")
    for warning in result.warnings:
        print(f"warning: {warning}")


def citation() -> str:
    """Give the references of the model and of this software, in words and as BibTeX."""
    return f"""The model:
  E. Huang, B. Marks, I. Einav, Continuum homogenisation of stochastic comminution with grainsize fabric,
  Journal of the Mechanics and Physics of Solids 138 (2020) 103897, https://doi.org/10.1016/j.jmps.2020.103897
The software:
  comminute {__version__}

@article{{huang2020continuum,
  author  = {{Huang, Eric and Marks, Benjy and Einav, Itai}},
  title   = {{Continuum homogenisation of stochastic comminution with grainsize fabric}},
  journal = {{Journal of the Mechanics and Physics of Solids}},
  volume  = {{138}},
  pages   = {{103897}},
  year    = {{2020}},
  doi     = {{10.1016/j.jmps.2020.103897}}
}}
@software{{comminute,
  author  = {{{{The comminute developers}}}},
  title   = {{comminute}},
  version = {{{__version__}}}
}}"""


def installation() -> dict[str, str]:
    """Versions and abilities, by name."""
    found = {"comminute": __version__, "python": platform.python_version(), "machine": platform.machine()}
    found["fftw"] = "no: full convolution for fragments with an exponential sum only"
    if has_fftw:
        FullConvolution(LogGrid(-2.0, 0.0, 16), Material(), path="transforms")  # a broken FFTW shows here
        found["fftw"] = "yes: every engine"
    found["threads"] = f"{os.cpu_count()} here; a run takes one"
    for name in EXTRAS:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found

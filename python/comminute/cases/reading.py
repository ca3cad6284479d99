"""From a case file to cases that can run: reading, sweeps, messages, and the resolved form. Needs pydantic."""

from __future__ import annotations

import itertools
import math
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from comminute._core import Grading, LogGrid, Material, ParameterError, ResolvedGrid, ShapeError, fitting_grid
from comminute.cases.load_tables import numbers_of, path_of, with_numbers
from comminute.cases.messages import WORDS, explained, table_place
from comminute.cases.schema import MAKERS, Case, GradingFile, GridTable, MaterialTable, Sieves
from comminute.gradings.options import Reading
from comminute.gradings.reading import SieveData, read_sieves
from comminute.gradings.sieves import IN_MM, convert, unit_of
from comminute.runs.recipe import Recipe, law_of
from comminute.runs.resolved_run import require_quasi_static
from comminute.simulation import Simulation
from comminute.util.errors import parameter_error, reworded, wrong_file
from comminute.util.names import is_file, shorten

if TYPE_CHECKING:
    from collections.abc import Callable

    from comminute.runs.load_path import LoadPath

Made = TypeVar("Made")
SWEPT = ("units", "material", "grading", "grid", "engine")
LISTS = frozenset({"x", "finer", "size", "percent_finer", "places", "notes", "sizes"})  # lists by nature, never a sweep
MOST_RUNS = 1000
MOST_BYTES = 4_000_000


@dataclass(frozen=True)
class ReadyCase:
    """A case with all its files read and all its values checked: nothing is left that could fail before the run.

    `resolved` has the bins that were sized; `bins_asked` what the case itself said of them.
    """

    resolved: Case
    material: Material
    grading: Grading
    grid: LogGrid | ResolvedGrid
    target: Path
    varied: dict[str, Any]
    bins_asked: GridTable

    def simulation(self) -> Simulation:
        """Make the simulation of the case."""
        return _simulation(self.material, self.grading, self.resolved, self.even_grid)

    @property
    def even_grid(self) -> LogGrid | None:
        """Bins of the paper's closure; None for a case that is run by the resolved one."""
        return self.grid if isinstance(self.grid, LogGrid) else None

    def recipe(self) -> Recipe:
        """Give the settings of the run."""
        engine = self.resolved.engine
        return Recipe.of(
            self.path(),
            engine=engine.name,
            kind=engine.kind,
            steps_per_load=engine.steps_per_load,
            stress_unit=self.resolved.units.stress,
            case=self.text(),
        )

    def loads(self) -> dict[str, list[float]]:
        """Give the numbers of the loads by key, as `Simulation.run` takes them."""
        return numbers_of(self.resolved.load)

    def path(self) -> LoadPath:
        """Give the load path."""
        return path_of(self.material, self.resolved.load)

    def at(self, target: Path) -> ReadyCase:
        """Give the same case another result file."""
        return replace(self, target=target)

    def text(self) -> str:
        """Write the resolved case as JSON text, from which `case_of_text` makes it again."""
        return self.resolved.model_dump_json(by_alias=True, exclude_none=True)


def read_case(path: Path) -> list[ReadyCase]:
    """All cases of a case file: one, or one for each combination of a sweep.

    Raises
    ------
    ParameterError
        For a case that cannot run; it names file, table, key and value, the rule, and the remedy.
    """
    raw = tables_of(path)
    axes = axes_of(raw, path.name)
    count = math.prod(len(values) for values in axes.values())
    if count > MOST_RUNS:
        finding = f"make {count} runs"
        rule = f"with a file for each there may be {MOST_RUNS}; comminute sweep puts more into one"
        raise parameter_error(subject="the lists", finding=finding, rule=rule, place=path.name)
    cases = []
    for number, values in enumerate(itertools.product(*axes.values()), 1):
        varied = dict(zip(axes, values, strict=True))
        case = _validated(with_values(raw, varied), path.name)
        target = _target(path, case.output.file, number, count)
        cases.append(_ready(case, path, target, varied))
    return cases


def tables_of(path: Path) -> dict[str, Any]:
    """Tables of a case file as they stand there.

    Raises
    ------
    ParameterError
        For a file that is no TOML.
    """
    if not is_file(path):
        raise wrong_file(str(path), "is no file", "give a case file (.toml); comminute new DIR makes one")
    if path.stat().st_size > MOST_BYTES:
        raise wrong_file(path.name, f"has {path.stat().st_size / 1e6:.0f} MB", "a case file has a few lines")
    try:
        raw = tomllib.loads(path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n"))
    except UnicodeDecodeError:
        raise wrong_file(path.name, "is not UTF-8 text", "save it as such") from None
    except (ValueError, RecursionError) as error:  # TOML's own, and dates and numbers that no calendar or machine has
        raise wrong_file(path.name, f"is no TOML: {shorten(str(error), 120)}", "") from None
    return raw


def case_of_tables(raw: dict[str, Any], path: Path, varied: dict[str, Any]) -> ReadyCase:
    """Case of tables as a file at `path` would have them, its files beside that path.

    Raises
    ------
    ParameterError
        As `read_case`.
    """
    return _ready(_validated(raw, path.name), path, path.with_suffix(".nc"), varied)


def case_of_text(text: str, target: Path) -> ReadyCase:
    """Case of the text that a result file carries."""
    return _ready(Case.model_validate_json(text), target, target, {})


def axes_of(raw: dict[str, Any], name: str) -> dict[str, list[Any]]:
    """Find the lists that stand where a case has one value, by the key that they are of, "material.fabric_width"."""
    axes: dict[str, list[Any]] = {}

    def look(table: dict[str, Any], where: tuple[str, ...]) -> None:
        for key, value in table.items():
            if isinstance(value, dict):
                look(value, (*where, key))
            elif isinstance(value, list) and key not in LISTS and not any(isinstance(v, dict | list) for v in value):
                if not value:
                    place = table_place(name, *where)
                    raise parameter_error(key, "an empty list", "a sweep needs values", place=place)
                axes[".".join((*where, key))] = value

    for section in SWEPT:
        if isinstance(raw.get(section), dict):
            look(raw[section], (section,))
    return axes


def with_values(raw: dict[str, Any], values: dict[str, Any]) -> dict[str, Any]:
    """Tables with other values of some keys, "material.fabric_width", and without a change to `raw`."""
    changed = dict(raw)
    for name, value in values.items():
        *tables, key = name.split(".")
        inner = changed
        for table in tables:
            below = inner.get(table)
            inner[table] = dict(below) if isinstance(below, dict) else {}
            inner = inner[table]
        inner[key] = value
    return changed


def _target(path: Path, file: str, number: int, runs: int) -> Path:
    target = path.parent / file
    if target.suffix != ".nc":
        raise _wrong_key(path, "output", "file", f"'{shorten(file)}'", "it must end in .nc")
    try:
        target.exists()  # a name that no file can have raises here
        reachable = target.parent.is_dir()
    except (OSError, ValueError):
        reachable = False
    if not reachable:
        raise _wrong_key(path, "output", "file", f"'{shorten(file)}'", "its folder does not exist")
    width = len(str(runs))
    return target if runs == 1 else target.with_name(f"{target.stem}-{number:0{width}}{target.suffix}")


def _wrong_key(path: Path, table: str, key: str, value: object, rule: str, finding: str = "") -> ParameterError:
    return parameter_error(key, value, rule, finding=finding, place=table_place(path.name, table))


def _validated(raw: dict[str, Any], name: str) -> Case:
    grading = raw.get("grading")
    if isinstance(grading, dict) and "kind" not in grading:
        if "file" not in grading:
            kinds = ", ".join((*MAKERS, "sieves"))
            rule = f'give file = "sand.csv" or kind, one of {kinds}'
            place = table_place(name, "grading")
            raise parameter_error("grading", subject="no grading", finding="is named", rule=rule, place=place)
        raw = raw | {"grading": {"kind": "file"} | grading}
    fragments = raw.get("material", {}).get("fragments") if isinstance(raw.get("material"), dict) else None
    if isinstance(fragments, dict) and "law" not in fragments:
        raw = raw | {"material": raw["material"] | {"fragments": {"law": MaterialTable().fragments.law} | fragments}}
    try:
        return Case.model_validate(raw)
    except ValidationError as error:
        raise explained(error, raw, name) from None


def _ready(case: Case, path: Path, target: Path, varied: dict[str, Any]) -> ReadyCase:
    """Case with its files read: every check that needs no run."""
    name, bins_asked = path.name, case.grid
    material = _in_table(name, "material", lambda: material_of(case.material.model_dump()))
    case, grading = _grading(case, path)
    case = with_numbers(case, path)
    ratios = _in_table(name, "load", lambda: path_of(material, case.load)).stress_ratio
    _require_reference_size(case, name)
    if case.engine.closure == "resolved":
        grid: LogGrid | ResolvedGrid = _nodes(case, material, grading, name)
    else:
        largest_load, given = float(ratios.max()), case.grid.model_dump()
        even = _in_table(name, "grid", lambda: fitting_grid(grading, material, largest_load, **given))
        _in_table(name, "grid", lambda: grading.on_grid(even))
        case = case.model_copy(update={"grid": GridTable(bins=even.bins, psi_min=even.psi_min, psi_max=even.psi_max)})
        _in_table(name, "engine", lambda: _simulation(material, grading, case, even))
        grid = even
    ready = ReadyCase(case, material, grading, grid, target, varied, bins_asked)
    if case.engine.closure == "resolved":
        _in_table(name, "engine", lambda: require_quasi_static(ready.recipe()))
    if not isinstance(case.output.fabrics, str):
        for k in case.output.fabrics:
            if not 0 <= k < ratios.size:
                rule = f"it must hold indices of loads, 0 to {ratios.size - 1}"
                raise _wrong_key(path, "output", "fabrics", k, rule, finding=f"has {k}")
    return ready


def _simulation(material: Material, grading: Grading, case: Case, grid: LogGrid | None) -> Simulation:
    engine = case.engine
    options = {"mean": engine.mean, "scheme": engine.scheme, "closure": engine.closure, "sizes": engine.sizes}
    return Simulation(material, grading, grid=grid, **options)  # type: ignore[arg-type]


def _nodes(case: Case, material: Material, grading: Grading, name: str) -> ResolvedGrid:
    """Sizes of a case that is run by the resolved closure, which has no bins of its own choice and keeps no fabrics."""
    for key, value in case.grid.model_dump(exclude_none=True).items():
        rule = 'closure = "resolved" makes its own uneven bins: leave [grid] out'
        raise parameter_error(key, value, rule, place=table_place(name, "grid"))
    if case.engine.name != "auto":
        rule = 'closure = "resolved" is its own engine: leave it out'
        raise parameter_error("name", f"'{case.engine.name}'", rule, place=table_place(name, "engine"))
    if case.output.fabrics not in ("last", []):
        rule = 'closure = "resolved" keeps none: leave it out'
        raise parameter_error("fabrics", f"{case.output.fabrics!r}", rule, place=table_place(name, "output"))
    grid = _in_table(name, "engine", lambda: _simulation(material, grading, case, None)).grid
    assert isinstance(grid, ResolvedGrid)  # of the resolved closure
    return grid


def _in_table(name: str, table: str, make: Callable[[], Made]) -> Made:
    """Make something whose errors name the table and the file that it comes from."""
    try:
        return make()
    except (ParameterError, ShapeError) as error:
        raise reworded(error, outer=table_place(name, table), words=WORDS) from None


def _require_reference_size(case: Case, name: str) -> None:
    """Refuse a measured grading without its reference size: left out, it would be 1 of whatever unit the case has."""
    measured = isinstance(case.grading, GradingFile | Sieves)
    if measured and "reference_size" not in case.material.model_fields_set:
        unit = case.units.size
        one = f"{convert(1.0, 'mm', unit):.6g}" if unit_of(unit) else "1"
        rule = "stress ratios and first_crush_stress refer to it, and measured sizes have a unit: add the line "
        rule += (
            f"reference_size = {one} (in {unit}: 1 {'mm' if unit_of(unit) else unit}, or the size that they refer to)"
        )
        raise parameter_error("reference_size", "missing", rule, place=table_place(name, "material"))


def material_of(table: dict[str, Any]) -> Material:
    """Material of the values in a table [material], all of them."""
    return Material(**(table | {"fragments": law_of(table["fragments"])}))


def _grading(case: Case, path: Path) -> tuple[Case, Grading]:
    """Grading of a case, and the case with the sieves of its file written into it."""
    table, unit = case.grading, case.units.size
    if isinstance(table, GradingFile):
        if not unit_of(unit):
            raise _wrong_key(path, "units", "size", f"'{unit}'", f"it must be one of {', '.join(IN_MM)}")
        how = Reading(table.sheet, table.sample, table.mesh, table.total_mass_g, table.edges)
        data = read_sieves(path.parent / table.file, unit=unit, number=table.number, how=how)
        table = Sieves(
            kind="sieves",
            size=list(data.size),
            percent_finer=list(data.percent_finer),
            top=table.top,
            number=table.number or data.number,
            places=list(data.places),
            notes=list(data.notes),
            file=table.file,
        )
        case = case.model_copy(update={"grading": table})
    if isinstance(table, Sieves):
        name = Path(table.file).name if table.file else f"{path.name} [grading]"
        sieves = SieveData(
            tuple(table.size), tuple(table.percent_finer), unit, tuple(table.places), tuple(table.notes), name
        )
        if len(table.size) != len(table.percent_finer):
            finding = f"has {len(table.percent_finer)} values for {len(table.size)} sizes"
            raise parameter_error("percent_finer", finding=finding, rule="it must have one for each", place=name)
        try:
            return case, sieves.grading(top=table.top, number=table.number)
        except (ParameterError, ShapeError) as error:
            raise reworded(error, words=WORDS) from None
    fields = table.model_dump(exclude={"kind"}, exclude_none=True)
    return case, _in_table(path.name, "grading", lambda: MAKERS[table.kind](**fields)).with_unit(unit)

"""Settings and materials of runs as plain records, which a file can hold."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal, Self, cast

import numpy as np

from comminute._core import (
    Grading,
    LogGrid,
    LogNormalFragments,
    Material,
    PowerLawFragments,
    ResolvedGrid,
    SolveReport,
    StepReport,
    TabulatedFragments,
    WeibullFragments,
)
from comminute.runs.load_path import LoadPath
from comminute.util.choices import EngineName, Kind
from comminute.util.errors import parameter_error

Law = WeibullFragments | PowerLawFragments | LogNormalFragments | TabulatedFragments

LAWS: dict[str, tuple[type[Law], tuple[str, ...]]] = {
    "weibull": (WeibullFragments, ("scale", "shape")),
    "power-law": (PowerLawFragments, ("exponent",)),
    "lognormal": (LogNormalFragments, ("mean_log", "sd_log")),
    "tabulated": (TabulatedFragments, ("x", "finer")),
}


@dataclass(frozen=True)
class Recipe:
    """Settings of a run: with the start and material of its result, enough to run it again.

    Attributes
    ----------
    loading_rate : tuple of float
        Share of the fast kernel (Eq. 67), one per load.
    remix_after : tuple of int
        Indices of loads after which the packing was remixed.
    engine : str
        Engine asked for; `Result.engine` names the one that ran.
    kind : str or None
        Kernel asked for.
    steps_per_load : int or "rest"
        Steps of a time-stepping engine at each load.
    by_stress : bool
        The loads were given as stresses; not compared, since the same loads may be given either way.
    needed_spacing : float
        Bin width that the start and the fragments need (`comminute.needed_spacing`); not compared.
    stress_unit : str
        Unit of the stresses, as text.
    case : str
        Resolved case as JSON text, for a run of a case file; else empty.
    """

    loading_rate: tuple[float, ...]
    remix_after: tuple[int, ...] = ()
    engine: EngineName = "auto"
    kind: Kind | None = None
    steps_per_load: int | Literal["rest"] = "rest"
    by_stress: bool = field(default=False, compare=False)
    needed_spacing: float = field(default=math.inf, compare=False)
    stress_unit: str = ""
    case: str = ""

    @classmethod
    def of(cls, path: LoadPath, **settings: Any) -> Self:
        """Recipe of a load path; `settings` are the fields that the path does not give."""
        rates, remixed = tuple(path.loading_rate.tolist()), tuple(sorted(path.remix_after))
        return cls(rates, remixed, by_stress=path.by_stress, **settings)

    def of_first(self, loads: int) -> Recipe:
        """Recipe of the first loads alone, for a run that has not come to its end."""
        remixed = tuple(k for k in self.remix_after if k < loads)
        return replace(self, loading_rate=self.loading_rate[:loads], remix_after=remixed)

    def to_json(self) -> str:
        """JSON text, from which `from_json` makes the recipe again."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Recipe:
        """Recipe of a text that `to_json` wrote."""
        fields = json.loads(text)
        fields.pop("chained", None)  # of the first files
        fields["loading_rate"] = tuple(float(rate) for rate in fields["loading_rate"])
        fields["remix_after"] = tuple(int(k) for k in fields["remix_after"])
        return cls(**fields)


def law_record(law: Law) -> dict[str, Any]:
    """Name and numbers of a fragment law."""
    for name, (kind, fields) in LAWS.items():
        if isinstance(law, kind):
            values = {field: getattr(law, field) for field in fields}
            return {"law": name} | {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in values.items()}
    raise parameter_error("fragments", f"a {type(law).__name__}", f"it must be one of {', '.join(LAWS)}")


def law_of(record: dict[str, Any]) -> Law:
    """Fragment law of a record that `law_record` made."""
    kind, fields = LAWS[record["law"]]
    return kind(**{field: record[field] for field in fields})


def material_record(material: Material) -> dict[str, Any]:
    """Numbers of a material; what version 0.1.0 did not have is left out unless it is set."""
    record: dict[str, Any] = {
        "weibull_modulus": material.weibull_modulus,
        "fabric_width": material.fabric_width,
        "reference_size": material.reference_size,
        "fragments": law_record(material.fragments),
        "first_crush_stress": material.first_crush_stress,
    }
    if material.strength_scatter:
        record["strength_scatter"] = True
    measure = material.stress_measure
    if measure is None:
        return record
    return record | {"stress_measure": measure.name, "poisson": measure.poisson, "k0": material.k0}


def material_of(record: dict[str, Any]) -> Material:
    """Material of a record that `material_record` made."""
    return Material(**(record | {"fragments": law_of(record["fragments"])}))


def grid_record(grid: LogGrid | ResolvedGrid) -> dict[str, Any]:
    """Numbers of a grid."""
    if isinstance(grid, ResolvedGrid):
        return {"lower": grid.lower.tolist(), "upper": grid.upper.tolist()}
    return {"psi_min": grid.psi_min, "psi_max": grid.psi_max, "bins": grid.bins}


def grid_of(record: dict[str, Any]) -> LogGrid | ResolvedGrid:
    """Grid of a record that `grid_record` made."""
    return ResolvedGrid(**record) if "lower" in record else LogGrid(**record)


GRADINGS = ("points", "power-law", "lognormal", "rosin-rammler", "sieves")  # in the order of the core's laws


def grading_record(grading: Grading) -> dict[str, Any]:
    """Law, unit and notes of a grading."""
    state: Any = grading.__getstate__()
    (law, numbers), unit, notes = state
    return {"law": GRADINGS[law], "numbers": numbers, "unit": unit, "notes": notes}


def grading_of(record: dict[str, Any]) -> Grading:
    """Grading of a record that `grading_record` made, or of its JSON."""
    law = GRADINGS.index(record["law"]), tuple(record["numbers"])
    grading: Any = Grading.__new__(Grading)
    grading.__setstate__((law, record["unit"], record["notes"]))
    return cast(Grading, grading)


REPORTS: dict[str, tuple[type[SolveReport] | type[StepReport], tuple[str, ...]]] = {
    "solve": (SolveReport, ("path", "terms", "head", "fit_error", "crushed", "crushed_neighbour")),
    "steps": (StepReport, ("active", "crushed", "crushed_neighbour", "steps", "terms")),
}


def report_record(report: SolveReport | StepReport) -> dict[str, Any]:
    """Fields of a report, with the name of its class."""
    name = "solve" if isinstance(report, SolveReport) else "steps"
    return {"report": name} | {field: getattr(report, field) for field in REPORTS[name][1]}


def report_of(record: dict[str, Any]) -> SolveReport | StepReport:
    """Report of a record that `report_record` made."""
    kind, fields = REPORTS[record["report"]]
    return kind(**{field: record[field] for field in fields})

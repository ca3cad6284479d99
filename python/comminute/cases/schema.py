"""Case files: TOML tables, checked against models whose defaults are the library's own. Needs pydantic."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from comminute._core import (
    Grading,
    LogNormalFragments,
    Material,
    PowerLawFragments,
    WeibullFragments,
    defaults,
    fuller,
    gap_graded,
    log_uniform,
    lognormal,
    monodisperse,
    power_law,
    rosin_rammler,
    uniform_size,
)
from comminute.gradings.reading import Top
from comminute.simulation import Simulation
from comminute.util.choices import Closure, EngineName, Kind, Mean, Scheme, StressName

Rest = int | Literal["rest"]
MATERIAL = Material()
WEIBULL, POWER, LOGNORMAL = WeibullFragments(), PowerLawFragments(), LogNormalFragments()
SIEVES = defaults["from_sieves"]
RUN = {name: p.default for name, p in inspect.signature(Simulation.run).parameters.items()}
SIMULATION = {name: p.default for name, p in inspect.signature(Simulation).parameters.items()}
MOST_BINS = 10_000


class Table(BaseModel):
    """A table of a case: unknown keys are errors, and so are values of another type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, ser_json_inf_nan="constants")


class Units(Table):
    """Units of the case's sizes and stresses; sizes of a sieve table are converted to the former."""

    size: str = SIEVES["unit"]
    stress: str = "MPa"


class Weibull(Table):
    """Fragments after Eq. 3."""

    law: Literal["weibull"] = "weibull"
    scale: float = WEIBULL.scale
    shape: float = WEIBULL.shape


class PowerLaw(Table):
    """Fragments with P[X <= x] = x**exponent."""

    law: Literal["power-law"]
    exponent: float = POWER.exponent


class LogNormal(Table):
    """Fragments with ln X normal, cut off at X = 1."""

    law: Literal["lognormal"]
    mean_log: float = LOGNORMAL.mean_log
    sd_log: float = LOGNORMAL.sd_log


class Tabulated(Table):
    """Measured fragments."""

    law: Literal["tabulated"]
    x: list[float]
    finer: list[float]


FRAGMENTS = (Weibull, PowerLaw, LogNormal, Tabulated)


class MaterialTable(Table):
    """Properties of the grains; see `Material`."""

    weibull_modulus: float = MATERIAL.weibull_modulus
    fabric_width: float = MATERIAL.fabric_width
    reference_size: float = MATERIAL.reference_size
    first_crush_stress: float | None = MATERIAL.first_crush_stress
    stress_measure: StressName | None = None
    k0: float | None = MATERIAL.k0
    poisson: float | None = None
    strength_scatter: bool = MATERIAL.strength_scatter
    fragments: Annotated[Weibull | PowerLaw | LogNormal | Tabulated, Field(discriminator="law")] = Weibull()


class GradingFile(Table):
    """A sieve table, and how to read it; see `Grading.read`."""

    kind: Literal["file"] = "file"
    file: str
    sheet: str | int | None = None
    sample: str | int | None = None
    mesh: Literal["astm", "tyler"] | None = None
    total_mass_g: float | None = None
    edges: Literal["lower", "upper"] | None = None
    top: Top = SIEVES["top"]
    number: bool = SIEVES["number"]


class Sieves(Table):
    """Sieves in the case itself; a resolved case has the sieves of its table in this form."""

    kind: Literal["sieves"]
    size: list[float]
    percent_finer: list[float]
    top: Top = SIEVES["top"]
    number: bool = SIEVES["number"]
    places: list[str] = []
    notes: list[str] = []
    file: str = ""


class Monodisperse(Table):
    """All grains of one size."""

    kind: Literal["monodisperse"]
    size: float


class GapGraded(Table):
    """Two sizes."""

    kind: Literal["gap-graded"]
    coarse: float
    fine: float
    coarse_share: float = defaults["gap_graded"]["coarse_share"]


class PowerLawGrading(Table):
    """Power law between two sizes."""

    kind: Literal["power-law"]
    fractal_dimension: float
    smallest: float
    largest: float


class Between(Table):
    """Uniform in size or in its log."""

    kind: Literal["uniform-size", "log-uniform"]
    smallest: float
    largest: float


class Fuller(Table):
    """Fuller-Talbot."""

    kind: Literal["fuller"]
    largest: float
    exponent: float = defaults["fuller"]["exponent"]


class LogNormalGrading(Table):
    """Lognormal by mass."""

    kind: Literal["lognormal"]
    median: float
    sd_log: float
    largest: float | None = None


class RosinRammler(Table):
    """Rosin-Rammler."""

    kind: Literal["rosin-rammler"]
    d63: float
    exponent: float
    largest: float | None = None


GRADINGS = (
    GradingFile,
    Sieves,
    Monodisperse,
    GapGraded,
    PowerLawGrading,
    Between,
    Fuller,
    LogNormalGrading,
    RosinRammler,
)
AnyGrading = (
    GradingFile
    | Sieves
    | Monodisperse
    | GapGraded
    | PowerLawGrading
    | Between
    | Fuller
    | LogNormalGrading
    | RosinRammler
)


class GridTable(Table):
    """Bins; what is left out is sized from grading, material and largest load."""

    bins: int | None = Field(default=None, le=MOST_BINS)
    psi_min: float | None = None
    psi_max: float | None = None


class LoadRange(Table):
    """Loads from one to another; `spacing` "log" or "linear"."""

    model_config = ConfigDict(populate_by_name=True)
    first: float = Field(alias="from")
    last: float = Field(alias="to")
    steps: int = Field(ge=1, le=100_000)
    spacing: Literal["log", "linear"] = "log"


Loads = float | list[float] | LoadRange
LOADS = ("stress", "stress_ratio", "p", "q", "vertical", "k0")  # keys of a load path that hold numbers


class LoadTable(Table):
    """The load path: `stress`, `stress_ratio`, `p` with `q`, `vertical` with `k0`, or a file of stresses or ratios."""

    stress: Loads | None = None
    stress_ratio: Loads | None = None
    p: Loads | None = None
    q: Loads | None = None
    vertical: Loads | None = None
    k0: Loads | None = None
    file: str | None = None
    loading_rate: float | list[float] = RUN["loading_rate"]
    remix_after: list[int] = list(RUN["remix_after"])


class EngineTable(Table):
    """Engine and its options; see `Simulation` and `Simulation.run`."""

    name: EngineName = RUN["engine"]
    scheme: Scheme = SIMULATION["scheme"]
    mean: Mean = SIMULATION["mean"]
    closure: Closure = SIMULATION["closure"]
    sizes: list[float] = list(SIMULATION["sizes"])
    kind: Kind | None = RUN["kind"]
    steps_per_load: Rest = RUN["steps_per_load"]


class OutputTable(Table):
    """Result file, beside the case file unless an absolute path; for which loads the fabric is kept.

    A run by the resolved closure keeps none.
    """

    file: str = "run.nc"
    fabrics: Literal["all", "last"] | list[int] = "last"


class Case(Table):
    """A whole case."""

    units: Units = Units()
    material: MaterialTable = MaterialTable()
    grading: Annotated[AnyGrading, Field(discriminator="kind")]
    grid: GridTable = GridTable()
    load: LoadTable
    engine: EngineTable = EngineTable()
    output: OutputTable = OutputTable()


MAKERS: dict[str, Callable[..., Grading]] = {
    "monodisperse": monodisperse,
    "gap-graded": gap_graded,
    "power-law": power_law,
    "uniform-size": uniform_size,
    "log-uniform": log_uniform,
    "fuller": fuller,
    "lognormal": lognormal,
    "rosin-rammler": rosin_rammler,
}

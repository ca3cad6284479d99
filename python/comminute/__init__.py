"""Confined comminution with grainsize fabric.

From a grading and a load path to the crushed grading, after Huang, Marks & Einav, "Continuum
homogenisation of stochastic comminution with grainsize fabric", J. Mech. Phys. Solids 138 (2020)
103897.

Examples
--------
>>> import comminute as cm
>>> sim = cm.Simulation(cm.Material(), cm.power_law(2.5, 1e-3, 1.0))
>>> result = sim.run(stress_ratio=[1, 100])
>>> bool(result.percentile(50)[1] < result.percentile(50)[0])
True
"""

import comminute.util.keywords  # before the names of the core are taken from it

# isort: split
import comminute.comparators
import comminute.energy
import comminute.packing  # noqa: F401  (the names of these three are theirs)
from comminute._core import (
    Atom,
    CrushZones,
    Fabric,
    FullConvolution,
    Grading,
    LogGrid,
    LogNormalFragments,
    Marginal,
    Material,
    ParameterError,
    PointMass,
    PowerLawFragments,
    QuasiStatic,
    Resolved,
    ResolvedGrid,
    Ridge,
    ShapeError,
    SlowUpdate,
    SolveReport,
    StepReport,
    StressMeasure,
    TabulatedFragments,
    UnavailableError,
    WeibullFragments,
    Zone,
    __version__,
    active_share,
    cell_kernel,
    critical_stress_ratio,
    crush_zones,
    fitting_grid,
    fragment_pmf,
    fuller,
    gap_graded,
    has_fftw,
    log_uniform,
    lognormal,
    logspace_load,
    mixed_fabric,
    monodisperse,
    needed_spacing,
    neighbourhood_pmf,
    percentile,
    power_law,
    remix,
    resolved_gradings,
    rosin_rammler,
    stress_function,
    stress_ratio_at,
    uniform_size,
)
from comminute.closures import ClosureComparison, compare_closures
from comminute.columns.column import Column
from comminute.columns.drive import Feed, ShearMixing
from comminute.columns.lattice import ColumnLattice
from comminute.columns.lattice_result import ColumnLatticeResult
from comminute.columns.result import ColumnResult
from comminute.files.storage import EditedFileWarning
from comminute.files.tables import Table
from comminute.fitting.compression import CompressionFit, fit_compression
from comminute.fitting.fit import fit
from comminute.fitting.measurements import Measurement, UnknownStart
from comminute.fitting.outcome import FitResult
from comminute.fitting.problem import FitProblem
from comminute.fitting.search import FitWarning
from comminute.fitting.strengths import StrengthSlope, strength_slope
from comminute.gradings.breakage import (
    Breakage,
    FractalFit,
    breakage_index,
    breakage_potential,
    fractal_dimension,
    relative_breakage,
)
from comminute.gradings.curves import SieveTable, SizeCurve
from comminute.gradings.dem import dem_text
from comminute.gradings.indices import FolkWard, Milling, curvature, fines_share, folk_ward, milling, phi, uniformity
from comminute.gradings.openings import sieve_size
from comminute.gradings.sieves import sieve_sizes
from comminute.lattice.comparison import Comparison, compare
from comminute.lattice.small_ring import SmallRing
from comminute.lattices import Lattice, TimeSteppedLattice
from comminute.opening import open_result
from comminute.points import MaterialPoints
from comminute.response import ResponseTable
from comminute.response_family import ResponseFamily
from comminute.result import Interrupted, LatticeResult, ResolvedResult, Result, run_again
from comminute.runs.recipe import Recipe
from comminute.runs.remarks import ResolutionWarning
from comminute.simulation import Simulation
from comminute.sweeping.sweep import Sweep, sweep

__all__ = [
    "Atom",
    "Breakage",
    "ClosureComparison",
    "Column",
    "ColumnLattice",
    "ColumnLatticeResult",
    "ColumnResult",
    "Comparison",
    "CompressionFit",
    "CrushZones",
    "EditedFileWarning",
    "Fabric",
    "Feed",
    "FitProblem",
    "FitResult",
    "FitWarning",
    "FolkWard",
    "FractalFit",
    "FullConvolution",
    "Grading",
    "Interrupted",
    "Lattice",
    "LatticeResult",
    "LogGrid",
    "LogNormalFragments",
    "Marginal",
    "Material",
    "MaterialPoints",
    "Measurement",
    "Milling",
    "ParameterError",
    "PointMass",
    "PowerLawFragments",
    "QuasiStatic",
    "Recipe",
    "ResolutionWarning",
    "Resolved",
    "ResolvedGrid",
    "ResolvedResult",
    "ResponseFamily",
    "ResponseTable",
    "Result",
    "Ridge",
    "ShapeError",
    "ShearMixing",
    "SieveTable",
    "Simulation",
    "SizeCurve",
    "SlowUpdate",
    "SmallRing",
    "SolveReport",
    "StepReport",
    "StrengthSlope",
    "StressMeasure",
    "Sweep",
    "Table",
    "TabulatedFragments",
    "TimeSteppedLattice",
    "UnavailableError",
    "UnknownStart",
    "WeibullFragments",
    "Zone",
    "__version__",
    "active_share",
    "breakage_index",
    "breakage_potential",
    "cell_kernel",
    "compare",
    "compare_closures",
    "critical_stress_ratio",
    "crush_zones",
    "curvature",
    "dem_text",
    "fines_share",
    "fit",
    "fit_compression",
    "fitting_grid",
    "folk_ward",
    "fractal_dimension",
    "fragment_pmf",
    "fuller",
    "gap_graded",
    "has_fftw",
    "log_uniform",
    "lognormal",
    "logspace_load",
    "milling",
    "mixed_fabric",
    "monodisperse",
    "needed_spacing",
    "neighbourhood_pmf",
    "open_result",
    "percentile",
    "phi",
    "power_law",
    "relative_breakage",
    "remix",
    "resolved_gradings",
    "rosin_rammler",
    "run_again",
    "sieve_size",
    "sieve_sizes",
    "strength_slope",
    "stress_function",
    "stress_ratio_at",
    "sweep",
    "uniform_size",
    "uniformity",
]

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
    Ridge,
    ShapeError,
    SlowUpdate,
    SolveReport,
    StepReport,
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
    neighbourhood_pmf,
    percentile,
    power_law,
    remix,
    rosin_rammler,
    stress_function,
    stress_ratio_at,
    uniform_size,
)
from comminute.lattice import Lattice, TimeSteppedLattice
from comminute.lattice_results import Comparison, LatticeResult, compare
from comminute.results import Result
from comminute.simulation import Interrupted, ResolutionWarning, Simulation
from comminute.small_ring import SmallRing

__all__ = [
    "Atom",
    "Comparison",
    "CrushZones",
    "Fabric",
    "FullConvolution",
    "Grading",
    "Interrupted",
    "Lattice",
    "LatticeResult",
    "LogGrid",
    "LogNormalFragments",
    "Marginal",
    "Material",
    "ParameterError",
    "PointMass",
    "PowerLawFragments",
    "QuasiStatic",
    "ResolutionWarning",
    "Result",
    "Ridge",
    "ShapeError",
    "Simulation",
    "SlowUpdate",
    "SmallRing",
    "SolveReport",
    "StepReport",
    "TabulatedFragments",
    "TimeSteppedLattice",
    "UnavailableError",
    "WeibullFragments",
    "Zone",
    "__version__",
    "active_share",
    "cell_kernel",
    "compare",
    "critical_stress_ratio",
    "crush_zones",
    "fitting_grid",
    "fragment_pmf",
    "fuller",
    "gap_graded",
    "has_fftw",
    "log_uniform",
    "lognormal",
    "logspace_load",
    "mixed_fabric",
    "monodisperse",
    "neighbourhood_pmf",
    "percentile",
    "power_law",
    "remix",
    "rosin_rammler",
    "stress_function",
    "stress_ratio_at",
    "uniform_size",
]

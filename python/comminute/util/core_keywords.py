"""Functions and classes of the core whose errors for a misspelled keyword name the nearest; import has that effect."""

from __future__ import annotations

from comminute import _core
from comminute.util.keywords import suggests_keywords

FUNCTIONS: tuple[str, ...] = ("monodisperse", "gap_graded", "power_law", "uniform_size", "log_uniform", "fuller")
FUNCTIONS += ("lognormal", "rosin_rammler", "mixed_fabric", "fitting_grid", "percentile")
CLASSES: tuple[str, ...] = ("Material", "LogGrid", "Fabric", "WeibullFragments", "PowerLawFragments")
CLASSES += ("LogNormalFragments", "TabulatedFragments", "FullConvolution", "SlowUpdate", "QuasiStatic")
CLASSES += ("Lattice", "TimeSteppedLattice")

for _name in FUNCTIONS:
    setattr(_core, _name, suggests_keywords(getattr(_core, _name), _name))
for _name in CLASSES:
    _made = getattr(_core, _name)
    _made.__init__ = suggests_keywords(_made.__init__, _name)
_core.Grading.from_sieves = staticmethod(  # type: ignore[method-assign]
    suggests_keywords(_core.Grading.from_sieves, "Grading.from_sieves")
)

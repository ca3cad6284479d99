"""Older models of crushing, to be laid beside the fabric model on the same curves (Section 1.1 of the paper).

Each gives a `SizeCurve`, or a list of them for several loads, crushes or times, which `plotting.plot_curves` and
`Result.compare_with` take. All but the fabric model treat a grain without regard to its neighbours, so that what
they do to a mixture is the mixture of what they do to its parts.

Examples
--------
>>> import comminute as cm
>>> parts = [cm.uniform_size(0.8, 1.0), cm.uniform_size(0.08, 0.1)]
>>> mixed = cm.comparators.mixture([0.5, 0.5], parts)
>>> crush = lambda grading: cm.comparators.independent(grading, cm.PowerLawFragments(1.0), crushes=2)
>>> apart = cm.comparators.mixture([0.5, 0.5], [crush(part) for part in parts])
>>> bool(abs(crush(mixed).finer_than(0.05) - apart.finer_than(0.05)) < 1e-3)
True
"""

from comminute.comparators.breakage import breakage, normal_compression
from comminute.comparators.cascade import cascade
from comminute.comparators.comparison import ModelComparison
from comminute.comparators.grinding import batch_grinding
from comminute.comparators.independent import independent
from comminute.comparators.mixing import mixture
from comminute.comparators.threshold import size_threshold

__all__ = [
    "ModelComparison",
    "batch_grinding",
    "breakage",
    "cascade",
    "independent",
    "mixture",
    "normal_compression",
    "size_threshold",
]

"""Density of a mixed packing of grains: crushing-induced densification.

Each function takes a grading and gives how densely its grains lie when they are mixed, at one state of compaction. It
says nothing of elasticity, rearrangement at a constant grading, friction, or the fabric. Whatever the arrangement of a
grading, its void ratio lies between the mixed one and the fully separated one, `separated_void_ratio`.

Examples
--------
>>> import comminute as cm
>>> one_size, two = cm.monodisperse(1.0), cm.gap_graded(1.0, 0.1, 0.7)
>>> beta = cm.packing.calibrate(one_size, void_ratio=0.75)  # a measured one, which is how the model should be used
>>> round(cm.packing.void_ratio(two, packing=beta), 3)
0.422
"""

from comminute.packing.classes import SizeClasses, classes_of
from comminute.packing.compressible import COMPACTIONS
from comminute.packing.models import (
    PACKING,
    calibrate,
    fines_effect,
    narrow_spheres,
    separated_void_ratio,
    solid_fraction,
    void_ratio,
)

__all__ = [
    "COMPACTIONS",
    "PACKING",
    "SizeClasses",
    "calibrate",
    "classes_of",
    "fines_effect",
    "narrow_spheres",
    "separated_void_ratio",
    "solid_fraction",
    "void_ratio",
]

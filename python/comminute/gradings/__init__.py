"""Grading curves: sieve tables from files, sieve series, curves as points, and the indices read from them.

`Grading` is a class of the core, which knows nothing of files and of sieve series; its methods `read` and `to_sieves`
are written in Python and attached here.
"""

from comminute._core import Grading
from comminute.gradings.curves import on_sieves
from comminute.gradings.reading import read_grading
from comminute.util.keywords import suggests_keywords

Grading.read = staticmethod(suggests_keywords(read_grading, "Grading.read"))  # type: ignore[method-assign, unused-ignore]
Grading.to_sieves = on_sieves  # type: ignore[method-assign, assignment]

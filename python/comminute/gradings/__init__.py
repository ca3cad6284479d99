"""Grading curves: sieve tables from files, sieve series, curves as points, and the indices read from them.

`Grading` is a class of the core, which knows nothing of files; its method `read` is written in Python and attached
here.
"""

from comminute._core import Grading
from comminute.gradings.reading import read_grading
from comminute.util.keywords import suggests_keywords

Grading.read = staticmethod(suggests_keywords(read_grading, "Grading.read"))  # type: ignore[method-assign]

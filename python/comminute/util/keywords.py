"""Keyword arguments that are misspelled: the error names the nearest that there is.

Importing this module lets functions and classes of the core do so.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import re
import sys
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, get_args, get_type_hints

from comminute.util.whole_files import uninterrupted

with uninterrupted():  # a Ctrl-C while the core is being loaded would come out as an ImportError
    from comminute._core import Grading

P = ParamSpec("P")
R = TypeVar("R")


def suggests_keywords(function: Callable[P, R], name: str = "") -> Callable[P, R]:
    """Make a function whose TypeError for an unknown keyword names the nearest keyword.

    Parameters
    ----------
    function : callable
        A Python function, or one of the core, whose docstring begins with its signature.
    name : str
        Name for messages; left out: its own.

    Returns
    -------
    callable
        The same function with the same name, signature and docstring.

    Examples
    --------
    >>> from comminute.util.keywords import suggests_keywords
    >>> @suggests_keywords
    ... def crush(*, stress_ratio):
    ...     return stress_ratio
    >>> crush(stres_ratio=2)
    Traceback (most recent call last):
        ...
    TypeError: crush() has no keyword stres_ratio; did you mean stress_ratio?
    """

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except Exception as error:
            args = ()  # type: ignore[assignment]  # an object that was not made ends the process of who prints it
            if not isinstance(error, TypeError):
                raise
            known = keywords_of(function)
            for word in kwargs:
                if known and word not in known:
                    called = name or function.__qualname__.removesuffix(".__init__").rpartition(".<locals>.")[2]
                    raise TypeError(_message(called, word, known)) from None
            raise

    if name:
        checked.__qualname__ = name
    return checked


def keywords_of(function: Callable[..., Any]) -> list[str]:
    """Names of the keywords that a function takes; empty for one that takes any, or whose signature is not known.

    Keywords that a TypedDict lists (`**axial: Unpack[AxialStress]`) are among them.
    """
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        signatures = re.findall(r"^(?:[0-9]+\. )?\w+\((.*)\) ->", function.__doc__ or "", re.MULTILINE)
        names = [name for signature in signatures for name in re.findall(r"(?:^|, )([a-z_0-9]+): ", signature)]
        return [name for name in dict.fromkeys(names) if name != "self"]
    known = []
    for parameter in parameters:
        if parameter.kind is not inspect.Parameter.VAR_KEYWORD:
            known.append(parameter.name)
            continue
        listed = get_args(get_type_hints(function).get(parameter.name))
        if not listed:
            return []
        known += get_type_hints(listed[0])
    return [name for name in known if name != "self"]


def _message(called: str, word: str, known: list[str]) -> str:
    near = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    meant = f"did you mean {near[0]}?" if near else f"it has {', '.join(known)}"
    return f"{called}() has no keyword {word}; {meant}"


FUNCTIONS: tuple[str, ...] = ("monodisperse", "gap_graded", "power_law", "uniform_size", "log_uniform", "fuller")
FUNCTIONS += ("lognormal", "rosin_rammler", "mixed_fabric", "fitting_grid", "percentile")
CLASSES: tuple[str, ...] = ("Material", "StressMeasure", "LogGrid", "Fabric", "WeibullFragments", "PowerLawFragments")
CLASSES += ("LogNormalFragments", "TabulatedFragments", "FullConvolution", "SlowUpdate", "QuasiStatic")
CLASSES += ("Lattice", "TimeSteppedLattice")

_core = sys.modules[Grading.__module__]
for _name in FUNCTIONS:
    setattr(_core, _name, suggests_keywords(getattr(_core, _name), _name))
for _name in CLASSES:
    _made = getattr(_core, _name)
    _made.__init__ = suggests_keywords(_made.__init__, _name)
Grading.from_sieves = staticmethod(  # type: ignore[method-assign]
    suggests_keywords(Grading.from_sieves, "Grading.from_sieves")
)

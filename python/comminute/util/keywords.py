"""Keyword arguments that are misspelled: the error names the nearest that there is."""

from __future__ import annotations

import difflib
import functools
import inspect
import re
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def suggests_keywords(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function whose TypeError for an unknown keyword names the nearest keyword.

    Parameters
    ----------
    function : callable
        A Python function, or one of the core, whose docstring begins with its signature.

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
        except TypeError:
            known = keywords_of(function)
            for name in kwargs:
                if known and name not in known:
                    raise TypeError(_message(function, name, known)) from None
            raise

    return checked


def keywords_of(function: Callable[..., Any]) -> list[str]:
    """Names of the keywords that a function takes; empty for one that takes any, or whose signature is not known."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        signature = re.search(r"\((.*)\) ->", (function.__doc__ or "").partition("\n")[0])
        names = re.findall(r"(?:^|, )([a-z_0-9]+): ", signature[1]) if signature else []
        return [name for name in names if name != "self"]
    if any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters):
        return []
    return [parameter.name for parameter in parameters if parameter.name != "self"]


def _message(function: Callable[..., Any], name: str, known: list[str]) -> str:
    called = function.__qualname__.removesuffix(".__init__").rpartition(".<locals>.")[2]
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    meant = f"did you mean {near[0]}?" if near else f"it has {', '.join(known)}"
    return f"{called}() has no keyword {name}; {meant}"


def suggest_in(module: ModuleType, functions: Iterable[str], classes: Iterable[str]) -> None:
    """Let functions of the core and the makers of its classes name the nearest keyword."""
    for name in functions:
        setattr(module, name, suggests_keywords(getattr(module, name)))
    for name in classes:
        made = getattr(module, name)
        made.__init__ = suggests_keywords(made.__init__)

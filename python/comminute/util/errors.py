"""Errors as data: how Python code raises them from their parts, and how a layer words one for its own users.

An error of the core and one that is raised here carry the same attributes (see `ParameterError`). A layer that knows
better than the one below where a value came from, or what its user can type, makes the error anew with `reworded`; it
never looks into the message.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from comminute._core import ParameterError, Place, ShapeError, UnavailableError, _remedy_words, _worded
from comminute.util.names import shorten

Fault = TypeVar("Fault", bound=ParameterError | ShapeError | UnavailableError)
SENTENCE = ("parameter", "value", "subject", "finding", "also", "rule", "place")  # the parts of a message
Where = str | Place | Sequence[Place]

# The remedies in words for Python code: the kinds of the core, and those of the Python layers.
PYTHON: dict[str, str] = {
    "normalise": "divide it by its sum",
    "raise_psi_max": "raise psi_max",
    "size_grid_automatically": "raise psi_max, or leave the grid out to have it sized from the grading",
    "lower_psi_min": "lower psi_min to resolve it",
    "resolve_fines": "lower psi_min to resolve it, or pass extrapolate=True",
    "extrapolate": "pass extrapolate=True to follow the tail",
    "cumulate_masses": "pass the mass fraction finer, not the mass of each bin",
    "cumulate_retained": "retained percentages? convert them to per cent finer first",
    "extend_top": 'add the size that all grains pass, or pass top="extend" to carry the last slope on to 100 %',
    "add_coarser_sieve": "add the size that all grains pass",
    "add_finer_sieve": "add a size with 0 % finer",
    "set_first_crush_stress": "set it on the Material, or give stress_ratio",
    "set_stress_measure": 'name it on the Material, stress_measure="mean" for example',
    "use_same_grid": "make the solver with fabric.grid",
    "use_blend_kernel": 'use kind "blend", or leave loading_rate at 0',
    "choose_path": "use path 'automatic' or 'transforms'",
    "record_avalanches": "pass record_avalanches=True when the lattice is made",
    "use_own_memory": "pass an array of its own",
    "order_rows": "np.ascontiguousarray makes one",
    "leave_out": "leave it out",
    "build_with_fftw": "install libfftw3-dev and build with -DCOMMINUTE_WITH_FFTW=ON, or use SlowUpdate, "
    "which needs none",
    "use_lattice_or_resolved": 'take a Lattice, or closure="resolved"',
    "name_retained_column": "retained percentages? name the column percent_retained.",
    "name_cumulative_column": "cumulative values? name the column percent_cumulative_retained.",
    "name_unit": 'name it, with_unit("mm") for an ideal grading',
    "use_one_unit": "bring them to one unit",
    "keep_fabric": "add its index to keep_fabrics of run",
    "count_from_smallest": "pass smallest=, the size from which to count",
    "turn_sign": "compression is positive here: turn the sign",
}

_remedy_words.update(PYTHON)  # the core words its errors for Python code from this table


def _steps(place: Where) -> tuple[Place, ...]:
    if isinstance(place, str):
        return (Place(place),) if place else ()
    return (place,) if isinstance(place, Place) else tuple(place)


def _made(kind: type[Fault], parts: Mapping[str, Any], words: Mapping[str, str]) -> Fault:
    remedy = parts["remedy"]
    sentence = {name: parts[name] for name in SENTENCE}
    error = kind(_worded(**sentence, remedy=words.get(remedy, PYTHON.get(remedy, ""))))
    for name, part in parts.items():
        setattr(error, name, part)
    return error


def parameter_error(
    parameter: str = "",
    value: object = "",
    rule: str = "",
    *,
    subject: str = "",
    finding: str = "",
    also: Place | None = None,
    place: Where = (),
    remedy: str = "",
) -> ParameterError:
    """Make an error from its parts: "<place>: <parameter> is <value>; <rule>. <remedy>".

    Parameters
    ----------
    parameter : str
        Name of the parameter at fault.
    value : object
        Its value; a float is written with six digits.
    rule : str
        The rule that is broken, as a clause: "it must be at least 8".
    subject, finding : str
        Subject and predicate of the sentence, where they are not the parameter and "is <value>".
    also : Place, optional
        A second place, with which the predicate ends.
    place : str, Place or sequence of Place
        The way to the parameter, outermost first.
    remedy : str
        A kind from `PYTHON`.

    Returns
    -------
    ParameterError
        The error, for the caller to raise.

    Examples
    --------
    >>> from comminute.util.errors import parameter_error
    >>> print(parameter_error("bins", 4, "it must be at least 8", place="case.toml [grid]"))
    case.toml [grid]: bins is 4; it must be at least 8
    """
    number = float(value) if isinstance(value, float | int) else None
    parts: dict[str, Any] = {
        "parameter": parameter,
        "value": f"{value:g}" if isinstance(value, float) else str(value),
        "number": number,
        "subject": subject,
        "finding": finding,
        "also": also,
        "rule": rule,
        "place": _steps(place),
        "remedy": remedy,
    }
    return _made(ParameterError, parts, PYTHON)


class OutputExistsError(FileExistsError):
    """A file that would be overwritten; the message says how to allow it."""


def scattered(what: str) -> ParameterError:
    """Error of something that knows one strength for each size, and was given a material whose strengths scatter."""
    finding = f"is True, and {what} knows one strength for each size"
    return parameter_error("strength_scatter", True, finding=finding, remedy="use_lattice_or_resolved")


def wrong_file(name: str, finding: str, rule: str) -> ParameterError:
    """Make the error of a file that is wrong as a whole: "<name> <finding>; <rule>"."""
    return parameter_error("file", shorten(name), rule, subject=shorten(name, 200), finding=finding)


def reworded(
    error: Fault, *, outer: Where = (), words: Mapping[str, str] = PYTHON, changed: Mapping[str, object] | None = None
) -> Fault:
    """Make the same error for another reader.

    Parameters
    ----------
    error : ParameterError, ShapeError or UnavailableError
    outer : str, Place or sequence of Place
        Steps that lead to the error's place, such as a file and a table of it.
    words : mapping
        A layer's words by kind of remedy; the Python words stand in for kinds that it leaves out.
    changed : mapping, optional
        Parts that are replaced, by name.

    Returns
    -------
    ParameterError, ShapeError or UnavailableError
        The new error, of the class of `error`.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.util.errors import reworded
    >>> try:
    ...     cm.Material().stress_ratio(2.0)
    ... except cm.ParameterError as error:
    ...     print(reworded(error, outer="case.toml", words={"set_first_crush_stress": "set it in [material]"}))
    case.toml: stress is 2; it needs first_crush_stress, which is not set. Set it in [material]
    """
    parts: dict[str, Any] = {name: getattr(error, name) for name in (*SENTENCE, "number", "remedy")}
    if not (error.parameter or error.subject):  # raised from a text alone, which is then the whole sentence
        parts["subject"] = str(error)
    parts |= changed or {}
    parts["place"] = (*_steps(outer), *parts["place"])
    return _made(type(error), parts, words)

"""Errors of sieve tables, made from their parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from comminute._core import ParameterError, Place


def fault(
    place: str | Place, said: str, rule: str = "", *, parameter: str = "table", remedy: str = ""
) -> ParameterError:
    """Make the error "<place>: <said>; <rule>" of a table.

    Parameters
    ----------
    place : str or Place
        File, row and column; empty for an option.
    said : str
        The sentence that says what was found.
    rule : str
        The rule that it breaks, and the remedy.
    parameter : str
        Option of `Grading.read` at fault, or "table".
    remedy : str
        Kind of remedy, where the rule does not say it.
    """
    return parameter_error(parameter, "", rule, subject=said, place=place, remedy=remedy)

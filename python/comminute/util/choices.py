"""The words by which a run's choices are named."""

from __future__ import annotations

from typing import Literal, get_args

from comminute.util.errors import parameter_error

Kind = Literal["slow", "exact", "fast", "blend"]
Mean = Literal["arithmetic", "geometric"]
Scheme = Literal["conservative", "paper"]
Closure = Literal["paper", "resolved"]
StressName = Literal["largest", "vertical", "mean", "octahedral", "energy"]
EngineName = Literal["auto", "quasi-static", "slow-update", "full-convolution"]


def require_word(parameter: str, word: object, choice: object) -> None:
    """Raise ParameterError, naming the words it knows, unless `word` is one of the Literal `choice`."""
    known = get_args(choice)
    if word not in known:
        raise parameter_error(parameter, f"'{word}'", f"it must be one of {', '.join(map(repr, known))}")

"""Equality of records that have arrays among their fields."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


def same_values(mine: Iterable[object], theirs: Iterable[object]) -> bool:
    """Tell whether two rows of values are equal in every number; NaN, which says "not known", equals NaN.

    Examples
    --------
    >>> import numpy as np
    >>> from comminute.util.equality import same_values
    >>> same_values([1, np.array([1.0, np.nan])], [1, np.array([1.0, np.nan])])
    True
    """
    return all(_same(a, b) for a, b in zip(mine, theirs, strict=True))


def _same(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=True)
    return not isinstance(a, np.ndarray) and not isinstance(b, np.ndarray) and bool(a == b)

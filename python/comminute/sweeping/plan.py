"""Plan of a sweep: the case, the keys that vary, the values of each member, and the numbers that are kept."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from comminute.cases.reading import ReadyCase, axes_of, case_of_tables, tables_of, with_values
from comminute.cases.schema import Sieves
from comminute.gradings.curves import SizeCurve
from comminute.sweeping.layout import How, Value, Values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
SIZES = 25  # for a start without sieves, evenly in ln(size)
DECADES = 3.0  # that they go down from the largest grain
MOST_MEMBERS = 10_000_000
SWEPT_NAME = "case"  # in messages on a case that comes from no file


@dataclass(frozen=True)
class Plan:
    """Everything that a worker needs to run any member: plain data, which goes to other processes and machines.

    Attributes
    ----------
    tables : dict
        Tables of the case, without the values that vary.
    path : str
        Place of the case file; its other files are beside it.
    keys : tuple of str
        Keys that vary, "material.fabric_width".
    percents, sizes : tuple of float
        Sizes D_x, and sizes at which the mass finer is kept.
    loads : int
        Loads of every member.
    """

    tables: dict[str, Any]
    path: str
    keys: tuple[str, ...]
    percents: tuple[float, ...]
    sizes: tuple[float, ...]
    loads: int

    def case(self, values: Sequence[Value]) -> ReadyCase:
        """Give the case of a member.

        Raises
        ------
        ParameterError
            For a case that cannot run, as `read_case`.
        """
        varied = dict(zip(self.keys, values, strict=True))
        return case_of_tables(with_values(self.tables, varied), Path(self.path), varied)

    def to_json(self) -> str:
        """Text from which `from_json` makes the same plan, and which differs for any other."""
        return json.dumps(asdict(self), default=str)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Plan of a text."""
        fields = json.loads(text)
        for name in ("keys", "percents", "sizes"):
            fields[name] = tuple(fields[name])
        return cls(**fields)


@dataclass(frozen=True)
class Members:
    """Values of the keys that vary, by member.

    Attributes
    ----------
    columns : dict of str to ndarray (M,)
        Floats, integers, truth values or words.
    """

    columns: dict[str, npt.NDArray[Any]]

    @property
    def count(self) -> int:
        """M, the number of members."""
        return next(iter(self.columns.values())).size

    def rows(self, first: int, last: int) -> list[tuple[Value, ...]]:
        """Values of the members from one up to, and without, another."""
        columns = [column[first:last].tolist() for column in self.columns.values()]
        return list(zip(*columns, strict=True))


def members_of(over: Mapping[str, Values], how: How) -> Members:
    """Members of a sweep: every combination of the values, the last key fastest; or one of each row.

    Raises
    ------
    ParameterError
        For no values, values of several kinds, lists of different length where they are rows, or too many members.
    """
    if how not in ("product", "rows"):
        raise parameter_error("how", f"'{how}'", 'it must be "product" or "rows"')
    columns = {key: _column(key, values) for key, values in over.items()}
    if not columns:
        rule = "give `over`, or lists in the case"
        raise parameter_error("over", "nothing", rule, finding="names no key: there is nothing to vary")
    sizes = [column.size for column in columns.values()]
    if how == "rows":
        if len(set(sizes)) > 1:
            finding = "have " + ", ".join(str(size) for size in sizes) + " values"
            raise parameter_error("over", subject="the lists of `over`", finding=finding, rule="rows need equal lists")
        return Members(columns)
    count = math.prod(sizes)
    if count > MOST_MEMBERS:
        rule = f"a sweep may have {MOST_MEMBERS:,} members"
        raise parameter_error("over", count, rule, subject="the lists of `over`", finding=f"make {count:,}")
    places = np.unravel_index(np.arange(count), sizes)
    return Members({key: column[place] for (key, column), place in zip(columns.items(), places, strict=True)})


def _column(key: str, values: Values) -> npt.NDArray[Any]:
    """Check the values of one key."""
    column = np.asarray(values)
    if isinstance(values, str) or column.size == 0:
        rule = "a sweep needs a list of values"
        raise parameter_error(key, "a word" if isinstance(values, str) else "an empty list", rule)
    one_kind = isinstance(values, np.ndarray) or len({_kind(value) for value in values}) == 1
    if not one_kind or column.ndim != 1 or column.dtype.kind not in "fiubU":
        raise parameter_error(key, "values of several kinds", "they must be all numbers, all words or all true/false")
    return column


def _kind(value: Value) -> str:
    return "truth" if isinstance(value, bool) else "word" if isinstance(value, str) else "number"


def planned(
    case: str | os.PathLike[str] | Mapping[str, Any],
    over: Mapping[str, Values] | None,
    how: How,
    percents: Sequence[float],
    sizes: Sequence[float] | None,
) -> tuple[Plan, Members]:
    """Plan of a sweep, and its members; the first of them is made, so that a wrong key is found at once.

    Raises
    ------
    ParameterError
        For a case, a key, a value of the first member, or lists that cannot be used.
    """
    for percent in percents:
        if not 0.0 <= percent <= 100.0:
            raise parameter_error("percents", float(percent), "it must be between 0 and 100")
    for size in sizes if sizes is not None else ():
        if not 0.0 < size < math.inf:
            raise parameter_error("sizes", float(size), "it must be greater than 0 and finite")
    given = over or {}
    if isinstance(case, Mapping):
        tables, path = dict(case), Path(SWEPT_NAME).resolve()
    else:
        path = Path(case).resolve()
        tables = tables_of(Path(case))
    lists = {key: values for key, values in axes_of(tables, path.name).items() if key not in given}
    if how == "rows" and lists:
        rule = "rows take one value of everything else: give it in `over` too, or one value"
        raise parameter_error(next(iter(lists)), "a list", rule, finding="is a list in the case")
    members = members_of(lists | dict(given), how)
    plan = Plan(tables, str(path), tuple(members.columns), tuple(float(p) for p in percents), (), 0)
    first = plan.case(members.rows(0, 1)[0])
    if sizes is None:
        sizes = _usual_sizes(first)
    plan = replace(plan, sizes=tuple(float(size) for size in sizes), loads=first.path().stress_ratio.size)
    return replace(plan, tables=plan.tables | _without_files(plan, first)), members


def _without_files(plan: Plan, first: ReadyCase) -> dict[str, Any]:
    """Tables whose files are written out as numbers: workers elsewhere may not see them."""
    tables = dict[str, Any]()
    load, grading = plan.tables["load"], first.resolved.grading
    varied = {key.split(".")[0] for key in plan.keys}
    if "file" in load and "load" not in varied:
        tables["load"] = {key: value for key, value in load.items() if key != "file"} | first.loads()
    if isinstance(grading, Sieves) and not varied & {"grading", "units"}:
        tables["grading"] = grading.model_dump()
    return tables


def _usual_sizes(case: ReadyCase) -> list[float]:
    """Sieves of a measured start; else sizes over some decades below its largest grain."""
    if case.grading.measured:
        return list(SizeCurve.of(case.grading).size.tolist())
    return list((case.grading.largest * np.logspace(-DECADES, 0.0, SIZES)).tolist())

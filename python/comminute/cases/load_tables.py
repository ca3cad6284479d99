"""Load paths of cases: from the keys of the table [load] to numbers. Needs pydantic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from comminute.cases.load_files import read_loads
from comminute.cases.messages import table_place
from comminute.cases.schema import LOADS, Case, LoadRange, Loads, LoadTable
from comminute.runs.load_path import LoadPath, load_path
from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from pathlib import Path

    from comminute._core import Material


def numbers_of(load: LoadTable) -> dict[str, Any]:
    """Give the numbers of the loads of a resolved case by key."""
    return {key: values for key in LOADS if (values := getattr(load, key)) is not None}


def path_of(material: Material, load: LoadTable) -> LoadPath:
    """Give the load path of a resolved case."""
    ways = {"stress_ratio": None, "stress": None} | numbers_of(load)
    return load_path(material, loading_rate=load.loading_rate, remix_after=load.remix_after, **ways)


def with_numbers(case: Case, path: Path) -> Case:
    """Write the load path of a case out as numbers.

    Raises
    ------
    ParameterError
        Unless the loads are given in one way, and for a range or a file that gives none.
    """
    load = case.load
    ways = (("stress",), ("stress_ratio",), ("p", "q"), ("vertical", "k0"), ("file",))
    given = [" with ".join(way) for way in ways if any(getattr(load, key) is not None for key in way)]
    if len(given) != 1:
        subject = " and ".join(given) if given else "no load"
        finding = "are both given" if len(given) == 2 else "are all given" if given else "is given"
        rule = "give one of stress, stress_ratio, p with q, vertical with k0, file"
        raise parameter_error("load", subject=subject, finding=finding, rule=rule, place=table_place(path.name, "load"))
    if load.file is not None:
        key, loads = read_loads(path.parent / load.file, case.units.stress)
        return case.model_copy(update={"load": load.model_copy(update={"file": None, key: loads})})
    update = {
        key: _written_out(values, table_place(path.name, "load", key))
        for key in LOADS
        if (values := getattr(load, key)) is not None
    }
    return case.model_copy(update={"load": load.model_copy(update=update)})


def _written_out(loads: Loads, place: str) -> list[float]:
    """Give loads as numbers; `place` is the table that gives them, where they are a range."""
    if isinstance(loads, LoadRange):
        return _in_range(loads, place)
    return [float(load) for load in (loads if isinstance(loads, list) else [loads])]


def _in_range(loads: LoadRange, place: str) -> list[float]:
    """List the loads from one to another; `place` is the table that gives them."""
    bad = next((x for x in (loads.first, loads.last) if not np.isfinite(x) or x < 0.0), None)
    if bad is not None:
        raise parameter_error("from or to", float(bad), "it must be a finite number of at least 0", place=place)
    if loads.spacing == "log":
        if not (loads.first > 0.0 and loads.last > 0.0):
            raise parameter_error("from or to", 0, 'spacing "log" needs both greater than 0', place=place)
        return list(np.geomspace(loads.first, loads.last, loads.steps).tolist())
    return list(np.linspace(loads.first, loads.last, loads.steps).tolist())

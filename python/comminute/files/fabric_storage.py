"""Fabrics as the variables of a NetCDF file, and back without a bit lost."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from comminute._core import Atom, Fabric, LogGrid, PointMass, Ridge

START = -1  # load index under which the start is stored
POINT_NAMES = {
    "load": "load index, -1 for the start,",
    "psi": "exact log grainsize",
    "mass": "mass fraction",
    "size": "exact grainsize",
}
AXES: tuple[Literal["grain", "neighbour"], ...] = ("grain", "neighbour")

Arrays = dict[str, npt.NDArray[Any]]


def columns(what: str, rows: Sequence[Sequence[float]], names: dict[str, str]) -> dict[str, Any]:
    """Variables of a table: one column for each name, along a dimension `what`; none for an empty table."""
    if not rows:
        return {}
    table = np.array(rows, dtype=np.float64).T
    return {
        f"{what}_{name}": (what, column, {"long_name": f"{text} of a {what.replace('_', ' ')}", "units": "1"})
        for (name, text), column in zip(names.items(), table, strict=True)
    }


def rows_of(values: Arrays, what: str, names: Sequence[str]) -> Iterator[tuple[float, ...]]:
    """Rows of a table that `columns` made; none where the file has no such table."""
    if f"{what}_{names[0]}" in values:
        for row in zip(*(values[f"{what}_{name}"] for name in names), strict=True):
            yield tuple(float(x) for x in row)


def point_rows(points: Mapping[int, Sequence[PointMass]]) -> list[list[float]]:
    """Rows of exact sizes by load, for `columns` with POINT_NAMES."""
    return [[k, point.psi, point.mass, point.size] for k, exact in points.items() for point in exact]


def points_of(values: Arrays, what: str, loads: Iterable[int]) -> dict[int, list[PointMass]]:
    """Exact sizes by load of a table of `point_rows`; the first files have no column of sizes."""
    points: dict[int, list[PointMass]] = {k: [] for k in loads}
    known = [name for name in POINT_NAMES if f"{what}_{name}" in values]
    for load, psi, mass, *size in rows_of(values, what, known or list(POINT_NAMES)):
        points[int(load)].append(PointMass(psi, mass, *size))
    return points


def fabric_variables(fabrics: dict[int, Fabric]) -> dict[str, Any]:
    """Variables of fabrics, by the load after which each was kept: all their parts but grid and mean."""
    mass = {"units": "1"}
    text = "mass fraction by grainsize and neighbourhood grainsize"
    kept = [k for k in fabrics if k != START]
    start = fabrics[START]
    square = ("psi", "psibar")
    found: dict[str, Any] = {
        "start_fabric": (square, start.probability, {"long_name": f"{text} before the first load", **mass})
    }
    if kept:
        cube = np.stack([fabrics[k].probability for k in kept])
        found["fabric"] = (("fabric_load", *square), cube, {"long_name": f"{text} after each kept load", **mass})
        settled = [np.nan if (at := fabrics[k].settled_at) is None else at for k in kept]
        about = {"long_name": "stress ratio under which the fabric is at rest, NaN if none", "units": "1"}
        found["settled_at"] = ("fabric_load", np.array(settled), about)
    found |= _exact_variables(fabrics)
    marginals = {k: dict(zip(("rows", "spread"), fabric._carried()[:2], strict=True)) for k, fabric in fabrics.items()}
    for name in ("rows", "spread"):
        about = {"long_name": f"carried marginal, {name}: bit for bit what the next load starts from", **mass}
        found[f"start_{name}"] = ("psi", marginals[START][name], about)
        if kept:
            found[f"carried_{name}"] = (("fabric_load", "psi"), np.stack([marginals[k][name] for k in kept]), about)
    points = {k: fabric._carried()[2] for k, fabric in fabrics.items()}
    return found | columns("carried_point", point_rows(points), POINT_NAMES)


def _exact_variables(fabrics: dict[int, Fabric]) -> dict[str, Any]:
    load = {"load": "load index, -1 for the start,"}
    atoms = [[k, *atom] for k, fabric in fabrics.items() for atom in fabric.atoms]
    names = {"psi": "log grainsize", "psibar": "log neighbourhood grainsize", "mass": "mass fraction"}
    found = columns("atom", atoms, load | names)
    ridges = [(k, ridge) for k, fabric in fabrics.items() for ridge in fabric.ridges]
    heads = [[k, AXES.index(ridge.exact), ridge.at, ridge.above] for k, ridge in ridges]
    names = {"exact": "0: psi is exact, 1: psibar,", "at": "exact log size", "above": "mass above it in its bin"}
    found |= columns("ridge", heads, load | names)
    if ridges:
        about = {"long_name": "mass fraction by bin of the other log size of a ridge", "units": "1"}
        found["ridge_mass"] = (("ridge", "psi"), np.stack([ridge.mass for _, ridge in ridges]), about)
    return found


def fabrics_of(
    values: Arrays,
    grid: LogGrid,
    mean: Literal["arithmetic", "geometric"],
    settled_at: dict[int, float],
    largest: float,
) -> dict[int, Fabric]:
    """Fabrics of the variables that `fabric_variables` made, by load; START is the start.

    `settled_at` has, for each fabric, the load at which it is at rest; NaN for none. `largest` is the size that no
    grain exceeds.
    """
    atoms: dict[int, list[Atom]] = {k: [] for k in settled_at}
    for load, psi, psibar, mass in rows_of(values, "atom", ("load", "psi", "psibar", "mass")):
        atoms[int(load)].append(Atom(psi, psibar, mass))
    ridges: dict[int, list[Ridge]] = {k: [] for k in settled_at}
    for row, (load, exact, at, above) in enumerate(rows_of(values, "ridge", ("load", "exact", "at", "above"))):
        line = np.ascontiguousarray(values["ridge_mass"][row])
        ridges[int(load)].append(Ridge(AXES[int(exact)], at, line, above))
    points = points_of(values, "carried_point", settled_at)
    rows = {int(load): row for row, load in enumerate(values.get("fabric_load", ()))}
    found = {}
    for load, at in settled_at.items():
        of = {
            name: np.ascontiguousarray(values[f"start_{name}"] if load == START else values[later][rows[load]])
            for name, later in (("fabric", "fabric"), ("rows", "carried_rows"), ("spread", "carried_spread"))
        }
        rest = None if np.isnan(at) else at
        fabric = Fabric(grid, of["fabric"], atoms[load], settled_at=rest, mean=mean, ridges=ridges[load])
        found[load] = fabric._with_carried(of["rows"], of["spread"], points[load], largest)
    return found

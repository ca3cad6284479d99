"""Results in NetCDF files: readable by anything that reads NetCDF 4, and by this library without a bit lost."""

from __future__ import annotations

import hashlib
import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from comminute._core import Fabric, ResolvedGrid, __version__
from comminute.files.fabric_storage import (
    POINT_NAMES,
    START,
    Arrays,
    columns,
    fabric_variables,
    fabrics_of,
    point_rows,
    points_of,
)
from comminute.gradings.curves import SizeCurve
from comminute.runs.recipe import (
    Recipe,
    grading_of,
    grading_record,
    grid_of,
    grid_record,
    material_of,
    material_record,
    report_of,
    report_record,
)
from comminute.runs.resolved_run import start_fabric
from comminute.runs.results import LatticeData, ResolvedData, ResultData
from comminute.util.errors import wrong_file
from comminute.util.names import is_file, shorten
from comminute.util.optional import needs
from comminute.util.whole_files import uninterrupted, write_whole

if TYPE_CHECKING:
    from comminute.util.choices import Mean

LAYOUT = "comminute result 1"
RESOLVED_LAYOUT = "comminute resolved result 1"
MOST_NAMED = 6  # changes that a message lists
RINGS = ("cells", "replicas", "seed")
RESOLVED_ROWS = {
    "avalanches": "mean number of avalanches that a cell has begun",
    "step_error": "largest difference of the coarse and the fine curve",
}
FINGERPRINTS = "sha256"
WRITTEN_BY_XARRAY = {"coordinates"}  # an attribute that xarray adds when it writes, wherever it sees fit
MAGIC = b"\x89HDF\r\n\x1a\n"
FORMAT = "v108"  # the oldest of HDF5 that has checksums in its headers: a damaged file is an error, not another file
ROUNDING = 1e-12  # largest difference between an array of a file and the same array computed from the others
PACKING = {"zlib": True, "complevel": 4, "shuffle": True, "fletcher32": True, "_FillValue": None}


class EditedFileWarning(UserWarning):
    """A result file is not as it was written: another program changed it. The message names what differs."""


def to_dataset(result: ResultData) -> Any:
    """Dataset of a result; see `Result.to_xarray`."""
    try:
        import xarray as xr  # noqa: PLC0415  (an optional dependency)
    except ImportError as error:
        raise needs("io", "xarray", "to_xarray") from error
    unit = {"units": result.unit or "1"}
    coords: dict[str, Any] = {
        "stress_ratio": ("load", result.stress_ratio, {"long_name": "stress ratio", "units": "1"}),
        "psi": ("psi", result.psi, {"long_name": "log grainsize at bin centres", "units": "1"}),
        "size": ("psi", result.size, {"long_name": "grainsize at bin centres", **unit}),
        "edge_size": ("psi", result.edge_size, {"long_name": "grainsize at upper bin edges", **unit}),
    }
    if result.stress is not None:
        stress_unit = result.recipe.stress_unit if result.recipe else ""
        known = {"units": stress_unit} if stress_unit else {}  # the unit of first_crush_stress
        coords["stress"] = ("load", result.stress, {"long_name": "stress", **known})
    names = {
        "pmf": (("load", "psi"), "mass fraction by bin"),
        "cdf": (("load", "psi"), "mass fraction finer than edge_size"),
        "crushes": ("load", "mean number of crushes a cell has been through"),
        "fines": ("load", "mass fraction in the fines bin"),
        "mass_error": ("load", "total mass less 1"),
    }
    variables: dict[str, Any] = {
        name: (dims, getattr(result, name), {"long_name": text, "units": "1"}) for name, (dims, text) in names.items()
    }
    points = dict(enumerate(result.points))
    variables |= columns("point", point_rows(points), POINT_NAMES)
    if isinstance(result, LatticeData):
        variables["cdf_error"] = (("load", "psi"), result.cdf_error, {"long_name": "standard error of cdf"})
        variables |= columns("start_point", point_rows({START: result.start_points}), POINT_NAMES)
        variables["crushes_error"] = ("load", result.crushes_error, {"long_name": "standard error of crushes"})
    if result.measured is not None:
        rows = np.stack([result.measured.size, result.measured.finer], axis=1)
        variables |= columns("sieve", rows.tolist(), {"size": "opening", "finer": "mass fraction finer"})
    if isinstance(result, ResolvedData):
        for name, text in RESOLVED_ROWS.items():
            variables[name] = ("load", getattr(result, name), {"long_name": text, "units": "1"})
        return xr.Dataset(variables, coords, _attributes(result))
    psibar = {"long_name": "log neighbourhood grainsize at bin centres", "units": "1"}
    coords["psibar"] = ("psibar", result.psi, psibar)
    kept = [k for k, fabric in enumerate(result.fabrics) if fabric is not None]
    variables |= fabric_variables({START: result.start} | {k: result.fabric(k) for k in kept})
    if kept:
        coords["fabric_load"] = ("fabric_load", np.array(kept, dtype=np.int64), {"long_name": "index of a kept load"})
    return xr.Dataset(variables, coords, _attributes(result))


def _attributes(result: ResultData) -> dict[str, Any]:
    """Fields of a result that are no arrays, as text."""
    return {
        "Conventions": "CF-1.11",
        "title": "confined comminution: gradings after each load",
        "source": f"comminute {__version__}",
        "references": "Huang, Marks & Einav (2020), https://doi.org/10.1016/j.jmps.2020.103897",
        "layout": RESOLVED_LAYOUT if isinstance(result, ResolvedData) else LAYOUT,
        "comminute_version": __version__,
        "engine": result.engine,
        "scheme": result.scheme,
        "unit": result.unit,
        "mean": result.start.mean,
        "largest": result.start.largest,
        "sieve_tail_slope": 0.0 if result.measured is None else result.measured.tail_slope,
        "start_settled_at": json.dumps(result.start.settled_at),
        "material": json.dumps(material_record(result.material)),
        "grid": json.dumps(grid_record(result.grid)),
        "notes": json.dumps(list(result.notes)),
        "warnings": json.dumps(list(result.warnings)),
        "reports": json.dumps([report_record(report) for report in result.reports]),
        "lattice": json.dumps({name: getattr(result, name) for name in RINGS if isinstance(result, LatticeData)}),
        "recipe": "" if result.recipe is None else result.recipe.to_json(),
        "case": "" if result.recipe is None else result.recipe.case,
        "closure": result.closure,
        "grading": json.dumps(grading_record(result.grading)) if isinstance(result, ResolvedData) else "",
    }


def _fingerprints(data: Any) -> dict[str, str]:
    """Hash of each array and each attribute of a dataset, by the words that name it in a message.

    An array is hashed with its dtype and shape, row after row and low byte first; an attribute as UTF-8 text.
    """
    found = {}
    held = [("", data.attrs), *((f"{name}:", variable.attrs) for name, variable in data.variables.items())]
    for owner, attributes in held:
        for key in set(attributes) - WRITTEN_BY_XARRAY:
            found[f"attribute {owner}{key}"] = _hash(str(attributes[key]).encode("utf-8", "surrogateescape"))
    for name, variable in data.variables.items():
        values = np.asarray(variable.values)
        values = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        found[f"array {name}"] = _hash(f"{values.dtype.str} {variable.shape} ".encode() + values.tobytes())
    return dict(sorted(found.items()))


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]  # guards against accidents, which 64 bits tell apart


def _changes(data: Any) -> list[str]:
    """Tell what was changed in a dataset since it was written; takes the fingerprints out of its attributes.

    A file of version 0.1.0 has none, and nothing can be said of it.
    """
    record = data.attrs.pop(FINGERPRINTS, None)
    if record is None:
        return []
    written, found = json.loads(record), _fingerprints(data)
    ways = {
        "changed": [name for name in found if name in written and found[name] != written[name]],
        "added": [name for name in found if name not in written],
        "removed": [name for name in written if name not in found],
    }
    return [f"{shorten(name)} {way}" for way, names in ways.items() for name in names]


def _require_consistent(result: ResultData, data: Any) -> None:
    """Raise ValueError unless the arrays of an edited file agree with each other."""
    for name, variable in to_dataset(result).variables.items():
        if not np.allclose(data[name].values, variable.values, rtol=ROUNDING, atol=ROUNDING, equal_nan=True):
            raise ValueError(f"{name} disagrees with the other arrays")
    if not np.allclose(result.pmf.sum(axis=1) - 1.0, result.mass_error, rtol=0.0, atol=ROUNDING):
        raise ValueError("pmf disagrees with mass_error")


def require_netcdf(wanted_for: str) -> Any:
    """Load what reads and writes NetCDF, and give xarray; where something is missing, say what to install."""
    try:
        with uninterrupted():  # libraries that are being loaded may not survive it
            import h5netcdf  # noqa: F401, PLC0415  (optional dependencies)
            import h5py  # noqa: F401, PLC0415
            import xarray as xr  # noqa: PLC0415
    except ImportError as error:
        raise needs("io", "xarray, h5netcdf and h5py", wanted_for) from error
    return xr


@uninterrupted()  # xarray loads more libraries when it first makes a dataset, and they may not survive it
def save_netcdf(result: ResultData, path: Path) -> Path:
    """Write a result to a NetCDF file; see `Result.save`."""
    require_netcdf(f"saving {path.name}")
    import h5netcdf  # noqa: PLC0415  (an optional dependency)
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415

    data = to_dataset(result)
    data.attrs[FINGERPRINTS] = json.dumps(_fingerprints(data))
    packing = {name: PACKING if data[name].ndim else {} for name in data.variables}

    def write(file: Path) -> None:
        with h5netcdf.File(file, "w", libver=FORMAT) as opened:
            data.dump_to_store(H5NetCDFStore(opened), encoding=packing)

    return write_whole(path, write)


def read_netcdf(file: Path) -> ResultData:
    """Read a result, of a lattice as `LatticeData`, from a file that `save_netcdf` wrote; see `open_result`."""
    xr = require_netcdf("open_result")
    import h5py  # noqa: PLC0415  (an optional dependency)

    if not is_file(file):
        raise wrong_file(str(file), "does not exist", "give a result file (.nc)")
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise wrong_file(file.name, "is no NetCDF 4 file", "give a result file (.nc)")
    try:
        with uninterrupted():
            with h5py.File(file) as opened:  # refuses here what h5netcdf would fail to close again
                dict(opened.attrs)
            data = xr.load_dataset(file, engine="h5netcdf", decode_cf=False)
            layout = str(data.attrs["layout"])
            changes, result = _read(data) if layout in (LAYOUT, RESOLVED_LAYOUT) else ([], None)
    except Exception as error:  # whatever a damaged file makes the libraries below raise
        finding = "is no result as comminute wrote it: it is damaged, cut short, or was changed by another program"
        raise wrong_file(file.name, finding, "run it again") from error
    if result is None:
        finding = f"has the layout '{shorten(layout)}', not '{LAYOUT}'"
        raise wrong_file(file.name, finding, "it needs another version")
    if changes:
        listed = ", ".join(changes[:MOST_NAMED]) + (
            f" and {more} more" if (more := len(changes) - MOST_NAMED) > 0 else ""
        )
        message = f"{shorten(file.name, 200)} was changed after it was written: {listed}; it is read as it now is"
        warnings.warn(message, EditedFileWarning, stacklevel=3)
    return result


def _read(data: Any) -> tuple[list[str], ResultData]:
    """Tell what was changed in a dataset since it was written, and give the result that it holds now."""
    changes = _changes(data)
    result = _result(data)
    if changes:
        _require_consistent(result, data)
    return changes, result


def _result(data: Any) -> ResultData:
    texts = {key: str(value) for key, value in data.attrs.items()}
    values = {name: np.array(data[name].values) for name in data.variables}
    loads = values["stress_ratio"].size
    points = points_of(values, "point", range(loads))
    measured = None
    if "sieve_size" in values:
        slope = float(texts["sieve_tail_slope"])
        measured = SizeCurve(values["sieve_size"], values["sieve_finer"], texts["unit"], slope)
    kind, fields = _states(values, texts, loads)
    return kind(
        material=material_of(json.loads(texts["material"])),
        unit=texts["unit"],
        stress_ratio=values["stress_ratio"],
        stress=values.get("stress"),
        pmf=values["pmf"],
        crushes=values["crushes"],
        mass_error=values["mass_error"],
        engine=texts["engine"],
        scheme=texts["scheme"],
        notes=tuple(json.loads(texts["notes"])),
        warnings=tuple(json.loads(texts["warnings"])),
        points=tuple(tuple(points[k]) for k in range(loads)),
        reports=tuple(report_of(record) for record in json.loads(texts["reports"])),
        recipe=Recipe.from_json(texts["recipe"]) if texts["recipe"] else None,
        measured=measured,
        **fields,
    )


def _states(values: Arrays, texts: dict[str, str], loads: int) -> tuple[type[ResultData], dict[str, Any]]:
    """Class of a stored result, with its grid, its start, its fabrics, and the fields that this class adds."""
    grid, mean = grid_of(json.loads(texts["grid"])), cast("Mean", texts["mean"])
    if isinstance(grid, ResolvedGrid):
        grading, material = grading_of(json.loads(texts["grading"])), material_of(json.loads(texts["material"]))
        found: dict[str, Any] = {"grid": grid, "grading": grading, "fabrics": (None,) * loads}
        start = start_fabric(material, grading, grid, mean)
        return ResolvedData, found | {"start": start} | {name: values[name] for name in RESOLVED_ROWS}
    kept = [int(load) for load in values.get("fabric_load", ())]
    settled = dict(zip(kept, (float(at) for at in values.get("settled_at", ())), strict=True))
    settled[START] = json.loads(texts["start_settled_at"]) if texts["start_settled_at"] != "null" else np.nan
    largest = float(texts.get("largest", 0.0))  # missing in the first files
    made = fabrics_of(values, grid, mean, settled, largest)
    fabrics: tuple[Fabric | None, ...] = tuple(made.get(k) for k in range(loads))
    found = {"grid": grid, "start": made[START], "fabrics": fabrics}
    rings: dict[str, Any] = json.loads(texts.get("lattice", "{}"))  # missing in the first files
    if not rings:
        return ResultData, found
    rings |= {name: values[name] for name in ("cdf_error", "crushes_error")}
    rings["start_points"] = tuple(points_of(values, "start_point", [START])[START])
    return LatticeData, found | rings

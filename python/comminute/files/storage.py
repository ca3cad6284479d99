"""Results in NetCDF files: readable by anything that reads NetCDF 4, and by this library without a bit lost."""

from __future__ import annotations

import hashlib
import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from comminute._core import Fabric, LogGrid, ParameterError, PointMass, __version__
from comminute.files.fabric_storage import START, columns, fabric_variables, fabrics_of, rows_of
from comminute.runs.recipe import Recipe, grid_record, material_of, material_record, report_of, report_record
from comminute.runs.results import LatticeData, ResultData
from comminute.util.optional import needs
from comminute.util.texts import is_file, shorten
from comminute.util.whole_files import uninterrupted, write_whole

LAYOUT = "comminute result 1"
RINGS = ("cells", "replicas", "seed")
SEAL = b"comminute sha256 "
SEAL_SIZE = len(SEAL) + 64 + 1
PACKING = {"zlib": True, "complevel": 4, "shuffle": True, "fletcher32": True, "_FillValue": None}


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
        "psibar": ("psibar", result.psi, {"long_name": "log neighbourhood grainsize at bin centres", "units": "1"}),
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
    points = [[k, *point] for k, exact in enumerate(result.points) for point in exact]
    variables |= columns("point", points, {"load": "load index", "psi": "exact log grainsize", "mass": "mass fraction"})
    if isinstance(result, LatticeData):
        variables["cdf_error"] = (("load", "psi"), result.cdf_error, {"long_name": "standard error of cdf"})
        variables["crushes_error"] = ("load", result.crushes_error, {"long_name": "standard error of crushes"})
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
        "layout": LAYOUT,
        "comminute_version": __version__,
        "engine": result.engine,
        "scheme": result.scheme,
        "unit": result.unit,
        "mean": result.start.mean,
        "start_settled_at": json.dumps(result.start.settled_at),
        "material": json.dumps(material_record(result.material)),
        "grid": json.dumps(grid_record(result.grid)),
        "notes": json.dumps(list(result.notes)),
        "warnings": json.dumps(list(result.warnings)),
        "reports": json.dumps([report_record(report) for report in result.reports]),
        "lattice": json.dumps({name: getattr(result, name) for name in RINGS if isinstance(result, LatticeData)}),
        "recipe": "" if result.recipe is None else result.recipe.to_json(),
        "case": "" if result.recipe is None else result.recipe.case,
    }


def _seal(file: Path) -> None:
    """Write a fingerprint of the file behind its end, where readers of HDF5 do not look."""
    with file.open("rb") as whole:
        digest = hashlib.file_digest(whole, "sha256").hexdigest()
    with file.open("ab") as end:
        end.write(SEAL + digest.encode() + b"\n")


def _require_sealed(file: Path) -> None:
    """Refuse a file that is not as it was written: HDF5 may read a damaged one as another, or never come to an end."""
    content = file.read_bytes()
    body, seal = content[:-SEAL_SIZE], content[-SEAL_SIZE:]
    if seal == SEAL + hashlib.sha256(body).hexdigest().encode() + b"\n":
        return
    if content[:8] != b"\x89HDF\r\n\x1a\n":
        raise ParameterError(f"{file.name} is no NetCDF 4 file; give a result file (.nc)")
    raise ParameterError(
        f"{file.name} is no result as comminute wrote it: it is damaged, cut short, or was changed by another program; "
        "run it again"
    )


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


def save_netcdf(result: ResultData, path: Path) -> Path:
    """Write a result to a NetCDF file; see `Result.save`."""
    require_netcdf(f"saving {path.name}")
    data = to_dataset(result)
    packing = {name: PACKING if data[name].ndim else {} for name in data.variables}

    def write(file: Path) -> None:
        data.to_netcdf(file, engine="h5netcdf", encoding=packing)
        _seal(file)

    return write_whole(path, write)


def read_netcdf(file: Path) -> ResultData:
    """Read a result, of a lattice as `LatticeData`, from a file that `save_netcdf` wrote; see `open_result`."""
    xr = require_netcdf("open_result")
    if not is_file(file):
        raise ParameterError(f"{shorten(str(file), 200)} does not exist; give a result file (.nc)")
    _require_sealed(file)
    with uninterrupted():
        data = xr.load_dataset(file, engine="h5netcdf", decode_cf=False)
    layout = str(data.attrs.get("layout", ""))
    if layout != LAYOUT:
        raise ParameterError(
            f"{file.name} has the layout '{shorten(layout)}', not '{LAYOUT}'; it needs another version"
        )
    return _result(data)


def _result(data: Any) -> ResultData:
    texts = {key: str(value) for key, value in data.attrs.items()}
    grid = LogGrid(**json.loads(texts["grid"]))
    values = {name: np.array(data[name].values) for name in data.variables}
    mean: Any = texts["mean"]
    loads = [int(load) for load in values.get("fabric_load", ())]
    settled = dict(zip(loads, (float(at) for at in values.get("settled_at", ())), strict=True))
    settled[START] = json.loads(texts["start_settled_at"]) if texts["start_settled_at"] != "null" else np.nan
    made = fabrics_of(values, grid, mean, settled)
    fabrics: list[Fabric | None] = [made.get(k) for k in range(values["stress_ratio"].size)]
    points: list[list[PointMass]] = [[] for _ in fabrics]
    for load, psi, mass in rows_of(values, "point", ("load", "psi", "mass")):
        points[int(load)].append(PointMass(psi, mass))
    rings: dict[str, Any] = json.loads(texts.get("lattice", "{}"))  # missing in the first files
    if rings:
        rings |= {name: values[name] for name in ("cdf_error", "crushes_error")}
    made_again: ResultData = (partial(LatticeData, **rings) if rings else ResultData)(
        material=material_of(json.loads(texts["material"])),
        grid=grid,
        start=made[START],
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
        fabrics=tuple(fabrics),
        points=tuple(tuple(exact) for exact in points),
        reports=tuple(report_of(record) for record in json.loads(texts["reports"])),
        recipe=Recipe.from_json(texts["recipe"]) if texts["recipe"] else None,
    )
    return made_again

"""Response tables in NetCDF files: readable by anything that reads NetCDF 4, and back to the bit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from comminute._core import __version__
from comminute.files.storage import FORMAT, MAGIC, PACKING, require_netcdf
from comminute.util.errors import wrong_file
from comminute.util.names import is_file
from comminute.util.whole_files import write_whole

if TYPE_CHECKING:
    from comminute._core import ResponseFamily, ResponseTable

Floats = npt.NDArray[np.float64]
LAYOUT = "comminute response table 1"
FAMILY_LAYOUT = "comminute response family 1"


def save_table(table: ResponseTable, gradings: Floats, scalars: Mapping[str, Floats], unit: str, path: Path) -> Path:
    """Write a response table: its loads, (T, N) gradings and (T,) scalars to be read, its bytes to be opened."""
    content = np.frombuffer(table.to_bytes(), dtype=np.uint8)
    variables: dict[str, Any] = {
        "cdf": (("load", "psi"), gradings, {"long_name": "mass fraction finer than edge_size", "units": "1"}),
        "table": ("byte", content, {"long_name": "the table as ResponseTable.to_bytes gives it"}),
    }
    variables |= {name: ("load", values, {"long_name": name, "units": "1"}) for name, values in scalars.items()}
    attributes = {"layout": LAYOUT, "unit": unit, "tolerance": table.tolerance}
    return _save(variables, _coordinates(table, unit), attributes, path)


def save_family(family: ResponseFamily, gradings: Floats, variable: str, unit: str, path: Path) -> Path:
    """Write a response family: its nodes and (M, T, N) gradings at the loads of the first table, and its bytes."""
    content = np.frombuffer(family.to_bytes(), dtype=np.uint8)
    dimensions = ("node", "load", "psi")
    variables: dict[str, Any] = {
        "cdf": (dimensions, gradings, {"long_name": "mass fraction finer than edge_size", "units": "1"}),
        "family": ("byte", content, {"long_name": "the family as ResponseFamily.to_bytes gives it"}),
    }
    coords = _coordinates(family.tables[0], unit) | {"value": ("node", family.values, {"long_name": variable})}
    return _save(variables, coords, {"layout": FAMILY_LAYOUT, "unit": unit, "variable": variable}, path)


def _coordinates(table: ResponseTable, unit: str) -> dict[str, Any]:
    return {
        "stress_ratio": ("load", table.stress_ratios, {"long_name": "stress ratio", "units": "1"}),
        "edge_size": ("psi", table.grid.edge_sizes[1:], {"long_name": "size at upper edges", "units": unit or "1"}),
    }


def _save(variables: Mapping[str, Any], coords: Mapping[str, Any], attributes: Mapping[str, Any], path: Path) -> Path:
    xr = require_netcdf(f"saving {path.name}")
    import h5netcdf  # noqa: PLC0415  (an optional dependency)
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415

    data = xr.Dataset(variables, coords, {**attributes, "source": f"comminute {__version__}"})

    def write(file: Path) -> None:
        with h5netcdf.File(file, "w", libver=FORMAT) as opened:
            data.dump_to_store(H5NetCDFStore(opened), encoding=dict.fromkeys(data.variables, PACKING))

    return write_whole(path, write)


def read_table(file: Path) -> tuple[bytes, str]:
    """Read the bytes of a table, and the unit of its sizes, from a file that `save_table` wrote."""
    content, attributes = _read(file, "ResponseTable", LAYOUT, "table")
    return content, str(attributes["unit"])


def read_family(file: Path) -> tuple[bytes, str, str]:
    """Read the bytes of a family, its variable, and the unit of its sizes, from a file that `save_family` wrote."""
    content, attributes = _read(file, "ResponseFamily", FAMILY_LAYOUT, "family")
    return content, str(attributes["variable"]), str(attributes["unit"])


def _read(file: Path, of: str, wanted: str, noun: str) -> tuple[bytes, Mapping[str, Any]]:
    xr = require_netcdf(f"{of}.open")
    rule = f"give a file that {of}.save wrote (.nc)"
    if not is_file(file):
        raise wrong_file(str(file), "does not exist", rule)
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise wrong_file(file.name, "is no NetCDF 4 file", rule)
    try:
        data = xr.load_dataset(file, engine="h5netcdf", decode_cf=False)
        layout, attributes = str(data.attrs["layout"]), data.attrs
        content = data[noun].values.tobytes() if layout == wanted else b""
    except Exception as error:  # whatever a damaged or foreign file makes the libraries below raise
        raise wrong_file(file.name, f"is damaged, or holds no response {noun}", "make it again") from error
    if layout != wanted:
        raise wrong_file(file.name, f"has the layout '{layout}', not '{wanted}'", "it needs another version")
    return content, attributes

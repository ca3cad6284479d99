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
    from comminute._core import ResponseTable

Floats = npt.NDArray[np.float64]
LAYOUT = "comminute response table 1"


def save_table(table: ResponseTable, gradings: Floats, scalars: Mapping[str, Floats], unit: str, path: Path) -> Path:
    """Write a response table: its loads, (T, N) gradings and (T,) scalars to be read, its bytes to be opened."""
    xr = require_netcdf(f"saving {path.name}")
    import h5netcdf  # noqa: PLC0415  (an optional dependency)
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415

    content = np.frombuffer(table.to_bytes(), dtype=np.uint8)
    variables: dict[str, Any] = {
        "cdf": (("load", "psi"), gradings, {"long_name": "mass fraction finer than edge_size", "units": "1"}),
        "table": ("byte", content, {"long_name": "the table as ResponseTable.to_bytes gives it"}),
    }
    variables |= {name: ("load", values, {"long_name": name, "units": "1"}) for name, values in scalars.items()}
    coords = {
        "stress_ratio": ("load", table.stress_ratios, {"long_name": "stress ratio", "units": "1"}),
        "edge_size": ("psi", table.grid.edge_sizes[1:], {"long_name": "size at upper edges", "units": unit or "1"}),
    }
    attributes = {"layout": LAYOUT, "source": f"comminute {__version__}", "unit": unit, "tolerance": table.tolerance}
    data = xr.Dataset(variables, coords, attributes)

    def write(file: Path) -> None:
        with h5netcdf.File(file, "w", libver=FORMAT) as opened:
            data.dump_to_store(H5NetCDFStore(opened), encoding=dict.fromkeys(data.variables, PACKING))

    return write_whole(path, write)


def read_table(file: Path) -> tuple[bytes, str]:
    """Read the bytes of a table, and the unit of its sizes, from a file that `save_table` wrote."""
    xr = require_netcdf("ResponseTable.open")
    if not is_file(file):
        raise wrong_file(str(file), "does not exist", "give a file that ResponseTable.save wrote (.nc)")
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise wrong_file(file.name, "is no NetCDF 4 file", "give a file that ResponseTable.save wrote (.nc)")
    try:
        data = xr.load_dataset(file, engine="h5netcdf", decode_cf=False)
        layout, content, unit = str(data.attrs["layout"]), data["table"].values.tobytes(), str(data.attrs["unit"])
    except Exception as error:  # whatever a damaged or foreign file makes the libraries below raise
        raise wrong_file(file.name, "is damaged, or holds no response table", "make it again") from error
    if layout != LAYOUT:
        raise wrong_file(file.name, f"has the layout '{layout}', not '{LAYOUT}'", "it needs another version")
    return content, unit

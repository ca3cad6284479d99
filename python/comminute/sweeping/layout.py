"""Names and states in the store of a sweep, and how one is opened, for which zarr and xarray are needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from comminute.util.errors import parameter_error, wrong_file
from comminute.util.optional import needs

Floats = npt.NDArray[np.float64]
How = Literal["product", "rows"]
Value = float | int | str | bool
Values = Sequence[Value] | npt.NDArray[Any]
WAITING, DONE, WARNED, FAILED = 0, 1, 2, 3  # states of a member
BY_LOAD = ("stress_ratio", "crushes", "mass_error", "fines", "breakage", "relative_breakage")
PERCENTS = (10.0, 30.0, 50.0, 60.0, 80.0, 90.0)
LONGEST = 256  # bytes of a message that are kept
ENDINGS = (".zarr", ".nc")


@dataclass(frozen=True)
class Rows:
    """Numbers of some members.

    Attributes
    ----------
    numbers : ndarray (B, T, C)
        By member and load: those of `BY_LOAD`, the sizes D_x, the mass finer than each size; NaN where there is none.
    status : ndarray (B,)
        State of each member.
    messages : list of str
        Why a member failed, or what its curves are not to be trusted for; empty where there is nothing to say.
    """

    numbers: Floats
    status: npt.NDArray[np.uint8]
    messages: list[str]


def require_ending(target: Path) -> Path:
    """Refuse a store whose name does not say of which kind it is."""
    if target.suffix not in ENDINGS:
        raise parameter_error("store", f"'{target}'", f"it must end in {' or '.join(ENDINGS)}")
    if not target.parent.is_dir():
        raise parameter_error("store", f"'{target}'", "its folder does not exist")
    return target


def growing(target: Path) -> Path:
    """Folder in which the members of a store are kept while there are any to come."""
    return target if target.suffix == ".zarr" else target.with_name(f"{target.stem}.part.zarr")


def open_dataset(path: Path) -> Any:
    """Dataset of a store of either kind, read as it is asked for.

    Raises
    ------
    ParameterError
        For a path that holds no sweep.
    ImportError
        Naming the extra to install.
    """
    try:
        import xarray  # noqa: PLC0415  (optional)
    except ImportError as error:
        raise needs("sweep", "xarray", "sweep") from error
    try:
        if path.is_dir():
            zarr_module()
            dataset = xarray.open_dataset(path, engine="zarr", consolidated=False, chunks=None, mask_and_scale=False)
        else:
            dataset = xarray.open_dataset(path, engine="h5netcdf", mask_and_scale=False)
    except (FileNotFoundError, KeyError, ValueError, OSError):
        raise wrong_file(path.name, "is no sweep of comminute", "name a store that comminute sweep wrote") from None
    if "plan" not in dataset.attrs:
        raise wrong_file(path.name, "is no sweep of comminute", "name a store that comminute sweep wrote")
    return dataset


def zarr_module() -> Any:
    """Import zarr; the error names the extra where it is missing."""
    try:
        import zarr  # noqa: PLC0415  (optional)
    except ImportError as error:
        raise needs("sweep", "zarr", "sweep") from error
    return zarr

"""Results from files, in the class that their users meet."""

from __future__ import annotations

import os
from pathlib import Path

from comminute.files.storage import read_netcdf
from comminute.result import LatticeResult, ResolvedResult, Result
from comminute.runs.results import LatticeData, ResolvedData, ResultData

CLASSES: dict[type[ResultData], type[Result]] = {LatticeData: LatticeResult, ResolvedData: ResolvedResult}


def open_result(path: str | os.PathLike[str]) -> Result:
    """Read a result from a NetCDF file that `Result.save` wrote: equal to the one that was saved.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    Result

    Raises
    ------
    ParameterError
        For a file that is missing, damaged, or no result.
    ImportError
        If xarray, h5netcdf or h5py is missing; the message names the extra to install.

    Warns
    -----
    EditedFileWarning
        If another program changed arrays or attributes of the file, and they still fit together.

    Examples
    --------
    >>> import comminute as cm, pathlib, tempfile
    >>> result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8])
    >>> path = result.save(pathlib.Path(tempfile.mkdtemp(), "run.nc"))
    >>> cm.open_result(path) == result
    True
    """
    data = read_netcdf(Path(path))
    kind = (
        LatticeResult if isinstance(data, LatticeData) else ResolvedResult if isinstance(data, ResolvedData) else Result
    )
    return kind(**vars(data))

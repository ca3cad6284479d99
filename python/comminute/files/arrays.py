"""Results as NumPy's own files: the arrays alone, for whoever has no NetCDF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from comminute._core import __version__
from comminute.runs.results import ResultData
from comminute.util.whole_files import write_whole


def save_npz(result: ResultData, path: Path) -> Path:
    """Write the arrays of a result to an .npz file; see `Result.save`."""
    names = ("stress_ratio", "psi", "size", "edge_size", "pmf", "cdf", "crushes", "fines", "mass_error")
    arrays: dict[str, Any] = {name: getattr(result, name) for name in names}
    if result.stress is not None:
        arrays["stress"] = result.stress
    kept = [fabric for fabric in result.fabrics if fabric is not None]
    if kept:
        arrays["fabric"] = kept[-1].binned().probability
    texts = {"engine": result.engine, "scheme": result.scheme, "unit": result.unit}
    texts |= {"material": repr(result.material), "version": __version__}
    arrays |= {name: np.array(text) for name, text in texts.items()}

    def write(file: Path) -> None:
        with file.open("wb") as stream:  # given a name, NumPy would add its own ending
            np.savez_compressed(stream, **arrays)

    return write_whole(path, write)

"""Sweeps over the keys of a case, on threads, processes or machines. Needs the extra `sweep`."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from comminute.result import Result
from comminute.sweeping.layout import (
    BY_LOAD,
    FAILED,
    PERCENTS,
    WAITING,
    WARNED,
    How,
    Values,
    growing,
    open_dataset,
    require_ending,
)
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords
from comminute.util.optional import needs


class Sweep:
    """Numbers of the members of a sweep, in the store that they were written to.

    Parameters
    ----------
    store : path-like
        Folder (.zarr) or file (.nc) that `sweep` wrote; one that still grows has the members that are finished.

    Attributes
    ----------
    path : pathlib.Path
        The store.
    keys : tuple of str
        Keys of the case that vary.

    Raises
    ------
    ParameterError
        For a path that holds no sweep.
    ImportError
        Naming the extra to install.

    Examples
    --------
    >>> import comminute as cm
    >>> case = {
    ...     "material": {"fabric_width": 0.3},
    ...     "grading": {"kind": "fuller", "largest": 2.0},
    ...     "load": {"stress_ratio": [1.0, 100.0]},
    ... }
    >>> import tempfile, pathlib
    >>> store = pathlib.Path(tempfile.mkdtemp()) / "widths.zarr"
    >>> swept = cm.sweep(case, over={"material.fabric_width": [0.1, 0.3]}, store=store)
    >>> narrow, wide = cm.Sweep(store).values("breakage")[:, -1]
    >>> bool(narrow < wide), swept.failed
    (True, {})
    """

    def __init__(self, store: str | os.PathLike[str]) -> None:
        self.path = Path(store)
        folder = growing(self.path)
        self._data = open_dataset(folder if folder.exists() else self.path)
        self.keys: tuple[str, ...] = tuple(json.loads(self._data.attrs["plan"])["keys"])

    def __len__(self) -> int:
        return int(self._data.sizes["member"])

    def __reduce__(self) -> tuple[type[Sweep], tuple[Path]]:
        """Pickle by the store's place."""
        return Sweep, (self.path,)

    def __eq__(self, other: object) -> bool:
        """Equal in every number of every member, wherever the stores are."""
        if not isinstance(other, Sweep):
            return NotImplemented
        same = self._data.attrs["plan"] == other._data.attrs["plan"]
        return bool(same and self._data.equals(other._data))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        done = int(np.sum(self.status != WAITING))
        keys = ", ".join(self.keys)
        return f"<Sweep: {done} of {len(self)} members over {keys}; {len(self.failed)} failed; {self.path.name}>"

    @property
    def status(self) -> npt.NDArray[np.uint8]:
        """(M,) state of each member: 0 waiting, 1 done, 2 done with a warning, 3 failed."""
        return np.asarray(self._data["status"].values, dtype=np.uint8)

    @property
    def failed(self) -> dict[int, str]:
        """Why members have no numbers, by member."""
        return self._messages(FAILED)

    @property
    def warned(self) -> dict[int, str]:
        """Warnings on the curves of members, by member; see `ResolutionWarning`."""
        return self._messages(WARNED)

    def _messages(self, state: int) -> dict[int, str]:
        """Messages of the members in a state, by member."""
        messages = self._data["message"].values
        return {int(k): bytes(messages[k]).decode() for k in np.flatnonzero(self.status == state)}

    def values(self, name: str) -> npt.NDArray[Any]:
        """Numbers by name, (M,) for a key that varies, (M, T) by load.

        Parameters
        ----------
        name : str
            A key such as "material.fabric_width"; "stress_ratio", "crushes", "mass_error", "fines", "breakage"
            (Einav's), "relative_breakage" (Hardin's, of sizes with a unit); or a size such as "D50", one of those kept.

        Raises
        ------
        ParameterError
            For a name that the store does not have.
        """
        percents = [float(percent) for percent in self._data["percent"].values]
        kept = [f"D{percent:g}" for percent in percents]
        if name.upper() in kept:
            return np.asarray(self._data["percentile"].isel(percent=kept.index(name.upper())).values)
        if name not in self._data or name in ("percentile", "finer", "percent", "size", "message"):
            numbers = [key for key in self._data.data_vars if self._data[key].dims == ("member", "load")]
            known = ", ".join([*self.keys, *map(str, numbers), *kept])
            raise parameter_error("name", f"'{name}'", f"it must be one of {known}")
        return np.asarray(self._data[name].values)

    def to_xarray(self) -> Any:
        """Dataset with dims member, load, percent and size, read from the store as it is asked for.

        Returns
        -------
        xarray.Dataset
        """
        return self._data.set_coords([*self.keys])

    def to_pandas(self, load: int = -1) -> Any:
        """DataFrame with a row for each member: the keys that vary, its state, and its numbers after one load.

        Parameters
        ----------
        load : int
            Index of the load.

        Returns
        -------
        pandas.DataFrame
        """
        import pandas  # noqa: PLC0415  (xarray, which read the store, brings it)

        columns = {name: self._data[name].values for name in (*self.keys, "status")}
        after = self._data.isel(load=load)
        columns |= {name: after[name].values for name in BY_LOAD}
        sizes = after["percentile"].values
        columns |= {f"D{percent:g}": sizes[:, k] for k, percent in enumerate(self._data["percent"].values)}
        columns["message"] = [bytes(text).decode() for text in self._data["message"].values]
        return pandas.DataFrame(columns).rename_axis("member")

    def result(self, member: int) -> Result:
        """Run one member again, whole: its gradings, notes and warnings.

        Parameters
        ----------
        member : int
            Index of the member.

        Returns
        -------
        Result

        Raises
        ------
        ParameterError
            For a member that failed, as it did.
        IndexError
            If there is no such member.
        """
        try:
            from comminute.cases.running import result_of  # noqa: PLC0415  (pydantic is optional)
            from comminute.sweeping.plan import Plan  # noqa: PLC0415
        except ImportError as error:
            raise needs("sweep", "pydantic", "Sweep.result") from error
        place = range(len(self))[member]
        values = [self._data[key].values[place].item() for key in self.keys]
        return result_of(Plan.from_json(self._data.attrs["plan"]).case(values))


@suggests_keywords
def sweep(
    case: str | os.PathLike[str] | Mapping[str, Any],
    over: Mapping[str, Values] | None = None,
    *,
    how: How = "product",
    store: str | os.PathLike[str] = "sweep.zarr",
    executor: Executor | Any = None,
    jobs: int = 1,
    percents: Sequence[float] = PERCENTS,
    sizes: Sequence[float] | None = None,
    chunk: int | None = None,
    resume: bool = False,
    force: bool = False,
    on_chunk: Callable[[int, int], object] | None = None,
) -> Sweep:
    """Run a case with many values of some of its keys, and keep numbers of each member in one store.

    Members are handed to the executor some at a time, a chunk, and written when they come back. A member that cannot be
    run is kept as failed, with the reason, and stops no other. A sweep that was stopped, even killed, goes on from the
    chunks that are written.

    Parameters
    ----------
    case : path-like or mapping
        Case file, or its tables. Lists in it, in place of single values, vary too.
    over : mapping of str to sequence, optional
        Values by key, {"material.fabric_width": [0.1, 0.2]}; they take the place of what the case has.
    how : {"product", "rows"}
        Every combination of the values, the last key fastest; or the first of each list, the second of each, and so on.
    store : path-like
        Zarr folder (.zarr) or NetCDF file (.nc), which is a Zarr folder beside it until the last member is there.
    executor : concurrent.futures.Executor or distributed.Client, optional
        Whatever runs the chunks: threads, processes, or the workers of a Dask cluster, on which
        comminute with the extra `sweep` is installed. Left out, `jobs` threads.
    jobs : int
        Number of those threads; with 1 none is started.
    percents : sequence of float
        Percentages whose sizes D_x are kept.
    sizes : sequence of float, optional
        Sizes at which the mass finer is kept. Left out, the sieves of the first start, or 25 sizes over three decades.
    chunk : int, optional
        Members of a chunk. Left out, as many as take about half a second.
    resume : bool
        Go on with a sweep that was stopped; the same call with other members or numbers is refused.
    force : bool
        Throw away what is in the store.
    on_chunk : callable, optional
        Called with the number of finished members and that of all, after each chunk.

    Returns
    -------
    Sweep

    Raises
    ------
    ParameterError
        For a case, a key, or a first member that cannot run; for a store that holds another sweep.
    FileExistsError
        For a store that exists, without `resume` or `force`; or that another sweep is writing.
    ImportError
        Naming the extra to install.
    KeyboardInterrupt
        On Ctrl-C, when the chunks that came back are written.

    Examples
    --------
    >>> import comminute as cm, pathlib, tempfile
    >>> case = {"grading": {"kind": "monodisperse", "size": 1.0}, "load": {"stress_ratio": [8.0]}}
    >>> over = {"material.weibull_modulus": [3.0, 6.0], "material.fabric_width": [0.05, 0.1, -1.0]}
    >>> store = pathlib.Path(tempfile.mkdtemp()) / "sweep.zarr"
    >>> swept = cm.sweep(case, over, store=store, percents=[50], jobs=2)
    >>> swept.values("D50").shape, list(swept.failed)
    ((6, 1), [2, 5])
    >>> swept.failed[2]
    'case [material]: fabric_width is -1; it must be greater than 0 (inf switches the fabric off)'
    """
    if jobs < 1:
        raise parameter_error("jobs", jobs, "it must be at least 1")
    if chunk is not None and chunk < 1:
        raise parameter_error("chunk", chunk, "it must be at least 1")
    try:
        from comminute.sweeping.driving import drive  # noqa: PLC0415  (pydantic, zarr and xarray are optional)
        from comminute.sweeping.plan import planned  # noqa: PLC0415
    except ImportError as error:
        raise needs("sweep", "pydantic", "sweep") from error
    target = require_ending(Path(store))
    plan, members = planned(case, over, how, percents, sizes)
    drive(plan, members, target, executor, jobs=jobs, chunk=chunk, resume=resume, force=force, on_chunk=on_chunk)
    return Sweep(target)

"""The one store of a sweep while it grows: a Zarr folder, and a NetCDF file in the end where one is wanted."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from comminute._core import __version__
from comminute.sweeping.layout import BY_LOAD, LONGEST, WAITING, Rows, growing, open_dataset, zarr_module
from comminute.sweeping.plan import Members, Plan
from comminute.util.errors import wrong_file
from comminute.util.whole_files import write_whole

DESCRIPTIONS = {
    "stress_ratio": "load",
    "crushes": "mean number of crushes a cell has been through",
    "mass_error": "total mass less 1",
    "fines": "share of the mass in the fines bin",
    "breakage": "Einav's breakage index since the start, ultimate dimension 2.6",
    "relative_breakage": "Hardin's relative breakage since the start",
    "percentile": "size that a percentage of the mass is finer than",
    "finer": "mass fraction finer than a size",
}


class SweepStore:
    """Numbers of a sweep by member, load and kind, written some members at a time.

    A chunk's state is written after its numbers, so that what a stop leaves behind is whole as far as it says it is.
    """

    def __init__(self, group: Any, plan: Plan) -> None:
        self._arrays = dict(group.arrays())
        self.plan = plan
        self.chunk = int(group.attrs["members_per_chunk"])
        self.count = int(self._arrays["status"].shape[0])

    @classmethod
    def create(cls, folder: Path, plan: Plan, members: Members, chunk: int, attributes: dict[str, str]) -> Self:
        """Make an empty store in a folder that is made for it."""
        zarr = zarr_module()
        about: dict[str, Any] = {
            "title": "sweep of comminute",
            "comminute_version": __version__,
            "members_per_chunk": chunk,
            "plan": plan.to_json(),
        }
        group = zarr.open_group(folder, mode="w", zarr_format=2, attributes=attributes | about)
        many, loads = members.count, plan.loads

        def add(name: str, values: npt.NDArray[Any], *dims: str, text: str = "") -> None:
            array = group.create_array(
                name,
                data=values,
                chunks=tuple(max(n, 1) for n in values.shape),
                attributes={"_ARRAY_DIMENSIONS": list(dims), **({"long_name": text} if text else {})},
            )
            del array

        def make(name: str, shape: tuple[int, ...], dims: tuple[str, ...], dtype: str, fill: Any) -> None:
            attributes = {"_ARRAY_DIMENSIONS": list(dims)}
            if name in DESCRIPTIONS:
                attributes["long_name"] = DESCRIPTIONS[name]  # type: ignore[assignment]
            group.create_array(
                name,
                shape=shape,
                chunks=(min(chunk, many), *(max(n, 1) for n in shape[1:])),
                dtype=dtype,
                fill_value=fill,
                compressors=None,
                config={"write_empty_chunks": True},
                attributes=attributes,
            )

        for key, column in members.columns.items():
            add(key, column, "member", text="value of the case's key")
        add("percent", np.array(plan.percents), "percent")
        add("size", np.array(plan.sizes), "size")
        for name in BY_LOAD:
            make(name, (many, loads), ("member", "load"), "f8", np.nan)
        make("percentile", (many, loads, len(plan.percents)), ("member", "load", "percent"), "f8", np.nan)
        make("finer", (many, loads, len(plan.sizes)), ("member", "load", "size"), "f8", np.nan)
        make("message", (many,), ("member",), f"S{LONGEST}", b"")
        make("status", (many,), ("member",), "u1", WAITING)
        return cls(group, plan)

    @classmethod
    def open(cls, folder: Path) -> Self:
        """Open a store to go on with it.

        Raises
        ------
        ParameterError
            For a folder that holds none.
        """
        zarr = zarr_module()
        try:
            group = zarr.open_group(folder, mode="r+", zarr_format=2)
            return cls(group, Plan.from_json(group.attrs["plan"]))
        except (KeyError, ValueError, TypeError, FileNotFoundError, NotADirectoryError):
            raise wrong_file(folder.name, "is no sweep of comminute", "name another store") from None

    def values(self) -> dict[str, npt.NDArray[Any]]:
        """Values of the keys that vary, by member."""
        return {key: self._arrays[key][:] for key in self.plan.keys}

    def states(self) -> npt.NDArray[np.uint8]:
        """(M,) state of each member."""
        return np.asarray(self._arrays["status"][:])

    def waiting(self) -> list[tuple[int, int]]:
        """First and last member, the last not among them, of the chunks that are to be run."""
        states = self.states()
        firsts = range(0, self.count, self.chunk)
        chunks = [(first, min(first + self.chunk, self.count)) for first in firsts]
        return [(first, last) for first, last in chunks if np.any(states[first:last] == WAITING)]

    def put(self, first: int, rows: Rows) -> None:
        """Write a chunk."""
        place = slice(first, first + rows.status.size)
        for column, name in enumerate(BY_LOAD):
            self._arrays[name][place] = rows.numbers[..., column]
        after = len(BY_LOAD)
        until = after + len(self.plan.percents)
        if until > after:
            self._arrays["percentile"][place] = rows.numbers[..., after:until]
        if rows.numbers.shape[-1] > until:
            self._arrays["finer"][place] = rows.numbers[..., until:]
        if any(rows.messages):
            self._arrays["message"][place] = np.array([_short(text) for text in rows.messages], dtype=f"S{LONGEST}")
        self._arrays["status"][place] = rows.status


def _short(text: str) -> bytes:
    """Text of a message in as many bytes as the store has for it, no letter cut in two."""
    return text.encode()[:LONGEST].decode(errors="ignore").encode()


def finish(target: Path) -> None:
    """Make the NetCDF file of a store that is complete, where one is wanted, in place of the folder it grew in."""
    folder = growing(target)
    if folder == target:
        return
    dataset = open_dataset(folder)
    with closing(dataset):
        write_whole(target, lambda file: dataset.to_netcdf(file, engine="h5netcdf"))
    shutil.rmtree(folder)


def remove(target: Path) -> None:
    """Remove a store, whole or growing."""
    for path in {target, growing(target)}:
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)

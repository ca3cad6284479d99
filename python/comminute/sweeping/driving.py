"""Chunks of a sweep, handed out to an executor and written as they come back. Needs pydantic, zarr and xarray."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from comminute.cases.running import claimed
from comminute.sweeping.layout import WAITING, Rows, growing, open_dataset
from comminute.sweeping.members import rows_of
from comminute.sweeping.plan import Members, Plan
from comminute.sweeping.store import SweepStore, finish, remove
from comminute.util.errors import OutputExistsError, parameter_error, wrong_file

IN_FLIGHT = 64  # chunks that are handed out and not yet written
LEAST_CHUNKS = 16  # where there are enough members, so that no worker waits long for the last
MOST_IN_CHUNK = 1000
SECONDS = 0.5  # of one worker on a chunk, which is what a stop may lose


def drive(
    plan: Plan,
    members: Members,
    target: Path,
    executor: Any,
    *,
    jobs: int,
    chunk: int | None,
    resume: bool,
    force: bool,
    on_chunk: Callable[[int, int], object] | None,
) -> None:
    """Run the members of a plan into a store; see `sweep`."""
    with executor_of(executor, jobs) as run, claimed(target):
        folder = growing(target)
        if force and not resume:
            remove(target)
        if resume and target.exists() and not folder.exists():  # a NetCDF file, which is there when all members are
            _require_same(*_kept_in(target), plan, members, target)
            return
        if resume and folder.exists():
            store = SweepStore.open(folder)
            _require_same(store.plan, store.values(), plan, members, target)
        elif folder.exists() or target.exists():
            found = folder if folder.exists() else target
            raise OutputExistsError(f"{found} exists; resume=True goes on with it, force=True throws it away")
        else:
            store = SweepStore.create(folder, plan, members, chunk or _chunk(plan, members), _units(plan, members))
        run_chunks(run, store, members, on_chunk)
        finish(target)


def _kept_in(target: Path) -> tuple[Plan, dict[str, npt.NDArray[Any]]]:
    """Plan of a store that is whole, and the values of its members."""
    with closing(open_dataset(target)) as data:
        plan = Plan.from_json(data.attrs["plan"])
        return plan, {key: np.asarray(data[key].values) for key in plan.keys}


class _InPlace(Executor):
    """The calling thread, which starts no other: one chunk, then its writing, and so on."""

    def submit(self, work: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Do it now."""
        future = Future[Any]()
        future.set_result(work(*args, **kwargs))
        return future


def run_chunks(
    executor: Executor, store: SweepStore, members: Members, on_chunk: Callable[[int, int], object] | None
) -> None:
    """Take all chunks that wait through an executor, and write them as they come back, in any order."""
    chunks = iter(store.waiting())
    most = 1 if isinstance(executor, _InPlace) else IN_FLIGHT
    done = int(np.sum(store.states() != WAITING))
    flying = dict[Future[Rows], int]()

    def hand_out() -> None:
        while len(flying) < most and (ends := next(chunks, None)) is not None:
            flying[executor.submit(rows_of, store.plan, members.rows(*ends))] = ends[0]

    def write(future: Future[Rows]) -> int:
        rows = future.result()
        store.put(flying.pop(future), rows)
        return int(rows.status.size)

    try:
        hand_out()
        while flying:
            for future in wait(flying, return_when=FIRST_COMPLETED).done:
                done += write(future)
                if on_chunk is not None:
                    on_chunk(min(done, store.count), store.count)
            hand_out()
    except BaseException:
        for future in flying:
            future.cancel()
        for future in [future for future in flying if future.done() and not future.cancelled()]:
            with contextlib.suppress(Exception):  # that of the chunk that is being reported
                write(future)
        raise


@contextlib.contextmanager
def executor_of(given: Any, jobs: int) -> Iterator[Executor]:
    """Give the executor to use: one of a Dask client, the one given, or threads for this sweep alone."""
    if given is None and jobs == 1:
        yield _InPlace()
    elif given is None:
        threads = ThreadPoolExecutor(jobs)
        try:
            yield threads
        finally:
            threads.shutdown(wait=True, cancel_futures=True)
    elif hasattr(given, "get_executor"):
        yield given.get_executor(pure=False)
    elif isinstance(given, Executor):
        yield given
    else:
        rule = "it must be a concurrent.futures.Executor or a distributed.Client"
        raise parameter_error("executor", type(given).__name__, rule)


def _chunk(plan: Plan, members: Members) -> int:
    """Members that take about half a second, by what the first takes, or the first few where that is little."""
    each = math.inf
    for count in (1, min(4, members.count)):
        begun = time.perf_counter()
        rows_of(plan, members.rows(0, count))
        each = (time.perf_counter() - begun) / count
        if each > 0.1 * SECONDS:
            break
    return max(1, min(int(SECONDS / each), MOST_IN_CHUNK, math.ceil(members.count / LEAST_CHUNKS)))


def _units(plan: Plan, members: Members) -> dict[str, str]:
    """Units of the numbers, for the store."""
    units = plan.case(members.rows(0, 1)[0]).resolved.units
    return {"size_unit": units.size, "stress_unit": units.stress}


def _require_same(kept: Plan, values: dict[str, npt.NDArray[Any]], plan: Plan, members: Members, target: Path) -> None:
    """Refuse to go on with a store of another sweep."""
    # the case may have moved to another folder or machine since
    same = replace(kept, path="").to_json() == replace(plan, path="").to_json() and all(
        np.array_equal(values[key], column) for key, column in members.columns.items()
    )
    if not same:
        raise wrong_file(target.name, "belongs to another sweep", "force throws it away, or name another store")

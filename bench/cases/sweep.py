"""Sweeps: 10 000 materials on one grid of 128 bins, under 20 loads each, into one store.

On one thread, on two, and on a Dask cluster of two worker processes, whose start is not timed.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from distributed import Client, LocalCluster

import comminute as cm
from harness import OURS, PER_SECOND, Check, Contestant, Goal, Trial, largest_difference

BINS = 128
THREADED, DASK = f"{OURS}, 2 threads", f"{OURS}, Dask, 2 workers"
COARSEST = float(np.log(2.0))


def _case() -> dict[str, Any]:
    return {
        "units": {"size": "mm"},
        "material": {"reference_size": 2.0, "first_crush_stress": 1.2},
        "grading": {"kind": "power-law", "fractal_dimension": 2.3, "smallest": 0.02, "largest": 2.0},
        "grid": {"bins": BINS, "psi_min": COARSEST - 9.0, "psi_max": COARSEST},
        "load": {"stress": np.geomspace(1.2, 120.0, 20).tolist()},
    }


class Sweeps:
    """The sweep, into stores of their own, and what a run of some members by itself gives."""

    def __init__(self, count: int) -> None:
        random = np.random.default_rng(0)
        self.count = count
        self._folder = Path(tempfile.mkdtemp())
        self._over = {
            "material.fabric_width": random.uniform(0.05, 0.5, count),
            "material.weibull_modulus": random.uniform(2.0, 6.0, count),
            "material.first_crush_stress": random.uniform(1.0, 3.0, count),
        }

    def run(self, name: str, **options: Any) -> cm.Sweep:
        """Run it all."""
        store = self._folder / f"{name}.zarr"
        return cm.sweep(_case(), self._over, how="rows", store=store, **options)

    def contestant(self, name: str, **options: Any) -> Contestant:
        """Contestant that runs it all into a store that is not there."""

        def away() -> None:
            shutil.rmtree(self._folder / f"{name}.zarr", ignore_errors=True)

        return Contestant(name, lambda: self.run(name, **options), before=away, work=self.count)

    def checks(self, first: cm.Sweep, other: cm.Sweep, what: str) -> list[Check]:
        """Hold one against runs of some members, and the other against it."""
        members = list(range(0, self.count, max(self.count // 20, 1)))
        runs = np.array([first.result(member).percentile(50) for member in members])
        return [
            Check("runs of members", largest_difference(first.values("D50")[members], runs), 0.0),
            Check(what, 0.0 if first == other else 1.0, 0.0),
        ]


def on_threads(count: int) -> Trial:
    """One thread against two."""
    sweeps = Sweeps(count)
    return Trial(
        case="sweep",
        title=f"Sweep over three parameters, N = {BINS}, 20 loads, {count} members, one store",
        contestants=[sweeps.contestant(OURS), sweeps.contestant(THREADED, jobs=2)],
        checks=sweeps.checks(sweeps.run(OURS), sweeps.run(THREADED, jobs=2), "2 threads"),
        goals=[
            Goal("≥ 3 000 members a second", OURS, PER_SECOND, least=3000.0),
            Goal("≥ 1.9 × with 2 threads", OURS, THREADED, least=1.9),
        ],
        unit="member",
        note="members differ in fabric width, Weibull modulus and strength; the store is written as they finish",
    )


def on_dask(count: int, client: Any) -> Trial:
    """Two threads against a cluster of two processes."""
    sweeps = Sweeps(count)
    return Trial(
        case="sweep on a cluster",
        title=f"The same sweep by Dask, 2 workers, {count} members",
        contestants=[sweeps.contestant(THREADED, jobs=2), sweeps.contestant(DASK, executor=client)],
        checks=sweeps.checks(sweeps.run(THREADED, jobs=2), sweeps.run(DASK, executor=client), "Dask"),
        goals=[Goal("≤ 1.2 × the time of threads", DASK, THREADED, most=1.2)],
        unit="member",
        note="the cluster runs already",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Threads, then a cluster, which would take some time off them."""
    count = 200 if short else 10_000
    yield on_threads(count)
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield on_dask(count, client)

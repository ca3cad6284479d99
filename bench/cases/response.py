"""Response tables: making one, and a million material points that look their crushes and D50 up, beside solves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import comminute as cm
from contestants.model import Floats
from harness import OURS, Check, Contestant, Goal, Trial

MOST = 1e4
SOLVED = 100  # points that are solved one by one, for a rate
BUILD, CRUSHES, SIZES = f"{OURS}, table made", f"{OURS}, crushes looked up", f"{OURS}, D50 looked up"
SOLVE = f"{OURS}, {SOLVED} gradings solved"


def trial(bins: int, points: int) -> Trial:
    """One packing of a power law."""
    material, start = cm.Material(), cm.power_law(2.5, 1e-2, 1.0)
    grid = cm.fitting_grid(start, material, MOST, bins=bins)
    fabric, solver = cm.mixed_fabric(start, grid), cm.QuasiStatic(grid, material)
    table = cm.ResponseTable(material, fabric, largest=MOST, quantities=())
    loads = np.exp(np.random.default_rng(3).uniform(0.0, np.log(MOST), points))
    few = loads[:SOLVED].tolist()

    def solved() -> Floats:
        return np.array([solver.grading_after(fabric, load).grainsize for load in few])

    looked_up = np.array([table.pmf(load) for load in few])
    error = float(np.abs(np.cumsum(looked_up - solved(), axis=1)).max())
    return Trial(
        case="response table",
        title=f"Response table, {bins} bins, {points:,} points",
        contestants=[
            Contestant(CRUSHES, lambda: table.value("crushes", loads)),
            Contestant(SIZES, lambda: table.value("d50", loads)),
            Contestant(BUILD, lambda: cm.ResponseTable(material, fabric, largest=MOST, quantities=())),
            Contestant(SOLVE, solved),
        ],
        checks=[Check(f"gradings of {SOLVED} points", error, table.tolerance)],
        goals=[Goal("a million D50 in less time than 10 000 solves", SIZES, SOLVE, most=100.0 * points / 1e6)],
        size=bins,
        note=f"{table.loads.size} loads, tolerance {table.tolerance:g}, {table.nbytes / 1e6:.2f} MB; with derivatives",
    )


def trials(short: bool) -> Iterator[Trial]:
    """Bins as a host has them."""
    yield trial(64 if short else 256, 10_000 if short else 1_000_000)

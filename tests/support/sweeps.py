"""A sweep in a process of its own, to be killed; it prints how many members are written after each chunk."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import comminute as cm

MEMBERS, CHUNK = 60, 5
CASE: dict[str, Any] = {
    "units": {"size": "mm"},
    "material": {"reference_size": 2.0, "first_crush_stress": 1.2},
    "grading": {"kind": "power-law", "fractal_dimension": 2.3, "smallest": 0.02, "largest": 2.0},
    "grid": {"bins": 128, "psi_min": -9.5, "psi_max": 0.7},
    "load": {"stress": [1.2, 12.0, 120.0]},
}
OVER = {"material.fabric_width": np.linspace(0.05, 0.5, MEMBERS)}


def sweep(store: Path, *, resume: bool = False, pause: float = 0.0, jobs: int = 1) -> tuple[cm.Sweep, list[int]]:
    """Run it, waiting a while after each chunk; the sweep, and how many members were written after each."""
    reached = list[int]()

    def on_chunk(done: int, total: int) -> None:
        reached.append(done)
        print(f"{done} of {total}", flush=True)
        time.sleep(pause)

    found = cm.sweep(CASE, OVER, store=store, chunk=CHUNK, resume=resume, on_chunk=on_chunk, jobs=jobs)
    return found, reached


if __name__ == "__main__":
    sweep(Path(sys.argv[1]), pause=0.1)

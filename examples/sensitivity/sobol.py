"""Which parameter moves D50 and breakage most: Sobol indices of a sand under two stresses, by SALib.

python examples/sensitivity/sobol.py [FOLDER] [SAMPLES]     writes sensitivity.zarr and sensitivity.png there

Saltelli's sample of four parameters is a sweep with one member for each row; the analysis is SALib's. Needs the extras
`sweep` and `plot`, and SALib.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from SALib.analyze import sobol as sobol_indices
from SALib.sample import sobol as sobol_sample

mpl.use("Agg")  # no display is asked for
import matplotlib.pyplot as plt

import comminute as cm

CASE: dict[str, Any] = {
    "units": {"size": "mm", "stress": "MPa"},
    "material": {"reference_size": 2.0, "first_crush_stress": 2.0},
    "grading": {
        "kind": "sieves",
        "size": [2.0, 1.6, 1.0, 0.5, 0.16, 0.08],
        "percent_finer": [100.0, 93.0, 67.0, 33.0, 13.0, 1.0],
    },
    "load": {"stress": [8.0, 80.0]},
}
RANGES = {
    "material.fabric_width": (0.1, 0.5),
    "material.weibull_modulus": (2.0, 6.0),
    "material.first_crush_stress": (1.0, 4.0),
    "material.fragments.shape": (0.7, 1.5),
}
SHORT = ("fabric width", "Weibull modulus", "first crush stress", "fragments' shape")
NUMBERS = ("D50", "breakage")


def sensitivity(folder: Path, samples: int) -> tuple[cm.Sweep, dict[str, list[dict[str, npt.NDArray[np.float64]]]]]:
    """Sweep, and the Sobol indices S1 and ST of each number under each stress."""
    problem = {"num_vars": len(RANGES), "names": list(RANGES), "bounds": list(RANGES.values())}
    rows = sobol_sample.sample(problem, samples, calc_second_order=False, seed=1)
    over = {key: rows[:, k] for k, key in enumerate(RANGES)}
    swept = cm.sweep(CASE, over, how="rows", store=folder / "sensitivity.zarr", jobs=2, force=True)
    found = {
        name: [
            sobol_indices.analyze(problem, swept.values(name)[:, load], calc_second_order=False, seed=1)
            for load in range(len(CASE["load"]["stress"]))
        ]
        for name in NUMBERS
    }
    return swept, found


def draw(found: dict[str, list[dict[str, npt.NDArray[np.float64]]]], path: Path) -> None:
    """Bars of the total indices, with their intervals of 95 %."""
    figure, axes = plt.subplots(1, len(NUMBERS), figsize=(7.0, 2.8), sharey=True, layout="constrained")
    for axis, (name, loads) in zip(axes, found.items(), strict=True):
        for k, (stress, indices) in enumerate(zip(CASE["load"]["stress"], loads, strict=True)):
            place = np.arange(len(RANGES)) + 0.36 * (0.5 - k)
            axis.barh(place, indices["ST"], 0.34, xerr=indices["ST_conf"], label=f"{stress:g} MPa", color=f"C{k}")
        axis.set_title(name)
        axis.set_xlabel("share of the variance (total Sobol index)")
    axes[0].set_yticks(range(len(RANGES)), SHORT)
    axes[-1].legend(frameon=False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    to = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out")
    to.mkdir(parents=True, exist_ok=True)
    sweep, totals = sensitivity(to, int(sys.argv[2]) if len(sys.argv) > 2 else 512)
    print(sweep)
    for number, stresses in totals.items():
        for load, index in zip(CASE["load"]["stress"], stresses, strict=True):
            shares = ", ".join(f"{key} {share:.2f}" for key, share in zip(SHORT, index["ST"], strict=True))
            print(f"{number} at {load:g} MPa: {shares}")
    draw(totals, to / "sensitivity.png")
    print(f"wrote {to / 'sensitivity.png'}")

"""From the shell to a first result: a new Python process each time, files warm in the system's cache."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import partial

import numpy as np

import comminute as cm
from harness import OURS, SECONDS, Check, Contestant, Goal, Trial

FIRST_RESULT = """
import comminute as cm
result = cm.Simulation(cm.Material(), cm.power_law(2.5, 2.5e-3, 1.0)).run(stress_ratio=[2.0, 100.0])
print(repr(float(result.crushes[-1])))
"""
SCRIPTS = {OURS: FIRST_RESULT, "import numpy": "import numpy", "bare Python": "pass"}


def _run(script: str) -> str:
    return subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout


def trials(short: bool) -> Iterator[Trial]:
    """One trial."""
    here = cm.Simulation(cm.Material(), cm.power_law(2.5, 2.5e-3, 1.0)).run(stress_ratio=[2.0, 100.0])
    error = abs(float(_run(FIRST_RESULT)) - float(np.asarray(here.crushes)[-1]))
    yield Trial(
        case="cold start",
        title="Cold Python to the first result of `Simulation` with defaults",
        contestants=[Contestant(name, partial(_run, script)) for name, script in SCRIPTS.items()],
        checks=[Check("crushes of the new process", error, 0.0)],
        goals=[Goal("< 0.3 s, NumPy included", OURS, SECONDS, most=0.3)],
        note="wall time of the whole process, interpreter start and end included",
    )

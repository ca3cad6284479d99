"""Memory that a solve holds beside its states, by the operating system's count."""

import subprocess
import sys

import pytest

SCRIPT = """
from pathlib import Path

import comminute as cm

bins = 2000
grid, material = cm.LogGrid(-6.0, 1.0, bins), cm.Material()
start = cm.mixed_fabric(cm.power_law(2.5, 2.5e-3, 1.0), grid)
solver = cm.QuasiStatic(grid, material)


def kilobytes(name):
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(name))


before = kilobytes("VmRSS:")
after = solver.{call}(start, 1e4)
print(1024 * (kilobytes("VmHWM:") - before) / (8 * bins**2))
"""


@pytest.mark.parametrize(("call", "states"), [("solve", 1.2), ("grading_after", 0.2)])
def test_a_solve_holds_little_beside_its_states(call: str, states: float) -> None:
    """Its new state, where it makes one, and a fifth of a state; a process of its own, since a peak does not fall."""
    done = subprocess.run([sys.executable, "-c", SCRIPT.format(call=call)], capture_output=True, text=True, check=True)
    assert float(done.stdout) <= states

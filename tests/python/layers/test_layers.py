"""The order of the rooms: no module imports what stands above it, and none stands in a circle."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def test_the_contracts_of_the_rooms_are_kept() -> None:
    pytest.importorskip("importlinter")
    command = [sys.executable, "-c", "import sys; from importlinter.cli import lint_imports_command as run; run()"]
    sources = os.environ | {"PYTHONPATH": str(ROOT / "python")}
    done = subprocess.run(
        [*command, "--no-cache", "--no-logo"], cwd=ROOT, env=sources, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_importing_the_package_needs_numpy_alone() -> None:
    script = (
        "import sys\n"
        "for name in ('matplotlib', 'xarray', 'h5netcdf', 'h5py', 'openpyxl', 'pydantic', 'typer', 'tqdm'):\n"
        "    sys.modules[name] = None\n"
        "import comminute as cm\n"
        "print(cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1).engine)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "quasi-static"

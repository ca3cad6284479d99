"""The example that finds out which parameter matters."""

import subprocess
import sys
from pathlib import Path

import pytest

import comminute as cm

pytest.importorskip("SALib")
pytest.importorskip("matplotlib")
pytest.importorskip("pydantic")
pytest.importorskip("zarr")
pytest.importorskip("xarray")

SCRIPT = Path(__file__).parents[3] / "examples" / "sensitivity" / "sobol.py"


def test_the_fabric_width_matters_most_under_a_high_stress(tmp_path: Path) -> None:
    ran = subprocess.run([sys.executable, SCRIPT, tmp_path, "64"], capture_output=True, text=True, check=True)
    line = next(line for line in ran.stdout.splitlines() if line.startswith("D50 at 80 MPa"))
    shares = [float(part.split()[-1]) for part in line.split(":")[1].split(",")]
    assert max(shares) == shares[0] > 0.8
    assert (tmp_path / "sensitivity.png").stat().st_size > 10_000
    assert len(cm.Sweep(tmp_path / "sensitivity.zarr")) == 64 * 6

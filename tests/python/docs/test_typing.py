"""The types that users see: a script of theirs under mypy --strict, and the stubs against the module."""

import subprocess
import sys
from pathlib import Path

SCRIPT = """
import numpy as np
import numpy.typing as npt
import comminute as cm

material: cm.Material = cm.Material(weibull_modulus=4.0, fragments=cm.PowerLawFragments(1.0))
sand: cm.Grading = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 50, 0], unit="mm")
result: cm.Result = cm.Simulation(material, sand, scheme="paper").run(stress_ratio=[1, 2.5], engine="auto")
sizes: npt.NDArray[np.float64] = result.percentile(50)
state: npt.NDArray[np.float64] = result.fabric(-1).probability.copy()
engine = cm.FullConvolution(result.grid, material, "blend", loading_rate=0.5)
engine.step(state, 3.0, out=state)
steps: int = engine.report.steps
finer: float = sand.finer(1.0)
"""


def mypy(*arguments: str, module: str = "mypy") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", module, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def check(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Mypy on a script in a folder of its own, with no configuration but --strict."""
    script = folder / "script.py"
    script.write_text(text)
    return mypy("--strict", f"--cache-dir={folder / 'cache'}", "--config-file=", str(script))


def test_a_user_script_passes_mypy_strict(tmp_path: Path) -> None:
    done = check(SCRIPT, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_wrong_word_is_caught_by_mypy(tmp_path: Path) -> None:
    done = check(SCRIPT.replace('"blend"', '"medium"'), tmp_path)
    assert done.returncode == 1
    assert 'Argument 3 to "FullConvolution"' in done.stdout


def test_the_stubs_describe_the_module(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    # Attributes that pybind11 adds to every class (its metaclass among it), and names the stubs use among themselves.
    allowed.write_text(r"comminute\._core\.((.*\.)?(_pybind11_conduit_v1_|__.*__|_[A-Za-z]+)|[A-Z]\w+)" + "\n")
    done = mypy("comminute._core", "--allowlist", str(allowed), "--ignore-unused-allowlist", module="mypy.stubtest")
    assert done.returncode == 0, done.stdout + done.stderr

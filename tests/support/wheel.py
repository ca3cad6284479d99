"""Hold an installed wheel to what it promises: answers, no FFTW, no more of a wait than NumPy alone."""

import subprocess
import sys

import comminute as cm

LONGEST_IMPORT = 0.05  # seconds beyond NumPy's own


def seconds(statement: str) -> float:
    """Time a statement in the quickest of five new interpreters."""
    timed = f"import time; begin = time.perf_counter(); {statement}; print(time.perf_counter() - begin)"
    call = [sys.executable, "-c", timed]
    return min(float(subprocess.run(call, capture_output=True, text=True, check=True).stdout) for _ in range(5))


def main() -> None:
    """Solve, step without FFTW, and import."""
    material = cm.Material(fragments=cm.LogNormalFragments())
    start, grid = cm.power_law(2.5, 0.01, 1.0), cm.LogGrid(-8.0, 0.0, 128)
    result = cm.Simulation(material, start, grid=grid).run(stress_ratio=[2.0, 30.0])
    assert 0.0 < result.crushes[0] < result.crushes[1]
    if not cm.has_fftw:
        assert cm.FullConvolution(grid, material, "exact").path_taken == "direct"
    waits = seconds("import comminute") - seconds("import numpy")
    print(f"comminute {cm.__version__}: import {waits:.3f} s beyond NumPy, FFTW {cm.has_fftw}")
    assert waits <= LONGEST_IMPORT


if __name__ == "__main__":
    main()

"""The finite elements of examples/scikit_fem, with response tables at their quadrature points."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import comminute as cm
import footing

EXAMPLE = Path(footing.__file__)


def test_a_load_on_the_whole_surface_is_an_oedometer() -> None:
    # Strain is uniform, so that one scalar equation decides it; breakage comes from solves, not from the table.
    table = footing.sand()
    block = footing.Footing(table, cells=3, strip=footing.WIDTH)
    material = cm.Material(reference_size=2.0, fabric_width=0.2, first_crush_stress=1.0, stress_measure="mean")
    start = cm.power_law(2.3, 0.1, 2.0)
    solver = cm.Simulation(material, start, grid=table.grid)

    def excess(strain: float, vertical: float) -> float:
        mean = vertical - 4.0 / 3.0 * footing.SHEAR * strain
        breakage = cm.breakage_index(start, solver.run(stress_ratio=[mean]).curve()).index
        return mean - footing.BULK * (strain - footing.COMPACTION * breakage)

    for vertical in (0.5, 10.0, 40.0):
        block.step(vertical)
        strain = brentq(excess, 0.0, 0.7 * vertical / footing.SHEAR, args=(vertical,), xtol=1e-12)
        assert block.settlement() == pytest.approx(footing.HEIGHT * strain, rel=2e-4)  # tolerance of the table
    loaded = block.settlement()
    block.step(0.0)
    oedometric = footing.BULK + 4.0 / 3.0 * footing.SHEAR
    assert loaded - block.settlement() == pytest.approx(footing.HEIGHT * 40.0 / oedometric, rel=1e-9)


def test_newton_with_the_tables_derivative_converges_quadratically() -> None:
    block = footing.Footing(footing.sand(), cells=6)
    for pressure in (10.0, 20.0, 30.0):
        *_, before, last = block.step(pressure)
        assert last < 1e-9
        # the square of the step before, down to rounding; a wrong derivative leaves a linear rate, from about 1e-8
        assert last < max(10.0 * before**2, 1e-11)


def test_the_example_leaves_its_picture(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, EXAMPLE, tmp_path], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("4800 quadrature points, 28 steps")
    assert (tmp_path / "footing.png").stat().st_size > 20_000
    pressure, settlement = np.loadtxt(tmp_path / "footing.csv", delimiter=",", skiprows=1).T
    first, again = (settlement[pressure == 30.0][k] for k in (0, 1))
    assert again == pytest.approx(first, rel=1e-9)  # reloading up to the largest load crushes nothing
    assert settlement[np.flatnonzero(pressure == 0.0)[1]] > 0.3 * first

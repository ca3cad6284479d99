"""Write the golden files anew: what version 0.1.0 wrote, and every later version must open and reproduce.

The files are replaced only where a later version corrects a number, with the reason in the commit.
"""

import math
import shutil
import tempfile
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

import comminute as cm
from comminute.cli.app import app

HERE = Path(__file__).parent

STEP = math.log(10.0) / 64.0  # sizes 1 and 0.1 are centres of bins
GRID = cm.LogGrid(-279 * STEP, 0.0, 280)
LOADS = [1.0, 2.0, 8.0, 100.0, 10_000.0]
MATERIAL = cm.Material(weibull_modulus=3.0, fabric_width=0.05, reference_size=1.0)
FIGURES = {
    "figure_7": cm.monodisperse(1.0),
    "figure_8": cm.gap_graded(coarse=1.0, fine=0.1, coarse_share=0.5),
    "figure_9": cm.power_law(fractal_dimension=2.5, smallest=1e-3, largest=1.0),
}


def figure(name: str) -> cm.Result:
    """Run one of the paper's Figures 7 to 9 as the continuum model, on an explicit grid."""
    return cm.Simulation(MATERIAL, FIGURES[name], grid=GRID).run(stress_ratio=LOADS, keep_fabrics="last")


def lattice() -> cm.LatticeResult:
    """Run a small lattice with scatter between its replicas."""
    rings = cm.Lattice(2000, MATERIAL, FIGURES["figure_8"], seed=3, replicas=4)
    return rings.run(stress_ratio=[1.0, 8.0], grid=cm.LogGrid(-4.0, 0.0, 41))


def case(folder: Path) -> cm.Result:
    """Run the case and its sieve table in a folder of their own."""
    for name in ("sand.toml", "sand.csv"):
        shutil.copy(HERE / name, folder)
    done = CliRunner().invoke(app, ["run", str(folder / "sand.toml")])
    assert done.exit_code == 0, done.output
    return cm.open_result(folder / "sand.nc")


def main() -> None:
    """Write the curves; results (.nc) stay as version 0.1.0 wrote them."""
    for name in FIGURES:
        table = np.column_stack([GRID.edge_sizes[1:], figure(name).cdf.T])
        header = "edge_size," + ",".join(f"finer at stress ratio {load:g}" for load in LOADS)
        np.savetxt(HERE / f"{name}.csv", table, delimiter=",", header=header, fmt="%.17g")
    with tempfile.TemporaryDirectory() as folder:
        result = case(Path(folder))
    assert result.stress is not None
    table = np.column_stack([result.edge_size, result.cdf.T])
    header = "edge_size," + ",".join(f"finer at {load:g} MPa" for load in result.stress)
    np.savetxt(HERE / "sand_curves.csv", table, delimiter=",", header=header, fmt="%.17g")


if __name__ == "__main__":
    main()

"""Laws that a column of material points must follow: mpm_column_holds.py OUT, with the files of its host."""

import csv
import sys
from pathlib import Path

import meshio
import numpy as np


def main(out: Path) -> None:
    """Read the host's files as its user would, and hold them against statics and against the laws of crushing."""
    with (out / "history.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    history = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    cycles = int(history["cycle"][-1])
    meshes = [meshio.read(out / f"column-{cycle}.vtu") for cycle in range(1, cycles + 1)]
    assert all(len(mesh.points) == 10_000 for mesh in meshes)

    # The floor bears what the surface carries, but for waves, which leave sums over whole cycles alone.
    applied, reaction = history["applied_MN_m"], history["reaction_MN_m"]
    assert abs(reaction.sum() / applied.sum() - 1.0) < 0.02, reaction.sum() / applied.sum()
    assert abs(reaction.max() / applied.max() - 1.0) < 0.05, reaction.max() / applied.max()

    # Points on the table: one load, one grading; more load, finer grains; none below the first crush.
    for mesh in meshes:
        fields = mesh.point_data
        load, d50, layer = (fields[name] for name in ("largest_stress_ratio", "D50_undisturbed_mm", "in_layer"))
        order = np.argsort(load)
        assert np.all(np.diff(d50[order]) <= 0.0)
        assert np.ptp(d50[load < 0.9]) == 0.0
        assert d50.min() < 0.8 * d50.max()
        off = layer == 0.0
        assert np.all(fields["D50_mm"][off] == d50[off])
        assert 500 < layer.sum() < 1000

    # The layer crushes in each cycle, and points that are never rearranged in the first alone.
    last = [np.flatnonzero(history["cycle"] == cycle)[-1] for cycle in range(1, cycles + 1)]
    layer, undisturbed = history["layer_D50_mm"][last], history["undisturbed_D50_mm"][last]
    assert abs(layer[0] / undisturbed[0] - 1.0) < 1e-3  # a table's tolerance
    assert np.all(np.diff(layer) < -0.02), layer
    assert np.all(np.abs(np.diff(undisturbed)) < 1e-3), undisturbed
    assert np.all(np.diff(history["layer_crushed"]) >= 0.0)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

"""Figure of a column under a strip load from what the host wrote: draw_mpm_column.py OUT leaves OUT/mpm_column.png."""

import csv
import sys
from pathlib import Path

import matplotlib
import meshio

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def columns(path: Path) -> dict[str, list[float]]:
    """Columns of a table by their headings."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def main(out: Path) -> None:
    """Grains of the column at the end on the left, those of the layer in time on the right."""
    history = columns(out / "history.csv")
    last = meshio.read(out / f"column-{int(history['cycle'][-1])}.vtu")
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
    x, y, _ = last.points.T
    shown = left.scatter(x, y, c=last.point_data["D50_mm"], s=3.0, marker="s", linewidths=0.0, cmap="viridis")
    figure.colorbar(shown, ax=left, label="D50 [mm]")
    left.set(xlabel="from the plane of symmetry [m]", ylabel="height [m]", aspect="equal")
    milliseconds = [1000.0 * time for time in history["time_s"]]
    right.plot(milliseconds, history["undisturbed_D50_mm"], color="0.5", label="never rearranged")
    right.plot(milliseconds, history["layer_D50_mm"], color="C0", label="rearranged between cycles")
    right.set(xlabel="time [ms]", ylabel="mean D50 of the layer [mm]")
    right.legend(fontsize=8, frameon=False, loc="upper right")
    other = right.twinx()
    other.fill_between(milliseconds, history["pressure_MPa"], color="C3", alpha=0.15, linewidth=0.0)
    other.set_ylabel("pressure on the strip [MPa]", color="C3")
    figure.savefig(out / "mpm_column.png", dpi=200)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

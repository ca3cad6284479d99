"""Figure of a test in an oedometer from what the host wrote: draw_oedometer.py OUT leaves OUT/oedometer.png."""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def columns(path: Path) -> dict[str, list[float]]:
    """Columns of a table by their headings."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def main(out: Path) -> None:
    """Gradings on the left, indices against the stress on the right."""
    gradings, indices = columns(out / "gradings.csv"), columns(out / "indices.csv")
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.0), layout="constrained")
    stresses = sorted({*indices["vertical_MPa"][:6], max(indices["vertical_MPa"])})
    for k, stress in enumerate(stresses):
        rows = zip(*gradings.values(), strict=True)
        curve = [(size, finer) for at, size, finer in rows if at == stress]
        bins = len(curve) // indices["vertical_MPa"].count(stress)
        sizes, finer = zip(*curve[:bins], strict=True)
        left.semilogx(
            sizes, finer, color=plt.get_cmap("viridis")(0.9 * k / len(stresses)), label=f"{stress:g}", linewidth=1.0
        )
    left.set(xlabel="grain size [mm]", ylabel="mass finer [%]", xlim=(1e-2, 2.5), ylim=(0, 102))
    left.legend(title="vertical stress [MPa]", fontsize=7, title_fontsize=7, frameon=False)
    right.semilogx(indices["vertical_MPa"], indices["breakage"], "o-", color="C3", markersize=3)
    right.set(xlabel="vertical stress [MPa]", ylabel="breakage index")
    right.yaxis.label.set_color("C3")
    other = right.twinx()
    other.semilogx(indices["vertical_MPa"], indices["D50_mm"], "s--", color="C0", markersize=3)
    other.set_ylabel("D50 [mm]", color="C0")
    figure.savefig(out / "oedometer.png", dpi=200)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

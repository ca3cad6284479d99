"""Draw one shell of a sweep, its arms and the lines along which their mass falls: shells_and_arms.py [PNG]."""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

BINS = 14
SHELL = 10
TIP = 2.6  # bin at which the zone begins
STEEPNESS = 2.0  # k / h, far above that of sand so that the taper shows

GREY, BLUE, RED, GREEN = "0.88", "#3b6ea5", "#b5483a", "#4c8c4a"


def half_width(m: float) -> float:
    """Half-width W of the zone in bins where the larger grain lies in bin m; -1 below the tip."""
    return float(np.sqrt(STEEPNESS * (m - TIP))) if m >= TIP else -1.0


def cell(ax: Axes, i: int, j: int, colour: str, alpha: float = 1.0) -> None:
    """Fill cell (i, j), row i upwards and column j to the right."""
    ax.add_patch(Rectangle((j - 0.5, i - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="none", alpha=alpha))


def arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    """Draw an arrow between two points given as (column, row)."""
    ax.annotate(
        "", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
    )


def draw(ax: Axes) -> None:
    """Draw grid, zone, one shell and the ways of its mass."""
    for i in range(BINS):
        for j in range(BINS):
            if abs(i - j) <= half_width(max(i, j)):
                cell(ax, i, j, GREY)
    reach = int(half_width(SHELL))
    for d in range(1, reach + 1):
        cell(ax, SHELL, SHELL - d, BLUE, 0.75)
        cell(ax, SHELL - d, SHELL, RED, 0.75)
    cell(ax, SHELL, SHELL, GREEN, 0.85)
    for edge in np.arange(-0.5, BINS):
        ax.axhline(edge, color="white", lw=0.8)
        ax.axvline(edge, color="white", lw=0.8)

    larger = np.linspace(TIP, BINS - 0.5, 200)
    width = np.array([half_width(m) for m in larger])
    ax.plot(larger - width, larger, color="0.35", lw=1.0)
    ax.plot(larger, larger - width, color="0.35", lw=1.0)
    ax.plot([SHELL + 0.5, SHELL + 0.5, -0.5], [-0.5, SHELL + 0.5, SHELL + 0.5], color="0.35", lw=1.0, ls=":")

    for d in range(1, reach + 1):
        arrow(ax, (SHELL - d, SHELL - 0.3), (SHELL - d, SHELL - 4.7 - 0.3 * d), BLUE)
        arrow(ax, (SHELL - 0.3, SHELL - d), (SHELL - 4.7 - 0.3 * d, SHELL - d), RED)
    arrow(ax, (SHELL, SHELL - 0.3), (SHELL, 0.0), GREEN)
    arrow(ax, (SHELL - 0.3, SHELL), (0.0, SHELL), GREEN)

    ax.text(SHELL + 0.7, SHELL - 0.1, "diagonal cell $(m, m)$:\nhalf along either line", fontsize=8, va="center")
    ax.text(0.0, SHELL + 0.75, "arm in row $m$: crushes in $\\psi$, falls down its columns", fontsize=8, color=BLUE)
    ax.text(
        SHELL + 0.7, 3.2, "arm in\ncolumn $m$:\ncrushes in\n$\\bar\\psi$, falls\nalong its\nrows", fontsize=8, color=RED
    )
    ax.text(11.1, 12.55, "zone", fontsize=8, color="0.25")
    ax.annotate(
        "tip",
        (TIP, TIP),
        (TIP + 0.9, TIP - 1.25),
        fontsize=8,
        color="0.25",
        arrowprops={"arrowstyle": "-", "color": "0.5"},
    )
    ax.text(0.35, 0.85, "fines:\nrow 0,\ncolumn 0", fontsize=7, color="0.35", va="bottom")
    for k in range(BINS):
        ax.add_patch(Rectangle((k - 0.5, -0.5), 1.0, 1.0, facecolor="none", edgecolor="0.6", lw=0.6))
        ax.add_patch(Rectangle((-0.5, k - 0.5), 1.0, 1.0, facecolor="none", edgecolor="0.6", lw=0.6))
    ax.set(xlim=(-0.6, BINS + 2.2), ylim=(-0.6, BINS - 0.4), aspect="equal")
    ax.set_xticks([0, SHELL], ["0", "$m$"])
    ax.set_yticks([0, SHELL], ["0", "$m$"])
    ax.set_xlabel("bin $j$ of the neighbourhood, $\\bar\\psi$")
    ax.set_ylabel("bin $i$ of the grain, $\\psi$")
    ax.spines[:].set_visible(False)


def main() -> None:
    """Write the picture."""
    default = Path(__file__).parents[1] / "images" / "theory" / "shells_and_arms.png"
    to = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    figure, ax = plt.subplots(figsize=(6.2, 5.4), layout="constrained")
    draw(ax)
    figure.savefig(to, dpi=130)


if __name__ == "__main__":
    main()

"""Cost against N, drawn."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullLocator

from harness import Outcome
from report import curves, growth, power_of_two


def plot(directory: Path, outcomes: list[Outcome]) -> list[Path]:
    """Draw cost against N, one picture a case, in logs, with fitted exponents in the legend."""
    exponents = {(row["case"], row["contestant"]): row["exponent"] for row in growth(outcomes)}
    drawn = []
    for case, by_name in curves(outcomes).items():
        figure, ax = plt.subplots(figsize=(7.0, 4.5), layout="constrained")
        for name, (sizes, times) in by_name.items():
            slope = exponents.get((case, name))
            label = name if slope is None else f"{name}: N^{slope:.2f}"
            medians = [t.median for t in times]
            spread = [[t.median - t.lower for t in times], [t.upper - t.median for t in times]]
            ax.errorbar(sizes, medians, yerr=spread, marker="o", markersize=3.5, linewidth=1.0, label=label)
        ax.set(xscale="log", yscale="log", xlabel="N", ylabel="seconds", title=case)
        ticks = sorted({n for sizes, _ in by_name.values() for n in sizes if not power_of_two(n)})
        ax.set_xticks(ticks, [str(n) for n in ticks])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.grid(visible=True, which="both", alpha=0.2)
        ax.legend(fontsize=8)
        path = directory / (case.replace(",", "").replace(" ", "-") + ".png")
        figure.savefig(path, dpi=150)
        plt.close(figure)
        drawn.append(path)
    return drawn

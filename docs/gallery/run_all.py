"""Draws every figure at one and two columns' width, without a display: python docs/gallery/run_all.py [OUT]."""

import os
import runpy
import sys
from pathlib import Path

os.environ["MPLBACKEND"] = "Agg"

import matplotlib.pyplot as plt

WIDTHS = (85, 170)  # mm


def main(out: Path) -> None:
    """Run the scripts beside this one and save their figures as PNG and PDF."""
    out.mkdir(parents=True, exist_ok=True)
    for script in sorted(Path(__file__).parent.glob("plot_*.py")):
        draw = runpy.run_path(str(script))["draw"]
        for width in WIDTHS:
            figure = draw(width)
            for ending in ("png", "pdf"):
                figure.savefig(out / f"{script.stem[5:]}-{width}mm.{ending}")
        plt.close("all")
        print(f"{script.stem[5:]}: {', '.join(f'{width} mm' for width in WIDTHS)}", flush=True)
    print(f"Pictures are in {out}/.")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/figures"))

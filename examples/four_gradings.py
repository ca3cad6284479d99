"""The main job: four gradings crushed up to a stress ratio of 10 000.

Prints a table for each and leaves its numbers (.npz) and a picture (.png) in the output folder:

    python examples/four_gradings.py [OUT]
"""

import sys
from pathlib import Path

import numpy as np
from tqdm.auto import tqdm

import comminute as cm

LOADS = [1, 2, 8, 32, 100, 1000, 10_000]

# CEN standard sand, EN 196-1: per cent retained on 1.60 mm and so on, given here as per cent finer.
CEN_SAND = cm.Grading.from_sieves(
    size=[2.00, 1.60, 1.00, 0.50, 0.16, 0.08], percent_finer=[100, 93, 67, 33, 13, 1], unit="mm"
)

CASES = {
    "monodisperse": (cm.Material(), cm.monodisperse(1.0)),
    "gap-graded": (cm.Material(), cm.gap_graded(coarse=1.0, fine=0.1, coarse_share=0.5)),
    "power-law": (cm.Material(), cm.power_law(fractal_dimension=2.5, smallest=1e-3, largest=1.0)),
    "cen-sand": (cm.Material(reference_size=2.0), CEN_SAND),
}


def print_table(name: str, result: cm.Result) -> None:
    """One line per load: sizes at 10, 50 and 60 per cent finer, fines, crushes and mass balance."""
    unit = f" in {result.unit}" if result.unit else ""
    print(f"\n{name}: {result.grid.bins} bins, engine {result.engine}, sizes{unit}")
    print("     load       D10       D50       D60     fines   crushes  mass error")
    sizes = [result.percentile(percent) for percent in (10, 50, 60)]
    for load, *row in zip(result.stress_ratio, *sizes, result.fines, result.crushes, result.mass_error, strict=True):
        d10, d50, d60, fines, crushes, error = row
        print(f"{load:9g} {d10:9.4g} {d50:9.4g} {d60:9.4g} {fines:9.2e} {crushes:9.4f} {error:11.1e}")
    for line in (*result.notes, *result.warnings):
        print(f"  ({line})")


def main(out: Path) -> None:
    """Run the four cases and write their files."""
    out.mkdir(parents=True, exist_ok=True)
    results = {}
    with tqdm(total=len(CASES) * len(LOADS), unit="load", disable=not sys.stderr.isatty()) as bar:
        for name, (material, grading) in CASES.items():
            bar.set_description(name)
            simulation = cm.Simulation(material, grading)
            results[name] = simulation.run(stress_ratio=LOADS, on_load=lambda _: bar.update())
    for name, result in results.items():
        print_table(name, result)
        result.save(out / f"{name}.npz")
        result.plot().savefig(out / f"{name}.png", dpi=150)
    worst = max(np.abs(result.mass_error).max() for result in results.values())
    print(f"\nNumbers and pictures are in {out}/; largest mass error {worst:.1e}.")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))

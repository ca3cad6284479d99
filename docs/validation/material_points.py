"""Memory of material points, and the error that their number of bins leaves in D50.

Run it with `python docs/validation/material_points.py`; it writes the page beside it.
"""

from __future__ import annotations

from pathlib import Path

import comminute as cm

PAGE = Path(__file__).with_suffix(".md")
BINS = (58, 108, 207, 502)
FINE = 2001
LOADS = (10.0, 100.0, 1000.0)
MATERIAL = cm.Material(reference_size=2.0)
SPREAD = {
    "a sieved sand": cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100, 70, 20, 0], unit="mm"),
    "a power law": cm.power_law(2.5, 0.01, 2.0),
    "a lognormal": cm.lognormal(0.6, 0.4, largest=2.0),
}
EXACT = {"equal grains": cm.monodisperse(2.0), "two sizes": cm.gap_graded(2.0, 0.2)}


def d50(start: cm.Grading, load: float, bins: int) -> float:
    """D50 of one material point under a load."""
    points = cm.MaterialPoints(MATERIAL, start, 1, cm.fitting_grid(start, MATERIAL, load, bins=bins))
    points.update(load)
    return points.curve(0).percentile(50)


def true_d50(start: cm.Grading, load: float) -> float:
    """D50 on a fine grid, with exact sizes kept exact."""
    grid = cm.fitting_grid(start, MATERIAL, load, bins=FINE)
    return cm.Simulation(MATERIAL, start, grid=grid).run(stress_ratio=[load], keep_fabrics=()).curve(0).percentile(50)


def worst(starts: dict[str, cm.Grading], bins: int) -> float:
    """Largest relative error over starts and loads."""
    pairs = [(start, load) for start in starts.values() for load in LOADS]
    return max(abs(d50(start, load, bins) / true_d50(start, load) - 1.0) for start, load in pairs)


def kilobytes(bins: int, **options: str) -> float:
    """Memory of one more point that has crushed."""
    start = SPREAD["a power law"]
    grid = cm.fitting_grid(start, MATERIAL, LOADS[0], bins=bins)
    shared = cm.MaterialPoints(MATERIAL, start, 1, grid, **options)  # type: ignore[arg-type]
    crushed = shared.copy()
    crushed.update(LOADS[0])
    return (crushed.nbytes - shared.nbytes) / 1000.0


def page() -> str:
    """Render the page."""
    loads = ", ".join(f"{load:g}" for load in LOADS)
    lines = [
        "# Memory and accuracy of material points",
        "",
        "Written by `docs/validation/material_points.py`. Memory is that of a point that has crushed, beside the start",
        f"that all share. The error of D50 is the largest at stress ratios {loads}, against {FINE} bins with exact",
        f"sizes kept exact; on the left of the starts that have none ({', '.join(SPREAD)}), on the right of those",
        f"whose exact sizes the points put into bins ({', '.join(EXACT)}).",
        "",
        "| bins | states, float64 | states, float32 | gradings, float64 | gradings, float32"
        " | error of D50 |"
        " exact sizes binned |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for bins in BINS:
        kinds = [(keep, dtype) for keep in ("states", "gradings") for dtype in ("float64", "float32")]
        memory = [kilobytes(bins, keep=keep, dtype=dtype) for keep, dtype in kinds]
        sizes = " | ".join(f"{size:.0f} KB" if size >= 100 else f"{size:.3g} KB" for size in memory)
        lines.append(f"| {bins} | {sizes} | {worst(SPREAD, bins):.2%} | {worst(EXACT, bins):.1%} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

"""How far the continuum model is from the lattice, and how far either is from its own limit.

Writes the report beside this file and the picture of the page "How good is the continuum model?":

    python docs/validation/continuum_against_lattice.py
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Literal

os.environ.setdefault("MPLBACKEND", "Agg")

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size, plot_distances

Floats = npt.NDArray[np.float64]

HERE = Path(__file__).parent
MATERIAL = cm.Material(weibull_modulus=3.0, fabric_width=0.05, reference_size=1.0)
STARTS = {
    "equal sizes": cm.monodisperse(1.0),
    "uniform in 0.9 to 1": cm.uniform_size(0.9, 1.0),
    "gap-graded 1 : 0.1": cm.gap_graded(coarse=1.0, fine=0.1, coarse_share=0.5),
    "power law 2.5, 0.001 to 1": cm.power_law(fractal_dimension=2.5, smallest=1e-3, largest=1.0),
}
NARROW = "uniform in 0.9 to 1"
LOADS = [1.5, 2.0, 4.0, 8.0, 32.0, 100.0, 1e3, 1e4]
CELLS, REPLICAS, SEED = 4_000_000, 4, 1
SPACINGS = (0.02, 0.01, 0.005, 0.0025)
SPACING = 0.01  # of the main table


def grid_of(spacing: float) -> cm.LogGrid:
    """Bins on [-14, 0]."""
    return cm.LogGrid(-14.0, 0.0, round(14.0 / spacing) + 1)


def row(name: str, numbers: Floats | list[float], form: str = ".4f") -> str:
    """One line of a table."""
    return f"| {name} | " + " | ".join(format(number, form) for number in numbers) + " |"


def head(name: str, columns: list[str]) -> list[str]:
    """Two lines that open a table."""
    return [f"| {name} | " + " | ".join(columns) + " |", "|---|" + "---:|" * len(columns)]


class Case:
    """Lattice curves of one start on every grid, and the continuum's."""

    def __init__(self, name: str) -> None:
        self.start = STARTS[name]
        lattice = cm.Lattice(CELLS, MATERIAL, self.start, seed=SEED, replicas=REPLICAS)
        main = grid_of(SPACING)
        self.lattice_cdf: dict[float, list[Floats]] = {spacing: [] for spacing in SPACINGS}
        self.lattice_crushes = []
        self.result = self.run(SPACING)
        runs = []
        for load in LOADS:  # one load at a time, so that the state can be put on all the grids
            runs.append(lattice.run(stress_ratio=load, grid=main, keep_fabrics=[]))
            self.lattice_crushes.append(float(runs[-1].crushes[0]))
            for spacing in SPACINGS:
                self.lattice_cdf[spacing].append(lattice.cdf(grid_of(spacing)))
        self.cdf_error = np.array([run.cdf_error[0] for run in runs])
        difference = self.result.cdf - np.array(self.lattice_cdf[SPACING])
        worst = np.argmax(np.abs(difference), axis=1)
        each = np.arange(len(LOADS))
        self.sign = np.sign(difference[each, worst])
        self.found = cm.Comparison.of(
            np.array(LOADS),
            main.edge_sizes[1:],
            (self.result.cdf, np.array(self.lattice_cdf[SPACING])),
            (np.zeros_like(self.cdf_error), self.cdf_error),
            (1, REPLICAS),
        )

    def run(self, spacing: float, scheme: Literal["conservative", "paper"] = "conservative") -> cm.Result:
        """Continuum on one grid."""
        simulation = cm.Simulation(MATERIAL, self.start, grid=grid_of(spacing), scheme=scheme)
        return simulation.run(stress_ratio=LOADS, keep_fabrics=[])

    def distances(self, spacing: float, scheme: Literal["conservative", "paper"]) -> Floats:
        """Largest CDF difference after each load, at the bin edges of one grid."""
        found: Floats = np.abs(self.run(spacing, scheme).cdf - np.array(self.lattice_cdf[spacing])).max(axis=1)
        return found


def report_distances(cases: dict[str, Case]) -> list[str]:
    """Write the main table."""
    columns = [f"{load:g}" for load in LOADS]
    bins = grid_of(SPACING).bins
    lines = [
        "## Distance of the continuum to the lattice",
        "",
        f"Continuum: quasi-static solver, conservative scheme, {bins} bins on [-14, 0] (bin width {SPACING:g}), single",
        "sizes as exact point masses. Lattice: event driven, random ties,",
        f"{REPLICAS} rings of {CELLS:,} cells, seed {SEED}.",
        "Largest difference of the two CDFs at bin edges, and in brackets the standard error (1e-4) of the lattice's",
        "curve where the difference is largest. A minus: there the continuum has less fine mass than the lattice.",
        "",
        *head("start", columns),
    ]
    for name, case in cases.items():
        entries = [
            f"{'-' if sign < 0 else ''}{distance:.4f} ({1e4 * error:.1f})"
            for sign, distance, error in zip(case.sign, case.found.distance, case.found.standard_error, strict=True)
        ]
        lines.append(f"| {name} | " + " | ".join(entries) + " |")
    lines += ["", "Size at which the curves are farthest apart:", "", *head("start", columns)]
    lines += [row(name, case.found.size, ".3g") for name, case in cases.items()]
    lines += ["", "Mean number of crushes of a cell, continuum / lattice:", "", *head("start", columns)]
    for name, case in cases.items():
        pairs = zip(case.result.crushes, case.lattice_crushes, strict=True)
        lines.append(f"| {name} | " + " | ".join(f"{ours:.4f} / {theirs:.4f}" for ours, theirs in pairs) + " |")
    lines += [
        "",
        "How much has happened at all: largest change of the CDF since the start, continuum / lattice:",
        "",
        *head("start", columns),
    ]
    for name, case in cases.items():
        before = case.result.start.cdf()
        ours = np.abs(case.result.cdf - before).max(axis=1)
        theirs = np.abs(np.array(case.lattice_cdf[SPACING]) - before).max(axis=1)
        lines.append(
            f"| {name} | " + " | ".join(f"{a:.4f} / {b:.4f}" for a, b in zip(ours, theirs, strict=True)) + " |"
        )
    narrow = cases[NARROW]
    below = grid_of(SPACING).edge_sizes[1:] < 0.9
    gap = np.abs(narrow.result.cdf - np.array(narrow.lattice_cdf[SPACING]))[:, below].max(axis=1)
    lines += ["", "Largest difference below the narrow band alone, at sizes under 0.9:", "", *head("start", columns)]
    lines += [row(NARROW, gap), "", "Mean size of the mass within the narrow band (0.950 at the start):", ""]
    lines += head("", columns)
    for whose, curves in (("continuum", narrow.result.cdf), ("lattice", np.array(narrow.lattice_cdf[SPACING]))):
        mass = np.diff(curves, prepend=0.0)[:, ~below]
        lines.append(row(whose, mass @ grid_of(SPACING).sizes[~below] / mass.sum(axis=1), ".3f"))
    return lines


def report_refinement(cases: dict[str, Case]) -> list[str]:
    """Write how far the numbers of the main table depend on the grid."""
    lines = ["## The same distances on other grids", "", *head("start, scheme, bin width", [f"{x:g}" for x in LOADS])]
    for name, case in cases.items():
        for scheme in ("conservative", "paper"):
            if scheme == "conservative" or name == NARROW:
                for spacing in SPACINGS:
                    lines.append(row(f"{name}, {scheme}, {spacing:g}", case.distances(spacing, scheme)))
    return lines


def slope(x: list[float], y: list[float]) -> float:
    """Exponent of a power law through the points."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def report_finite_rings(cases: dict[str, Case]) -> list[str]:
    """Write how the curve of one ring nears that of a large one: as M^-1/2."""
    sizes = [1_000, 10_000, 100_000, 1_000_000]
    grid, load = grid_of(SPACING), 100.0
    lines = [
        "## Finite rings",
        "",
        f"CDF distance of a single ring of M cells to the mean of the rings above at a load of {load:g},",
        "mean over 10 to 400 rings. Expected: M to the power -1/2.",
        "",
        *head("start", [f"M = {m:,}" for m in sizes] + ["exponent"]),
    ]
    for name, case in cases.items():
        limit = case.lattice_cdf[SPACING][LOADS.index(load)]
        means = []
        for cells in sizes:
            rings = max(10, min(400, 4_000_000 // cells))
            lattice = cm.Lattice(cells, MATERIAL, case.start, seed=SEED + 1, replicas=rings)
            lattice.load_to(load)
            curves = np.cumsum(lattice.grainsizes(grid), axis=1)
            means.append(float(np.abs(curves - limit).max(axis=1).mean()))
        lines.append(row(name, [*means, slope([float(m) for m in sizes], means)]))
    return lines


def report_time_steps(cases: dict[str, Case]) -> list[str]:
    """Write how the time-stepped lattice nears the event-driven one, and where it is another model."""
    coarsenesses = [0.32, 0.16, 0.08, 0.04, 0.02]
    cells, rings, load = 500_000, 4, 8.0
    grid = grid_of(SPACING)
    noise = math.sqrt(1.0 / (cells * rings) + 1.0 / (CELLS * REPLICAS))

    def distance(case: Case, probability: float, factor: float) -> float:
        stepped = cm.TimeSteppedLattice(
            cells,
            MATERIAL,
            case.start,
            seed=SEED + 2,
            replicas=rings,
            crush_probability=probability,
            load_factor=factor,
        )
        stepped.load_to(load)
        return float(np.abs(stepped.cdf(grid) - case.lattice_cdf[SPACING][LOADS.index(load)]).max())

    lines = [
        "## Time steps",
        "",
        f"CDF distance of the time-stepped to the event-driven lattice at a load of {load:g}: crush probability ε in",
        f"a pass and load factor 1 + ε, {rings} rings of {cells:,} cells, seed {SEED + 2}. "
        "The noise of the two curves is",
        f"about {noise:.1e}. The exponent of ε is fitted where the distance exceeds four times that.",
        "",
        *head("start", [f"ε = {epsilon:g}" for epsilon in coarsenesses] + ["exponent"]),
    ]
    for name, case in cases.items():
        found = [distance(case, epsilon, 1.0 + epsilon) for epsilon in coarsenesses]
        above = [(epsilon, d) for epsilon, d in zip(coarsenesses, found, strict=True) if d > 4.0 * noise]
        fitted = f"{slope(*map(list, zip(*above, strict=True))):.2f}" if len(above) > 2 else "within noise"
        lines.append(row(name, found)[:-1] + f"| {fitted} |")
    lines += [
        "",
        "Both must go together. With every active cell crushing in a pass (probability 1) small load steps help where",
        "sizes differ, but never where many grains are equal and become active at once: that is another model.",
        "",
        *head("start, probability 1", ["load factor 1.32", "1.08", "1.02"]),
    ]
    lines += [row(name, [distance(case, 1.0, factor) for factor in (1.32, 1.08, 1.02)]) for name, case in cases.items()]
    lines += [
        "",
        "A small probability (0.02) with one jump to the load (load factor infinite) fails where the order matters in",
        "which unequal grains become active:",
        "",
        *head("start", ["distance"]),
    ]
    lines += [row(name, [distance(case, 0.02, math.inf)]) for name, case in cases.items()]
    return lines


def draw(cases: dict[str, Case], width: float) -> Figure:
    """Distances over the load, and the curves of the narrow band, where they are farthest apart."""
    plt.rcParams.update(PRINT_STYLE)
    rows, columns, height = (2, 1, 130.0) if width < 120.0 else (1, 2, 72.0)
    figure, (left, right) = plt.subplots(rows, columns, figsize=figure_size(width, height), layout="constrained")
    plot_distances({name: case.found for name, case in cases.items()}, left)
    left.set_ylim(top=0.22)
    left.legend(loc="center right", bbox_to_anchor=(1.0, 0.56))
    case = cases[NARROW]
    size = grid_of(SPACING).edge_sizes[1:]
    right.plot(size, case.result.start.cdf(), color="0.6", lw=0.9, label="start")
    for load, colour in ((1.5, "#0072b2"), (8.0, "#d55e00")):
        k = LOADS.index(load)
        right.plot(size, case.lattice_cdf[SPACING][k], color=colour, label=rf"lattice, $\sigma^*$ = {load:g}")
        right.plot(size, case.result.cdf[k], color=colour, ls="--", label=rf"continuum, $\sigma^*$ = {load:g}")
    right.set(xlim=(0.8, 1.003), ylim=(0.0, 1.02), title="sizes uniform in 0.9 to 1")
    right.set(xlabel="grainsize $s$ / reference size", ylabel="mass fraction finer")
    right.grid(alpha=0.3, lw=0.4)
    right.legend(loc="upper left")
    return figure


def main() -> None:
    """Run everything, about five minutes, and write the report and the picture."""
    cases = {}
    for name in STARTS:
        cases[name] = Case(name)
        print(name, np.round(cases[name].found.distance, 4), flush=True)
    figure = draw(cases, 170.0)
    figure.savefig(HERE.parent / "images" / "how-good.png", dpi=200)
    lines = [
        "# Continuum against lattice",
        "",
        f"Output of `docs/validation/continuum_against_lattice.py`, comminute {cm.__version__}. Material: w = 3,",
        "n = 0.05, reference size 1, truncated exponential fragments (scale 1, shape 1); arithmetic neighbour mean.",
        "",
    ]
    for part in (report_distances, report_refinement, report_finite_rings, report_time_steps):
        lines += [*part(cases), ""]
        print(part.__name__, flush=True)
    (HERE / "continuum_against_lattice.md").write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    main()

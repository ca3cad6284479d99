"""Random load paths through the quasi-static solver, held against the laws; writes a page of docs/validation.

    python tests/long/fuzz_quasi_static.py [cases] [first case]

Every case has its own seed, (SEED, number), so that a failing one can be run alone: cases 1, first case its number.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

import comminute as cm

SEED = 20200138
CASES = 100_000
REPORT = Path(__file__).parents[2] / "docs" / "validation" / "fuzz-quasi-static.md"

Floats = npt.NDArray[np.float64]
Axis = Literal["grain", "neighbour"]
Law = cm.WeibullFragments | cm.PowerLawFragments | cm.LogNormalFragments | cm.TabulatedFragments

# Law: what is measured, and the most it may be; of sums of many numbers for each unit of 1 + crushes a cell.
LIMITS = {
    "mass": ("total mass less 1", 1e-14),
    "negative": ("most negative mass, in bins, ridges, atoms or marginal", 0.0),
    "fining": ("rise of the mean of psi or of psibar, and fall of either cdf, over a load", 1e-14),
    "abelian": ("state after a path against one solve", 1e-14),
    "abelian count": ("crushes along a path against those of one solve", 1e-14),
    "paths": ("bin by bin against running sums", 1e-14),
    "marginal": ("marginal alone, and the one a fabric carries along a path, against row sums", 1e-14),
    "remix": ("remixing what is mixed", 0.0),
}


@dataclass
class Tally:
    """Worst values, where they were seen, and what kinds of cases there were."""

    worst: dict[str, tuple[float, int]] = field(default_factory=lambda: dict.fromkeys(LIMITS, (0.0, -1)))
    counts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)

    def note(self, law: str, value: float, case: int) -> None:
        """Hold one value against its law."""
        if not value <= self.worst[law][0]:
            self.worst[law] = (value, case)
        if not value <= LIMITS[law][1]:
            self.failures.append(f"case {case}: {law} {value:.2e}")


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw evenly in the logarithm."""
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def random_law(rng: np.random.Generator) -> Law:
    """Draw one of four laws; Weibull rates scale^-shape from 0.1 to 100."""
    which = rng.integers(5)
    if which <= 1:
        shape = log_uniform(rng, 0.5, 4.0)
        return cm.WeibullFragments(log_uniform(rng, 0.1, 100.0) ** (-1.0 / shape), shape)
    if which == 2:
        return cm.PowerLawFragments(log_uniform(rng, 0.3, 4.0))
    if which == 3:
        return cm.LogNormalFragments(float(rng.uniform(-2.0, 1.0)), log_uniform(rng, 0.1, 2.0))
    points = int(rng.integers(2, 8))
    x = np.exp(np.append(-np.cumsum(rng.uniform(0.1, 1.0, points - 1))[::-1], 0.0))
    share = np.cumsum(rng.dirichlet(np.ones(points)))
    return cm.TabulatedFragments(x, np.append(share[:-1] - rng.integers(2) * share[0], 1.0))


def random_material(rng: np.random.Generator) -> cm.Material:
    """Draw a material; one in twenty without fabric."""
    return cm.Material(
        weibull_modulus=log_uniform(rng, 0.5, 12.0),
        fabric_width=math.inf if rng.random() < 0.05 else log_uniform(rng, 0.01, 300.0),
        reference_size=log_uniform(rng, 0.1, 10.0),
        fragments=random_law(rng),
    )


def random_grid(rng: np.random.Generator) -> cm.LogGrid:
    """Draw a grid, mostly small."""
    bins = int(rng.integers(8, 40)) if rng.random() < 0.9 else round(log_uniform(rng, 40.0, 160.0))
    top = float(rng.uniform(-1.0, 1.5))
    return cm.LogGrid(top - float(rng.uniform(0.3, 12.0)), top, bins)


def random_bins(rng: np.random.Generator, bins: int) -> Floats:
    """Draw masses of total 1, dense or nearly all empty."""
    p = rng.exponential(size=(bins, bins)) * (rng.random((bins, bins)) < rng.choice([0.02, 0.3, 1.0]))
    p[rng.integers(1, bins), rng.integers(1, bins)] += rng.choice([1e-3, 1.0, 100.0])
    return np.asarray(p / p.sum())


def random_fabric(rng: np.random.Generator, grid: cm.LogGrid) -> cm.Fabric:
    """Draw bins alone, bins with atoms and ridges, or a mixed grading; sizes on edges and centres among them."""
    kind = rng.integers(4)
    if kind == 0:
        return cm.Fabric(grid, random_bins(rng, grid.bins))
    low, high = grid.edges[1], grid.edges[-1] - 1e-9
    if kind == 1:
        coarse, fine = np.exp(np.sort(rng.uniform(low, high, 2))[::-1])
        return cm.mixed_fabric(cm.gap_graded(float(coarse), float(fine), float(rng.uniform(0.05, 0.95))), grid)
    if kind == 2:
        smallest, largest = np.exp(np.sort(rng.uniform(low, high, 2)))
        if largest / smallest > 1.01:
            return cm.mixed_fabric(cm.power_law(float(rng.uniform(0.5, 3.5)), float(smallest), float(largest)), grid)
    places = np.concatenate(
        [rng.uniform(low, high, 3), rng.choice(grid.centres[1:], 2), rng.choice(grid.edges[1:-1], 1)]
    )
    share = rng.dirichlet(np.ones(3))
    atoms = [
        (float(rng.choice(places)), float(rng.choice(places)), float(mass))
        for mass in share[1] * rng.dirichlet(np.ones(5))
    ]
    ridges = []
    for part in share[2] * rng.dirichlet(np.ones(2)):
        mass, at = part * rng.dirichlet(np.full(grid.bins, 0.3)), float(rng.choice(places))
        exact: Axis = "grain" if rng.random() < 0.5 else "neighbour"
        ridges.append(cm.Ridge(exact, at, mass, float(mass[grid.bin_of(at)] * rng.random())))
    return cm.Fabric(grid, share[0] * random_bins(rng, grid.bins), atoms, ridges=ridges)


def random_loads(rng: np.random.Generator) -> list[float]:
    """Draw loads with unloading, none at all, repetition and increments of an ulp."""
    last = log_uniform(rng, 0.05, 1e5)
    loads = (last * np.exp(-rng.exponential(1.5, int(rng.integers(1, 6))))).tolist()
    loads.append(last)
    if rng.random() < 0.3:
        loads.append(float(rng.choice([0.0, last, math.nextafter(last, math.inf)])))
    return [float(load) for load in loads]


def parts_of(fabric: cm.Fabric) -> tuple[Floats, dict[tuple[object, ...], Floats]]:
    """Masses in bins, and all exact ones by their place."""
    exact: dict[tuple[object, ...], Floats] = {}
    for atom in fabric.atoms:
        place = ("atom", atom.psi, atom.psibar)
        exact[place] = exact.get(place, np.zeros(1)) + atom.mass
    for ridge in fabric.ridges:
        exact[ridge.exact, ridge.at] = exact.get((ridge.exact, ridge.at), np.zeros(fabric.grid.bins)) + ridge.mass
    return fabric.probability, exact


def difference(a: cm.Fabric, b: cm.Fabric) -> float:
    """Largest difference between two fabrics."""
    (p, of_a), (q, of_b) = parts_of(a), parts_of(b)
    worst = float(np.abs(p - q).max())
    for place in of_a.keys() | of_b.keys():
        worst = max(worst, float(np.abs(of_a.get(place, np.zeros(1)) - of_b.get(place, np.zeros(1))).max()))
    return worst


def least(fabric: cm.Fabric) -> float:
    """Smallest mass anywhere."""
    p, exact = parts_of(fabric)
    return float(min([p.min(), fabric.grainsize().min(), *(mass.min() for mass in exact.values())]))


def total(fabric: cm.Fabric) -> float:
    """All mass."""
    p, exact = parts_of(fabric)
    return math.fsum([*p.ravel(), *(value for mass in exact.values() for value in mass)])


def rows_of(fabric: cm.Fabric) -> Floats:
    """Mass by grainsize summed anew, since a fabric carries its own."""
    p, exact = parts_of(fabric)
    rows = p.sum(axis=1)
    for (axis, *at), mass in exact.items():
        if axis == "neighbour":
            rows = rows + mass
        else:
            rows[fabric.grid.bin_of(float(str(at[0])))] += mass.sum()
    return np.asarray(rows)


def check_load(tally: Tally, case: int, before: cm.Fabric, after: cm.Fabric, scale: float) -> None:
    """Laws over one load."""
    tally.note("mass", abs(total(after) - 1.0) / scale, case)
    tally.note("negative", max(0.0, -least(after)), case)
    for start, end in ((before.grainsize(), after.grainsize()), (before.neighbourhood(), after.neighbourhood())):
        moved = end - start
        tally.note("fining", max(float(moved @ after.grid.centres), -float(np.cumsum(moved).min()), 0.0) / scale, case)


def run_case(tally: Tally, case: int) -> None:
    """One random case."""
    rng = np.random.default_rng([SEED, case])
    grid, material = random_grid(rng), random_material(rng)
    scheme: Literal["conservative", "paper"] = "conservative" if rng.random() < 0.7 else "paper"
    rate = 0.0 if grid.bins > 30 or rng.random() < 0.75 else float(rng.choice([rng.random(), 1.0]))
    fabric = random_fabric(rng, grid)
    if scheme == "paper":
        fabric = fabric.binned()
    path: Literal["direct", "sums"] = "direct" if rng.random() < 0.5 else "sums"
    solver = cm.QuasiStatic(grid, material, scheme, rate, path=path)
    for kind in (
        type(material.fragments).__name__,
        scheme,
        "slow" if rate == 0.0 else "fast" if rate == 1.0 else "blend",
    ):
        tally.counts[kind] += 1
    tally.counts["with exact sizes"] += bool(fabric.atoms or fabric.ridges)

    all_crushes = 0.0  # remixing keeps what rounding has done to the mass
    for segment in range(1 + int(rng.integers(3))):
        if segment > 0:
            fabric = cm.remix(fabric)
            tally.note("remix", 0.0 if cm.remix(fabric) == fabric else 1.0, case)
            tally.counts["remixings"] += 1
        start, crushed, largest = fabric, 0.0, 0.0
        loads = random_loads(rng)
        for load in loads:
            marginal = solver.marginal(fabric, load)
            after = solver.solve(fabric, load)
            tally.note("negative", max(0.0, -solver.report.crushed, -solver.report.crushed_neighbour), case)
            crushed += solver.report.crushed + solver.report.crushed_neighbour
            all_crushes += solver.report.crushed + solver.report.crushed_neighbour
            largest = max(largest, load)
            check_load(tally, case, fabric, after, 1.0 + all_crushes)
            rows = rows_of(after)
            for carried in (marginal, after.grainsize()):
                tally.note("marginal", float(np.abs(carried - rows).max()) / (1.0 + all_crushes), case)
            fabric = after
            tally.counts["loads"] += 1
        once = solver.solve(start, largest)
        scale = 1.0 + solver.report.crushed + solver.report.crushed_neighbour
        tally.note("abelian", difference(fabric, once), case)
        tally.note("abelian count", abs(crushed + 1.0 - scale) / scale, case)
        if rate == 0.0 and segment == 0:
            other = cm.QuasiStatic(grid, material, scheme, path="sums" if path == "direct" else "direct")
            tally.note("paths", difference(other.solve(start, largest), once), case)
            tally.counts["solved by sums and bin by bin"] += "sums" in (other.report.path, solver.report.path)


def report_of(tally: Tally, cases: int) -> str:
    """Page for the documentation."""
    lines = [
        "# Random load paths against the laws",
        "",
        f"comminute {cm.__version__}, {cases} cases, seed {SEED}; written by `tests/long/fuzz_quasi_static.py`, which",
        "`make check-long` runs. Each case draws a material, a grid, a start (bins, atoms and ridges, or a mixed",
        "grading) and a path with unloading, repetition, increments of an ulp and up to two remixings. States are held",
        "against each other in absolute terms, sums of masses and moments per 1 + crushes a cell, since every crush",
        "rounds; negative masses and remixing are held to exactly 0.",
        "",
        "| law | worst | allowed | case |",
        "|---|---|---|---|",
    ]
    for law, (text, limit) in LIMITS.items():
        worst, case = tally.worst[law]
        lines.append(f"| {text} | {worst:.1e} | {limit:.0e} | {case if worst > 0.0 else '-'} |")
    lines += ["", "| cases | number |", "|---|---|"]
    lines += [f"| {kind} | {count} |" for kind, count in sorted(tally.counts.items())]
    lines += ["", f"Failures: {len(tally.failures)}.", ""]
    return "\n".join([*lines, *(f"* {failure}" for failure in tally.failures[:20])]).rstrip() + "\n"


def main() -> int:
    """Run all cases; the whole run writes the report."""
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else CASES
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    tally = Tally()
    for case in range(first, first + cases):
        run_case(tally, case)
    page = report_of(tally, cases)
    print(page)
    if cases == CASES and first == 0:
        REPORT.parent.mkdir(parents=True, exist_ok=True)
        REPORT.write_text(page, encoding="utf-8")
    return 1 if tally.failures else 0


if __name__ == "__main__":
    sys.exit(main())

"""Answers that were wrong without a word in version 0.1, each beside what is right, known without the library."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import comminute as cm

MONO, GAP = cm.monodisperse(1.0), cm.gap_graded(1.0, 0.1)
SIEVES = {2.0: 100.0, 1.6: 93.0, 1.0: 67.0, 0.5: 33.0, 0.16: 13.0, 0.08: 1.0}


def ran(start: cm.Grading, load: float, **options: object) -> cm.Result:
    return cm.Simulation(cm.Material(), start).run(stress_ratio=load, **options)  # type: ignore[arg-type]


def read(text: str, folder: Path, **options: object) -> cm.Grading:
    path = folder / "table.csv"
    path.write_text(text)
    return cm.Grading.read(path, **options)  # type: ignore[arg-type]


def sieves_called_by_number(folder: Path) -> float:
    grading = read("sieve,percent passing\n#4,100\n#10,80\n#40,20\n#200,2\n", folder)
    return float(cm.SizeCurve.of(grading).size.size)


def own_table_back(folder: Path) -> float:
    del folder
    sand = cm.Grading.from_sieves(list(SIEVES), list(SIEVES.values()), unit="mm")
    back = cm.Simulation(cm.Material(reference_size=2.0), sand).run(stress_ratio=0.0).curve(0).to_sieves(list(SIEVES))
    return float(np.abs(back.percent_finer - list(SIEVES.values())).max())


def below_their_own_size(folder: Path) -> float:
    del folder
    sizes = np.random.default_rng(4).uniform(0.01, 10.0, 200).tolist()
    curves = (ran(cm.monodisperse(size), 0.0).curve(0) for size in sizes)
    return float(sum(curve.finer_than(size) < 1.0 for curve, size in zip(curves, sizes, strict=True)))


def remixed_crushes(folder: Path) -> float:
    del folder
    grid = cm.LogGrid(-9.0, 0.0, 226)  # bins of 0.04
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cm.ResolutionWarning)
        run = cm.Simulation(cm.Material(), MONO, grid=grid).run(stress_ratio=[1.0, 1.0], remix_after=[0])
    return float(run.crushes[-1])


def sizes_of_an_uncrushed_lattice(folder: Path) -> float:
    del folder
    grid = cm.LogGrid(-6.0, 0.1, 100)
    run = cm.Lattice(500, cm.Material(), MONO).run(stress_ratio=0.0, grid=grid)
    return float(run.percentile(99)[0] - run.percentile(1)[0])


def halved_grains(folder: Path) -> float:
    """Give the largest error of the curve of equal grains half of which are halved, each to 2 %."""
    del folder
    halving = cm.LogNormalFragments(math.log(0.5), 0.02)
    curve = cm.Simulation(cm.Material(fabric_width=1.0, fragments=halving), MONO).run(stress_ratio=1.0).curve(0)
    deviation = np.linspace(-3.0, 3.0, 61)
    right = np.array([0.25 * (1.0 + math.erf(z / math.sqrt(2.0))) for z in deviation])
    return float(np.abs(curve.finer_than(0.5 * np.exp(0.02 * deviation)) - right).max())


def warnings_of_a_wide_fabric(folder: Path) -> float:
    del folder
    return float(len(cm.Simulation(cm.Material(fabric_width=20.0), MONO).run(stress_ratio=1e3).warnings))


def kept_bytes(folder: Path) -> float:
    del folder
    run = ran(MONO, np.geomspace(1.0, 1e3, 200))  # type: ignore[arg-type]
    return float(sum(fabric.probability.nbytes for fabric in run.fabrics if fabric is not None))


def unloaded_point(folder: Path) -> float:
    del folder
    grid = cm.LogGrid(-6.0, 0.0, 58)
    solver = cm.QuasiStatic(grid, cm.Material(fabric_width=0.3))
    states = cm.mixed_fabric(cm.power_law(2.5, 0.01, 1.0), grid).probability[None]
    once, settled = solver.solve_batch(states, 100.0), np.zeros(1)
    for load in (100.0, 5.0) * 3:
        states = solver.solve_batch(states, load, settled)
        settled = solver.settled_at
    return float(np.abs(np.cumsum((states - once)[0].sum(axis=1))).max())


# name: (figure, what is right, tolerance)
FIGURES: dict[str, tuple[Callable[[Path], float], float, float]] = {
    "rows of a table whose sieves are #4 to #200": (sieves_called_by_number, 4.0, 0.0),
    "share finer than 0.1 of a gap-graded start": (
        lambda _: float(ran(GAP, 0.0).curve(0).finer_than(0.1)),
        0.5,
        1e-15,
    ),
    "single sizes, of 200, with grains finer than 1 at their own size": (below_their_own_size, 0.0, 0.0),
    "D100 of crushed equal grains": (lambda _: float(ran(MONO, 1.0).percentile(100)[0]), 1.0, 0.0),
    "share of crushed equal grains up to their size": (
        lambda _: float(ran(MONO, 1.0).curve(0).finer_than(1.0)),
        1.0,
        0.0,
    ),
    "error of a sieve table given back, per cent": (own_table_back, 0.0, 1e-12),
    "crushes of equal grains, remixed once": (remixed_crushes, 0.5625, 1e-12),
    "spread of the sizes of an uncrushed lattice": (sizes_of_an_uncrushed_lattice, 0.0, 1e-15),
    "error of the curve of halved grains": (halved_grains, 0.0, 2e-3),
    "warnings where nothing is wrong": (warnings_of_a_wide_fabric, 0.0, 0.0),
    "bytes of fabrics kept, above 256 MB": (lambda f: max(kept_bytes(f) - 256e6, 0.0), 0.0, 0.0),
    "change of a point by unloading": (unloaded_point, 0.0, 1e-15),
}


@pytest.mark.parametrize("name", FIGURES)
def test_the_figure_is_right(name: str, tmp_path: Path) -> None:
    figure, right, tolerance = FIGURES[name]
    assert abs(figure(tmp_path) - right) <= tolerance


def test_what_cannot_be_right_is_said(tmp_path: Path) -> None:
    with pytest.raises(cm.ParameterError, match="decimal"):
        read("size mm;passing\n2,000;100\n1,000;60\n0,500;20,5\n1.500;80.5\n", tmp_path)
    with pytest.raises(TypeError, match="weibull_modulus"):
        cm.Material(weibul_modulus=3.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="read"):
        cm.Simulation(cm.Material(), "sand.csv")  # type: ignore[arg-type]

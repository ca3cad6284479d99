"""Scattered strengths in the law of three cells: a reference from its equations, an exact law, and the lattice."""

import copy
import math
import os
import pickle

import numpy as np
import pytest
import triples as ref
from scipy.special import exp1

import comminute as cm

LONG = os.environ.get("COMMINUTE_HYPOTHESIS") == "long"
LOADS = [0.6, 1.0, 1.5, 2.0, 4.0, 8.0, 32.0, 100.0, 1e3, 1e4]
CELLS, RINGS = (100_000, 40) if LONG else (100_000, 5)
NOISE = 1.95 / math.sqrt(CELLS * RINGS)  # of independent cells, once in a thousand
STARTS = {
    "equal": cm.monodisperse(1.0),
    "band": cm.uniform_size(0.5, 1.0),
    "gap-graded": cm.gap_graded(1.0, 0.1),
    "well graded": cm.power_law(2.5, 1e-2, 1.0),
}


def scattered(width: float, modulus: float = 3.0) -> cm.Material:
    return cm.Material(fabric_width=width, weibull_modulus=modulus, strength_scatter=True)


def distance(law: cm.Resolved, lattice: cm.Lattice) -> float:
    """Kolmogorov-Smirnov distance at the ends of the nodes, on both sides of exact sizes."""
    sizes, grid = np.sort(lattice.psi, axis=None), law.grid
    rounding = np.where(np.append(grid.exact[1:], False), -1e-12, 1e-12)
    finer = np.searchsorted(sizes, grid.upper + rounding) / sizes.size
    return float(np.abs(finer - law.cdf())[1:].max())


@pytest.mark.parametrize("width", [0.05, 0.4])
def test_gradings_and_crushes_are_the_references(width: float) -> None:
    lower = np.array([-5.0, -3.0, -1.1, -0.8, -0.8, -0.25, -0.1, 0.0])
    upper = np.array([-3.0, -1.1, -0.8, -0.8, -0.25, -0.1, 0.0, 0.0])
    pmf = np.array([0.0, 0.1, 0.1, 0.2, 0.1, 0.1, 0.0, 0.4])
    ours = cm.Resolved(scattered(width, 4.0), pmf, cm.ResolvedGrid(lower, upper))
    weibull = lambda r: -np.expm1(-np.exp(r)) / -math.expm1(-1.0)  # noqa: E731
    theirs = ref.Clock(ref.Nodes(lower, upper, width, 4.0, weibull, scattered=True), pmf)
    for load in (0.3, 1.0, 3.0):
        ours.load_to(load)
        grading, crushes = theirs.load_to(load)
        # means over the contrast are read from a table here, and taken at 1000 places there
        np.testing.assert_allclose(ours.pmf(), grading, rtol=0.0, atol=1e-6)
        assert ours.crushes == pytest.approx(crushes, abs=1e-6)
        assert ours.pmf().sum() == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize(("spacing", "near"), [(0.4, 4e-3), (0.2, 1.1e-3)])
def test_where_neighbours_do_not_matter_the_law_has_its_closed_form(spacing: float, near: float) -> None:
    """Twice as many nodes make a quarter of the error; see tests/python/lattice/test_strengths.py for the law."""
    material = cm.Material(fabric_width=1e3, fragments=cm.PowerLawFragments(1.0), strength_scatter=True)
    grid = cm.ResolvedGrid.graded(0.05, -3.0, [0.0], spacing=spacing, grade=4.0 * spacing)
    law = cm.Resolved(material, grid.pmf(cm.monodisperse(1.0)), grid)
    for load in (0.5, 1.0, 2.0):
        law.load_to(load)
        hazard, size = load**3, np.exp(grid.upper[:-1])
        exact = -math.expm1(-hazard) * np.exp(-(exp1(hazard * size**3) - exp1(hazard)) / 3.0)
        assert np.abs(law.cdf()[:-1] - exact).max() < near
        assert law.pmf()[-1] == pytest.approx(math.exp(-hazard), abs=1e-5)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(("width", "most"), [(0.05, 0.0105), (0.2, 0.0075)])
def test_gradings_are_near_the_lattices_at_every_load_and_after_mixing(start: str, width: float, most: float) -> None:
    law = cm.Resolved(scattered(width), STARTS[start])
    lattice = cm.Lattice(CELLS, scattered(width), STARTS[start], replicas=RINGS, seed=3, threads=2)
    for load in LOADS:
        law.load_to(load)
        lattice.load_to(load)
        assert distance(law, lattice) < most + NOISE
    for load in (32.0, 4.0):
        law.remix()
        lattice.remix()
        law.load_to(load)
        lattice.load_to(load)
    assert distance(law, lattice) < most + NOISE


def test_loads_on_the_way_unloading_copies_and_threads_change_no_bit() -> None:
    start = STARTS["gap-graded"]
    at_once, on_the_way = (cm.Resolved(scattered(0.1), start, threads=threads) for threads in (1, 2))
    at_once.load_to(30.0)
    for load in (0.2, 0.7, 1.0, 0.5, 8.0, 30.0, 3.0):
        on_the_way.load_to(load)
        if load == 8.0:
            again = [copy.deepcopy(on_the_way), pickle.loads(pickle.dumps(on_the_way))]
    np.testing.assert_array_equal(at_once.pmf(), on_the_way.pmf())
    for other in again:
        other.load_to(30.0)
        np.testing.assert_array_equal(other.pmf(), at_once.pmf())
        other.remix()
        other.load_to(10.0)
    at_once.remix()
    at_once.load_to(10.0)
    np.testing.assert_array_equal(again[0].pmf(), at_once.pmf())
    np.testing.assert_array_equal(again[1].pmf(), at_once.pmf())


def test_symmetry_and_mass_are_kept() -> None:
    law = cm.Resolved(scattered(0.2), STARTS["band"])
    law.load_to(50.0)
    law.remix()
    law.load_to(100.0)
    triples = law.triples()
    np.testing.assert_array_equal(triples, triples.transpose(0, 2, 1))
    np.testing.assert_allclose(triples.sum(axis=2), triples.sum(axis=2).T, atol=1e-14)
    assert triples.sum() == pytest.approx(1.0, abs=1e-13)


def test_runs_and_their_files_know_the_scatter(tmp_path) -> None:  # type: ignore[no-untyped-def]
    result = cm.Simulation(scattered(0.05), STARTS["equal"], closure="resolved").run(stress_ratio=[0.5, 1.0])
    assert result.crushes[0] == pytest.approx(1.0 - math.exp(-(0.5**3)), abs=0.02)
    assert cm.open_result(result.save(tmp_path / "run.nc")) == result
    assert cm.run_again(result) == result


def test_a_loaded_lattice_is_no_start() -> None:
    lattice = cm.Lattice(5_000, scattered(0.05), STARTS["gap-graded"])
    law = cm.Resolved.from_lattice(lattice)
    lattice.load_to(1.0)
    with pytest.raises(cm.ParameterError, match=r"lattice.*has been loaded"):
        cm.Resolved.from_lattice(lattice)
    lattice.remix()
    with pytest.raises(cm.ParameterError, match=r"lattice.*has been loaded"):
        cm.Resolved.from_lattice(lattice)
    law.load_to(1.0)
    assert 0.04 < law.crushes < 0.08

"""Scattered strengths on the lattice: a law known in closed form, and what a grain keeps.

Statistical checks have fixed seeds; their levels are such that 1 in 10^4 correct programs would fail one.
"""

import copy
import math
import pickle

import numpy as np
import numpy.typing as npt
import pytest
from scipy.special import exp1

import comminute as cm

Floats = npt.NDArray[np.float64]
KOLMOGOROV = 2.23  # sqrt(n) times the distance: exceeded by 1 sample in 10^4
SCATTERED = cm.Material(weibull_modulus=4.0, strength_scatter=True)


def exact_cdf(size: Floats, hazard: float) -> Floats:
    """Finer than a size < 1, of equal grains of size 1 whose neighbours do not matter, with uniform fragments.

    A grain of size s survives with probability exp(-c s^3), whenever it came about, since its strength is drawn anew
    and zones are nested. The mass M(s) that has passed s goes on from any visited size t with 1 - exp(-c t^3) and
    lands below s with s / t: M' / M = exp(-c s^3) / s, with M(1) = 1 - e^-c.
    """
    found: Floats = -math.expm1(-hazard) * np.exp(-(exp1(hazard * size**3) - exp1(hazard)) / 3.0)
    return found


@pytest.mark.parametrize("modulus", [2.0, 3.0, 8.0])
def test_without_neighbours_gradings_have_their_closed_form(modulus: float) -> None:
    material = cm.Material(
        weibull_modulus=modulus,
        fabric_width=math.inf,
        fragments=cm.PowerLawFragments(1.0),
        strength_scatter=True,
    )
    lattice = cm.Lattice(400_000, material, cm.monodisperse(1.0), seed=4)
    for load in (0.6, 1.0, 1.5, 4.0):
        lattice.load_to(load)
        hazard = load**modulus
        psi = np.sort(lattice.psi[0])
        at = np.linspace(0.02, 0.999, 400)
        finer = np.searchsorted(psi, np.log(at), side="right") / psi.size
        assert np.abs(finer - exact_cdf(at, hazard)).max() < KOLMOGOROV / math.sqrt(psi.size)
        intact = float((psi == 0.0).mean())
        assert intact == pytest.approx(math.exp(-hazard), abs=4.0 * math.sqrt(math.exp(-hazard) / psi.size) + 1e-12)


def test_strengths_of_a_start_follow_their_law() -> None:
    lattice = cm.Lattice(200_000, SCATTERED, cm.monodisperse(1.0), seed=2, replicas=2)
    assert not np.array_equal(*lattice.strength)
    share = -np.expm1(-(np.sort(lattice.strength, axis=None) ** 4.0))
    steps = np.arange(1, share.size + 1) / share.size
    assert np.abs(share - steps).max() < KOLMOGOROV / math.sqrt(share.size)
    assert (cm.Lattice(100, cm.Material(), cm.monodisperse(1.0)).strength == 1.0).all()


def test_a_grain_keeps_its_strength_until_it_crushes_also_when_it_is_moved() -> None:
    lattice = cm.Lattice(20_000, SCATTERED, cm.uniform_size(0.5, 1.0), seed=1)
    before = lattice.strength
    lattice.load_to(2.0)
    crushed = lattice.crushes > 0
    assert 0.05 < crushed.mean() < 0.9
    np.testing.assert_array_equal(lattice.strength[~crushed], before[~crushed])
    assert (lattice.strength[crushed] != before[crushed]).all()
    grains = np.rec.fromarrays([lattice.psi[0], lattice.strength[0], lattice.crushes[0]])
    lattice.remix()
    moved = np.rec.fromarrays([lattice.psi[0], lattice.strength[0], lattice.crushes[0]])
    assert not np.array_equal(grains, moved)
    np.testing.assert_array_equal(np.sort(grains), np.sort(moved))


@pytest.mark.parametrize("kind", [cm.Lattice, cm.TimeSteppedLattice])
def test_copies_and_pickles_go_on_alike(kind: type[cm.Lattice]) -> None:
    lattice = kind(2_000, SCATTERED, cm.gap_graded(1.0, 0.2), replicas=2, seed=5)
    lattice.load_to(1.5)
    again = [copy.deepcopy(lattice), pickle.loads(pickle.dumps(lattice))]
    lattice.load_to(30.0)
    for other in again:
        assert other != lattice
        other.load_to(30.0)
        assert other == lattice
        np.testing.assert_array_equal(other.strength, lattice.strength)


def test_the_time_stepped_lattice_comes_near_the_event_driven_one() -> None:
    start = cm.monodisperse(1.0)
    fine = cm.TimeSteppedLattice(20_000, SCATTERED, start, crush_probability=0.02, load_factor=1.002, replicas=4)
    lattice = cm.Lattice(20_000, SCATTERED, start, replicas=4, seed=9)
    fine.load_to(4.0)
    lattice.load_to(4.0)
    curves = [np.sort(rings.psi, axis=None) for rings in (fine, lattice)]
    at = np.linspace(-4.0, -0.01, 200)
    one, other = (np.searchsorted(psi, at) / psi.size for psi in curves)
    assert np.abs(one - other).max() < 2.0 * KOLMOGOROV / math.sqrt(80_000)


def test_a_uniform_sand_yields_over_a_range_of_loads_and_not_at_once() -> None:
    loads = [0.5, 0.8, 1.0, 1.3]
    sharp = cm.Lattice(50_000, cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=loads)
    scattered = cm.Lattice(50_000, cm.Material(strength_scatter=True), cm.monodisperse(1.0)).run(stress_ratio=loads)
    assert sharp.crushes[:2].tolist() == [0.0, 0.0]
    assert (np.diff(scattered.crushes) > 0.05).all()
    assert scattered.crushes[0] == pytest.approx(1.0 - math.exp(-(0.5**3)), abs=0.02)


def test_models_with_one_strength_a_size_refuse_it() -> None:
    grid, start = cm.LogGrid(-4.0, 0.0, 41), cm.monodisperse(1.0)
    for make in (
        lambda: cm.QuasiStatic(grid, SCATTERED),
        lambda: cm.SlowUpdate(grid, SCATTERED),
        lambda: cm.FullConvolution(grid, SCATTERED, "exact"),
        lambda: cm.CrushZones(grid, SCATTERED, 2.0),
        lambda: cm.SmallRing(3, cm.LogGrid(-2.0, 0.0, 8), SCATTERED),
        lambda: cm.Simulation(SCATTERED, start),
        lambda: cm.compare_closures(SCATTERED, start, stress_ratio=2.0, cells=1_000),
    ):
        with pytest.raises(cm.ParameterError, match=r"strength_scatter is [tT]rue.*Lattice"):
            make()

"""The stochastic lattice: against a plain ring bit by bit, against laws known in closed form, and as a user meets it.

Statistical checks have fixed seeds; their levels are such that 1 in 10^4 correct programs would fail one. With
COMMINUTE_HYPOTHESIS=long (make check-long) the samples are the large ones.
"""

import math
import os
import pickle
import signal
import threading
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm
from comminute.util.choices import Mean, Scheme
from gil import counts_on_during
from reference import Array
from reference_lattice import MASK, PlainRing, philox

LONG = os.environ.get("COMMINUTE_HYPOTHESIS") == "long"
MATERIAL = cm.Material()
UNIFORM_OFF = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(1.0))
STARTS = {
    "monodisperse": cm.monodisperse(1.0),
    "narrow": cm.uniform_size(0.9, 1.0),
    "gap-graded": cm.gap_graded(1.0, 0.1),
    "power law": cm.power_law(2.5, 1e-3, 1.0),
}
Counts = npt.NDArray[np.int64]
Ring = tuple[Array, cm.Material, Mean]
KOLMOGOROV = 2.23  # sqrt(n) times the distance: exceeded by 1 sample in 10^4


def kolmogorov(sample: Array, cdf: Callable[[Array], Array]) -> float:
    ordered = np.sort(sample)
    finer, n = cdf(ordered), sample.size
    steps = np.arange(n + 1) / n
    return float(math.sqrt(n) * max((steps[1:] - finer).max(), (finer - steps[:-1]).max()))


def chi_square_score(observed: Counts, expected: Array, fixed: int = 1) -> float:
    """Chi-square as a standard normal score (Wilson-Hilferty), rare classes taken together."""
    rare = expected < 10.0
    o = np.append(observed[~rare], observed[rare].sum())
    e = np.append(expected[~rare], expected[rare].sum())
    o, e = o[e > 0], e[e > 0]
    k = o.size - fixed
    return float((((o - e) ** 2 / e).sum() / k) ** (1 / 3) - (1 - 2 / (9 * k))) / math.sqrt(2 / (9 * k))


def log_critical(psi: Array, material: cm.Material, mean: str = "arithmetic") -> Array:
    left, right = np.roll(psi, 1), np.roll(psi, -1)
    neighbour = 0.5 * (left + right) if mean == "geometric" else np.log(0.5 * (np.exp(left) + np.exp(right)))
    cushion = 0.0 if math.isinf(material.fabric_width) else 0.5 * ((psi - neighbour) / material.fabric_width) ** 2
    return np.asarray(-3.0 / material.weibull_modulus * (psi - math.log(material.reference_size)) + cushion)


def test_the_plain_ring_draws_philox_as_published() -> None:
    """Known answers of Philox 2x64-10: zeros, ones, and the digits of pi."""
    assert philox(0, 0, 0) == (0xCA00A0459843D731, 0x66C24222C9A845B5)
    assert philox(MASK, MASK, MASK) == (0x65B021D60CD8310F, 0x4D02F3222F86DF20)
    digits = (0xA4093822299F31D0, 0x243F6A8885A308D3, 0x13198A2E03707344)
    assert philox(*digits) == (0x0A5E742C2997341C, 0xB0F883D38000DE5D)


@st.composite
def rings(draw: st.DrawFn) -> Ring:
    cells = draw(st.integers(2, 90))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    sizes = draw(
        st.sampled_from(
            [
                np.ones(cells),
                rng.choice([1.0, 0.1], cells),
                rng.choice([1.0, 0.9, 0.5], cells),
                rng.uniform(0.9, 1.0, cells),
                np.exp(rng.uniform(-5.0, 0.5, cells)),
            ]
        )
    )
    laws: list[cm.WeibullFragments | cm.PowerLawFragments] = [
        cm.WeibullFragments(),
        cm.PowerLawFragments(2.0),
        cm.WeibullFragments(0.5, 3.0),
    ]
    material = cm.Material(
        weibull_modulus=draw(st.sampled_from([1.0, 3.0, 8.0])),
        fabric_width=draw(st.sampled_from([0.02, 0.05, 0.3, 2.0, math.inf])),
        reference_size=draw(st.sampled_from([1.0, 0.7])),
        fragments=draw(st.sampled_from(laws)),
        strength_scatter=draw(st.booleans()),
    )
    means: list[Mean] = ["arithmetic", "geometric"]
    return sizes, material, draw(st.sampled_from(means))


@given(ring=rings(), seed=st.integers(0, 2**64 - 1), ends=st.lists(st.floats(0.3, 200.0), min_size=2, max_size=2))
def test_every_bit_is_that_of_the_plain_ring(ring: Ring, seed: int, ends: list[float]) -> None:
    """Stretch by stretch or always the weakest cell of all: the same crushes, sizes and avalanches."""
    sizes, material, mean = ring
    plain = PlainRing(sizes, material, seed, mean=mean)
    lattice = cm.Lattice.from_sizes(sizes, material, seed=seed, mean=mean, record_avalanches=True)
    for remixed, load in zip((True, False), ends, strict=True):
        plain.load_to(load)
        lattice.load_to(load)
        if remixed:
            plain.remix()
            lattice.remix()
    np.testing.assert_array_equal(lattice.crushes[0], plain.crushes)
    np.testing.assert_array_equal(lattice.psi[0], np.array(plain.psi) + math.log(material.reference_size))
    assert lattice.avalanches()[1].tolist() == [crushes for _, crushes in plain.avalanches]
    np.testing.assert_allclose(np.log(lattice.avalanches()[0]), [load for load, _ in plain.avalanches], atol=1e-12)


@given(ring=rings(), loads=st.lists(st.floats(0.0, 500.0), min_size=1, max_size=4))
def test_laws_of_every_ring(ring: Ring, loads: list[float]) -> None:
    """Cells only get finer; none is left that the largest load crushes; unloading does nothing."""
    sizes, material, mean = ring
    lattice = cm.Lattice.from_sizes(sizes, material, replicas=2, mean=mean)
    before, largest = lattice.psi, 0.0
    np.testing.assert_allclose(np.exp(before), [sizes, sizes], rtol=1e-14)
    for load in loads:
        crushes = lattice.load_to(load)
        after = lattice.psi
        assert after.shape == before.shape
        assert (after <= before).all()
        if load <= largest:
            assert crushes == 0
            np.testing.assert_array_equal(after, before)
        largest = max(load, largest)
        for psi, strength in zip(after, lattice.strength, strict=True):
            critical = log_critical(psi, material, mean) + np.log(strength)
            assert largest == 0.0 or critical.min() > math.log(largest) - 1e-12
        before = after
    assert lattice.settled_at == largest
    lattice.remix()
    assert lattice.settled_at is None
    np.testing.assert_array_equal(np.sort(lattice.psi, axis=1), np.sort(before, axis=1))


def test_equal_sizes_crush_by_random_sequential_adsorption() -> None:
    """Nearest-neighbour exclusion jams at (1 - e^-2) / 2; the average over seeds lies within 3 standard errors."""
    cells, replicas = (1_000_000, 10) if LONG else (50_000, 20)
    result = cm.Lattice(cells, MATERIAL, cm.monodisperse(1.0), replicas=replicas, seed=11).run(stress_ratio=1.0)
    assert result.crushes_error[0] < 1.0 / math.sqrt(cells * replicas)
    assert abs(result.crushes[0] - 0.5 * (1.0 - math.exp(-2.0))) < 3.0 * result.crushes_error[0]


@pytest.mark.parametrize("kind", [cm.Lattice, cm.TimeSteppedLattice])
def test_without_fabric_sizes_are_uniform_and_counts_poisson(kind: type[cm.Lattice | cm.TimeSteppedLattice]) -> None:
    """Fabric off, uniform X: s/s_c ~ U(0, 1) with s_c = s_max sigma*^(-w/3), 1 + Poisson(ln(s_max/s_c)) crushes."""
    cells = 400_000 if LONG else 40_000
    lattice = kind(cells, UNIFORM_OFF, cm.monodisperse(1.0), seed=3)
    load = math.exp(3.0)
    lattice.load_to(load)
    assert kolmogorov(np.exp(lattice.psi[0]) * load, lambda u: np.clip(u, 0.0, 1.0)) < KOLMOGOROV
    counts = np.bincount(lattice.crushes[0] - 1, minlength=30)[:30]
    poisson = np.array([math.exp(-3.0) * 3.0**k / math.factorial(k) for k in range(30)])
    assert chi_square_score(counts, cells * poisson) < 3.7


@pytest.mark.parametrize("passes", [1, 2, 5])
def test_all_crush_t_times_gives_the_gamma_law(passes: int) -> None:
    """Every cell crushes at every step, uniform X: -psi ~ Gamma(t, 1), whatever the neighbours."""
    material = cm.Material(fabric_width=1e3, fragments=cm.PowerLawFragments(1.0))
    lattice = cm.TimeSteppedLattice(20_000, material, cm.monodisperse(1.0), crush_probability=1.0, seed=passes)
    for _ in range(passes):
        assert lattice.crush_pass(1e200) == 20_000

    def gamma(x: Array) -> Array:
        terms = [np.exp(-x) * x**k / math.factorial(k) for k in range(passes)]
        return np.asarray(1.0 - np.sum(terms, axis=0))

    psi = lattice.psi[0]
    assert kolmogorov(-psi, gamma) < KOLMOGOROV
    assert abs(np.corrcoef(psi, np.roll(psi, 1))[0, 1]) < 4.0 / math.sqrt(psi.size)


def synchronous_walk(
    states: Counts, grid: cm.LogGrid, material: cm.Material, load: float, pmf: Array, rng: np.random.Generator
) -> Counts:
    """One synchronous Monte Carlo step of many rings (rows) of bin indices, by Eq. 2 and the pmf."""
    size = grid.sizes[states]
    neighbour = 0.5 * (np.roll(size, 1, axis=1) + np.roll(size, -1, axis=1))
    critical = (size / material.reference_size) ** (-3.0 / material.weibull_modulus) * np.exp(
        0.5 * (np.log(size / neighbour) / material.fabric_width) ** 2
    )
    drop = np.searchsorted(np.cumsum(pmf), rng.random(states.shape), side="right")
    return np.asarray(np.where(critical <= load * (1 + 1e-12), np.maximum(states - drop, 0), states))


@pytest.mark.parametrize("rule", ["paper", "conservative"])
@pytest.mark.parametrize(("cells", "loads"), [(2, [8.0]), (3, [1.0, 4.0, 30.0]), (4, [8.0, 100.0])])
def test_small_rings_agree_with_a_synchronous_monte_carlo(cells: int, loads: list[float], rule: Scheme) -> None:
    bins = 16 if cells < 4 else 8
    grid, material = cm.LogGrid(-2.5, 0.0, bins), cm.Material(fabric_width=0.4)
    ring = cm.SmallRing(cells, grid, material, scheme=rule)
    law = ring.start(cm.log_uniform(0.25, 1.0))
    rng = np.random.default_rng(cells)
    count = 400_000 if LONG else 60_000
    states = rng.choice(bins, size=(count, cells), p=cm.log_uniform(0.25, 1.0).on_grid(grid))
    pmf = cm.fragment_pmf(material.fragments, grid.spacing, bins, rule)
    for load in loads:
        for _ in range(2):
            law = ring.step(law, load)
            states = synchronous_walk(states, grid, material, load, pmf, rng)
        observed = np.bincount(np.ravel_multi_index(tuple(states.T), ring.shape), minlength=bins**cells)
        assert law.sum() == pytest.approx(1.0, abs=1e-13)
        assert chi_square_score(observed, count * law.ravel()) < 3.7
        assert ring.grainsize(law) == pytest.approx(law.sum(axis=tuple(range(1, cells))), abs=1e-13)  # a ring turns


@pytest.mark.parametrize("rule", ["paper", "conservative"])
def test_the_ring_of_two_is_the_exact_kernel(rule: Scheme) -> None:
    grid, material = cm.LogGrid(-4.0, 0.2, 20), cm.Material(fabric_width=0.5)
    p = np.random.default_rng(0).dirichlet(np.ones(400)).reshape(20, 20)
    for load in (1.0, 8.0, 1e3):
        step = cm.FullConvolution(grid, material, "exact", scheme=rule).step(p, load)
        np.testing.assert_allclose(cm.SmallRing(2, grid, material, scheme=rule).step(p, load), step, atol=1e-15)


def test_time_steps_converge_to_the_event_driven_lattice() -> None:
    """Load factor to 1 and probability to 0 together; with probability 1 equal sizes are another model."""
    grid = cm.LogGrid(-8.0, 0.02, 201)

    def distance(start: cm.Grading, probability: float, factor: float) -> float:
        events = cm.Lattice(100_000, MATERIAL, start, replicas=2)
        events.load_to(8.0)
        steps = cm.TimeSteppedLattice(
            100_000, MATERIAL, start, replicas=2, seed=5, crush_probability=probability, load_factor=factor
        )
        steps.load_to(8.0)
        return float(np.abs(events.cdf(grid) - steps.cdf(grid)).max())

    noise = 2.0 / math.sqrt(2e5)  # of two empirical curves
    equal = [distance(STARTS["monodisperse"], p, f) for p, f in [(0.3, 1.3), (0.1, 1.1), (0.03, 1.03)]]
    assert equal[0] > 0.05
    assert equal[0] > 2.0 * equal[1] > 4.0 * (equal[2] - noise)
    assert equal[2] < 0.01
    narrow = [distance(STARTS["narrow"], p, f) for p, f in [(0.3, 1.3), (0.03, 1.03)]]
    assert narrow[0] > 0.02
    assert narrow[1] < 3.0 * noise
    assert distance(STARTS["monodisperse"], 1.0, 1.1) > 0.5


@pytest.mark.parametrize("start", STARTS)
def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads(start: str) -> None:
    made = []
    for threads in (1, 2, 5):
        lattice = cm.Lattice(20_000, MATERIAL, STARTS[start], seed=4, replicas=6, threads=threads)
        assert lattice.threads == threads
        lattice.load_to(3.0)
        lattice.remix()
        lattice.load_to(60.0)
        made.append(lattice)
    for other in made[1:]:
        np.testing.assert_array_equal(other.psi, made[0].psi)
        np.testing.assert_array_equal(other.crushes, made[0].crushes)
        assert other == made[0]
    assert made[0] != cm.Lattice(20_000, MATERIAL, STARTS[start], seed=4, replicas=6)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_leaves_a_lattice_that_goes_on(threads: int) -> None:
    # Nearly all fragments are nearly as large as the grain: minutes of crushes.
    material = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(3e3))
    lattice = cm.Lattice(1_000_000, material, cm.monodisperse(1.0), replicas=2, threads=threads)
    alarm = threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT))
    alarm.start()
    with pytest.raises(KeyboardInterrupt):
        lattice.load_to(1e4)
    assert lattice.settled_at is None
    assert lattice.crushes.sum() > 0
    assert np.isfinite(lattice.psi).all()


def test_an_interrupted_run_keeps_the_finished_loads() -> None:
    def interrupt(k: int) -> None:
        if k == 1:
            raise KeyboardInterrupt

    lattice = cm.Lattice(5000, MATERIAL, STARTS["gap-graded"])
    with pytest.raises(cm.Interrupted, match="interrupted after 2 finished loads") as raised:
        lattice.run(stress_ratio=[2, 8, 100], on_load=interrupt)
    partial = raised.value.result
    assert partial is not None
    assert partial.cdf.shape[0] == 2
    assert lattice.settled_at == 8.0
    whole = cm.Lattice(5000, MATERIAL, STARTS["gap-graded"])
    whole.load_to(100)
    lattice.load_to(100)
    assert lattice == whole


def test_the_gil_is_free_during_a_load() -> None:
    """The main thread finishes a long handshake with itself while one single load is still under way."""
    material = cm.Material(fabric_width=math.inf, fragments=cm.PowerLawFragments(100.0))
    lattice = cm.Lattice(50_000, material, cm.monodisperse(1.0))
    assert counts_on_during(lambda: lattice.load_to(100.0))


def test_results_have_the_promised_shapes_and_errors() -> None:
    material = cm.Material(first_crush_stress=1.5)
    lattice = cm.Lattice(5000, material, STARTS["gap-graded"], replicas=4, seed=2)
    result = lattice.run(stress=[3.0, 1.5, 12.0], remix_after=[0])
    assert result.pmf.shape == result.cdf.shape == result.cdf_error.shape == (3, result.grid.bins)
    assert result.crushes.shape == result.crushes_error.shape == result.mass_error.shape == (3,)
    np.testing.assert_allclose(result.stress_ratio, [2.0, 1.0, 8.0])
    assert np.abs(result.mass_error).max() < 1e-12
    assert result.crushes[1] > result.crushes[0]  # new neighbours: the smaller load crushes again
    assert result.percentile(50).shape == (3,)
    assert result.fabric(2).settled_at == 8.0
    np.testing.assert_allclose(result.fabric(2).grainsize(), result.pmf[2], atol=1e-12)
    np.testing.assert_array_equal(result.cdf[2], lattice.cdf(result.grid))
    np.testing.assert_array_equal(result.cdf_error[2], lattice.cdf_error(result.grid))
    assert (result.engine, result.cells, result.replicas, result.seed) == ("Lattice", 5000, 4, 2)
    assert "4 x 5000 cells" in repr(result)
    assert pickle.loads(pickle.dumps(result)) == result
    alone = cm.Lattice(5000, material, STARTS["gap-graded"]).run(stress_ratio=2.0, grid=result.grid)
    assert np.isnan(alone.cdf_error).all()


def test_the_error_of_a_curve_is_that_of_independent_cells_at_the_start() -> None:
    """Before any crush cells are independent: sqrt(F (1 - F) / (cells x replicas))."""
    grid = cm.LogGrid(-5.0, 0.0, 26)
    lattice = cm.Lattice(2000, MATERIAL, cm.log_uniform(0.01, 1.0), replicas=100, seed=8)
    finer = cm.log_uniform(0.01, 1.0).finer(grid.edge_sizes[3:-2])
    expected = np.sqrt(finer * (1.0 - finer) / 2e5)
    ratio = lattice.cdf_error(grid)[2:-2] / expected
    assert 0.9 < np.median(ratio) < 1.1
    assert np.abs(lattice.cdf(grid)[2:-2] - finer).max() < 5.0 * expected.max()


def test_lattices_pickle_compare_and_say_what_they_are() -> None:
    sizes = np.exp(np.random.default_rng(0).uniform(-3.0, 0.0, 3000))
    made: list[cm.Lattice | cm.TimeSteppedLattice] = [
        cm.Lattice(3000, MATERIAL, STARTS["power law"], seed=1, replicas=2, record_avalanches=True),
        cm.Lattice.from_sizes(sizes, MATERIAL, mean="geometric"),
        cm.TimeSteppedLattice(3000, MATERIAL, STARTS["power law"], load_factor=1.2),
        cm.TimeSteppedLattice.from_sizes(sizes, MATERIAL, crush_probability=0.5, load_factor=math.inf),
    ]
    for lattice in made:
        lattice.load_to(20.0)
        lattice.remix()
        lattice.load_to(3.0)
        copy = pickle.loads(pickle.dumps(lattice))
        assert copy == lattice
        assert repr(copy) == repr(lattice)
        assert copy.load_to(100.0) == lattice.load_to(100.0) > 0
        assert copy == lattice
    assert repr(made[0]) == "<Lattice: 2 x 3000 cells, seed 1, at rest under 100>"
    assert made[1] != made[3]
    assert (made[3].crush_probability, made[2].load_factor) == (0.5, 1.2)  # type: ignore[union-attr]


def run(**options: object) -> cm.LatticeResult:
    return cm.Lattice(100, MATERIAL, cm.monodisperse(1.0)).run(**options)  # type: ignore[arg-type]


GRID = cm.LogGrid(-6.0, 0.0, 61)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda: cm.Lattice(1, MATERIAL, cm.monodisperse(1.0)), "cells is 1; it must be at least 2"),
        (lambda: cm.Lattice(9, MATERIAL, cm.monodisperse(1.0), replicas=0), "replicas is 0; it must be at least 1"),
        (lambda: cm.Lattice(9, MATERIAL, cm.monodisperse(1.0), threads=0), "threads is 0; it must be at least 1"),
        (
            lambda: cm.Lattice(9, MATERIAL, cm.monodisperse(1.0), mean="median"),  # type: ignore[arg-type]
            "mean is 'median'; it must be one of 'arithmetic', 'geometric'",
        ),
        (
            lambda: cm.Lattice.from_sizes(np.array([1.0, np.nan]), MATERIAL),
            "sizes[1] is nan; it must be greater than 0 and finite",
        ),
        (lambda: run(stress_ratio=-1.0), "stress_ratio[0] is -1; it must be a number of at least 0"),
        (
            lambda: cm.Lattice(9, MATERIAL, cm.monodisperse(1.0)).load_to(math.inf),
            "stress_ratio is inf; it must be at most e^700",
        ),
        (lambda: run(stress_ratio=1.0, remix_after=[1]), "remix_after has 1; it must hold indices of loads"),
        (lambda: run(stress_ratio=1.0, grid=cm.LogGrid(-6.0, -1.0, 61)), "lies above the grid's top edge"),
        (lambda: cm.Lattice(9, MATERIAL, cm.monodisperse(1.0)).avalanches(), "avalanches were not recorded"),
        (
            lambda: cm.TimeSteppedLattice(9, MATERIAL, cm.monodisperse(1.0), crush_probability=1.5),
            "crush_probability is 1.5; it must be greater than 0 and at most 1",
        ),
        (
            lambda: cm.TimeSteppedLattice(9, MATERIAL, cm.monodisperse(1.0), load_factor=0.9),
            "load_factor is 0.9; it must be greater than 1",
        ),
        (
            lambda: cm.compare(run(stress_ratio=1.0), run(stress_ratio=2.0)),
            "the loads differ: [1.] and [2.]; compare runs of one load path",
        ),
        (
            lambda: cm.compare(run(stress_ratio=1.0), run(stress_ratio=1.0, grid=GRID)),
            "give the lattice's run grid=result.grid",
        ),
        (lambda: cm.SmallRing(5, GRID, MATERIAL), "cells is 5; it must be 2, 3 or 4"),
        (lambda: cm.SmallRing(3, GRID, MATERIAL), "the grid has 61 bins; it must have at most 20 here"),
    ],
)
def test_messages(mistake: Callable[[], object], words: str) -> None:
    with pytest.raises(cm.ParameterError) as raised:
        mistake()
    assert words in str(raised.value)


def test_sizes_are_taken_strictly() -> None:
    with pytest.raises(TypeError, match="sizes is a list; it must be a NumPy float64 array"):
        cm.Lattice.from_sizes([1.0, 2.0], MATERIAL)  # type: ignore[arg-type]
    with pytest.raises(cm.ShapeError, match="sizes has 2 dimensions; it must have one"):
        cm.Lattice.from_sizes(np.ones((2, 2)), MATERIAL)
    ring = cm.SmallRing(3, cm.LogGrid(-2.0, 0.0, 8), MATERIAL, scheme="paper")
    with pytest.raises(cm.ShapeError, match="law has shape"):
        ring.step(np.ones((8, 8)), 1.0)


@settings(max_examples=10)
@given(seed=st.integers(0, 2**64 - 1))
def test_any_seed_will_do(seed: int) -> None:
    lattice = cm.Lattice(50, MATERIAL, STARTS["narrow"], seed=seed)
    assert lattice.load_to(100.0) > 0
    assert lattice.seed == seed

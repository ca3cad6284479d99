"""The column lattice against exact laws of exchange and crushing, and against the closed lattice."""

import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from reference_column import exchange, settle

import comminute as cm

Floats = npt.NDArray[np.float64]
UNIFORM = cm.PowerLawFragments(1.0)
LARGE, SMALL = 2.0, 1.0


def mixing_of(probability: float, height: float, rows: int) -> float:
    """Diffusivity at which a pair swaps with a probability in a second."""
    return probability / (1.0 - probability) * (height / rows) ** 2


def two_sizes(share: float, rows: int, cells: int, seed: int = 0) -> Floats:
    random = np.random.default_rng(seed)
    return np.where(random.random((rows, cells)) < share, LARGE, SMALL)


def column_of(sizes: Floats, **options: Any) -> cm.ColumnLattice:
    return cm.ColumnLattice.from_sizes(sizes, cm.Material(), height=1.0, **{"largest_mixing": 1.0} | options)


def chain(share: float, stay: float, cells: int, seed: int) -> Floats:
    """Ring whose neighbours are alike: each cell is as the one before with a probability, or drawn anew."""
    random = np.random.default_rng(seed)
    drawn = np.where(random.random(cells) < share, LARGE, SMALL)
    fresh = random.random(cells) >= stay
    fresh[0] = True
    return drawn[np.maximum.accumulate(np.where(fresh, np.arange(cells), 0))]


def alike(row: Floats, distance: int = 1) -> float:
    """Covariance of cells at a distance, over the variance."""
    large = row == LARGE
    share = large.mean()
    return float(((large & np.roll(large, distance)).mean() - share**2) / (share * (1.0 - share)))


def test_without_an_exchange_a_row_is_a_ring() -> None:
    material, grading = cm.Material(fabric_width=0.2), cm.gap_graded(1.0, 0.3)
    column = cm.ColumnLattice(material, grading, height=0.02, cells=3, cells_per_row=2000, seed=7)
    rings = cm.Lattice(2000, material, grading, seed=7, replicas=3)
    result = column.run(time=[0.0, 1.0, 2.0], stress_ratio=np.array([[2.0] * 3, [8.0] * 3, [8.0] * 3]))
    for k, load in enumerate([2.0, 8.0]):
        rings.load_to(load)
        for row in range(3):
            assert np.array_equal(result.psi[k, row], rings.psi[row])
    assert np.array_equal(result.psi[2], result.psi[1])
    assert np.array_equal(column.crushes[1], rings.crushes[1])
    assert result.fabric(1, 2) == cm.Lattice.from_sizes(np.exp(rings.psi[2]), material).fabric(result.grid)


@pytest.mark.parametrize("partners", ["permuted", "shift", "locked"])
def test_mixing_keeps_every_grain(partners: Any) -> None:
    sizes = np.random.default_rng(1).uniform(0.5, 2.0, (5, 400))
    column = column_of(sizes, partners=partners)
    result = column.run(time=[0.0, 3.0], stress_ratio=0.0, mixing=mixing_of(0.4, 1.0, 5), segregation=0.05)
    assert not np.array_equal(result.psi[1], result.psi[0])
    np.testing.assert_allclose(np.sort(np.exp(result.psi[1]).ravel()), np.sort(sizes.ravel()), rtol=1e-14)


@pytest.mark.parametrize("q", [0.1, 0.3])
def test_a_tagged_grain_diffuses(q: float) -> None:
    rows, cells = 41, 4000
    sizes = np.full((rows, cells), SMALL)
    sizes[20] = LARGE
    column = column_of(sizes)
    result = column.run(time=[0.0, 6.0], stress_ratio=0.0, mixing=mixing_of(q, 1.0, rows), step=1.0)
    share = (np.exp(result.psi[1]) > 1.5).mean(axis=1)
    variance = float(share @ (np.arange(rows) - 20.0) ** 2)
    assert variance == pytest.approx(2.0 * q / (1.0 - q) * 6.0, rel=0.15 if q > 0.2 else 0.08)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_flux_of_segregation(share: float) -> None:
    rows, cells, c = 4, 400_000, 0.1
    column = column_of(two_sizes(share, rows, cells))
    mean = share * LARGE + (1.0 - share) * SMALL
    q = c / (1.0 + 0.5 * c)
    k_s = c * mean / ((LARGE - SMALL) * rows)  # so that Q of a large grain below a small one is c
    result = column.run(time=[0.0, 1.0], stress_ratio=0.0, segregation=k_s)
    assert result.exchanges[1] == 1
    large = (np.exp(result.psi) > 1.5).mean(axis=2)
    # bonds 0-1 and 2-3 go first, from rows that know of nothing
    gained = q * share * (1.0 - share)
    assert large[1, 0] - large[0, 0] == pytest.approx(-gained, abs=4.0 * math.sqrt(gained / cells))
    assert large[1, 3] - large[0, 3] == pytest.approx(gained, abs=4.0 * math.sqrt(gained / cells))


def test_rates_of_flowslm_are_those_of_pairs_for_two_sizes() -> None:
    sizes = two_sizes(0.4, 2, 300_000)
    found = []
    for rates in ("pair", "flowslm"):
        column = column_of(sizes, rates=rates)
        result = column.run(time=[0.0, 1.0], stress_ratio=0.0, segregation=0.05)
        found.append((np.exp(result.psi[1]) > 1.5).mean(axis=1))
    assert found[0] == pytest.approx(found[1], abs=3e-3)
    # grains of one size over grains of a smaller one have no velocity by FlowSLM's rule
    frozen = np.vstack([np.full(1000, LARGE), np.full(1000, SMALL)])
    for rates, moved in (("pair", True), ("flowslm", False)):
        result = column_of(frozen, rates=rates).run(time=[0.0, 1.0], stress_ratio=0.0, segregation=0.05)
        assert bool((np.exp(result.psi[1, 0]) < 1.5).any()) is moved


@pytest.mark.parametrize(("partners", "factor"), [("permuted", 0.81), ("shift", 0.82), ("locked", 0.82)])
def test_neighbours_are_forgotten_by_exchange(partners: Any, factor: float) -> None:
    cells, rows = 300_000, 2  # one bond, and so one exchange a second
    sizes = np.array([chain(0.4, 0.7, cells, seed) for seed in range(rows)])
    result = column_of(sizes, partners=partners).run(time=[0.0, 1.0], stress_ratio=0.0, mixing=mixing_of(0.1, 1.0, 2))
    before = np.mean([alike(row) for row in sizes])
    after = np.mean([alike(np.where(np.exp(row) > 1.5, LARGE, SMALL)) for row in result.psi[1]])
    assert after / before == pytest.approx(factor, abs=0.006)


def test_locked_columns_meet_old_neighbours_again() -> None:
    sizes = np.array([chain(0.4, 0.7, 100_000, seed) for seed in range(2)])
    kept = {}
    for partners in ("permuted", "locked"):
        column = column_of(sizes, partners=partners)
        result = column.run(time=[0.0, 30.0], stress_ratio=0.0, mixing=mixing_of(0.3, 1.0, 2), step=1.0)
        kept[partners] = np.mean([alike(np.where(np.exp(row) > 1.5, LARGE, SMALL)) for row in result.psi[1]])
    assert abs(kept["permuted"]) < 0.01
    assert kept["locked"] > 0.3  # half of the pairs lie as they lay, or both their cells on the other side


def steady(share: float, drift: float) -> Callable[[int], Floats]:
    """Profile of two sizes with no flux through any bond, to which ever shorter exchanges lead.

    `drift` is k_s dz / D: k_s (L - S) phi_z (1 - phi_{z+1}) / mean = D (phi_{z+1} - phi_z) / dz at each bond.
    """

    def profile(rows: int, lowest: float) -> Floats:
        found = [lowest]
        for _ in range(rows - 1):
            below, above = found[-1], found[-1]
            for _ in range(200):
                mean = SMALL + (LARGE - SMALL) * 0.5 * (below + above)
                pull = drift / rows * (LARGE - SMALL) / mean * below
                above = (below + pull) / (1.0 + pull)
            found.append(above)
        return np.array(found)

    def solved(rows: int) -> Floats:
        low, high = 1e-9, 1.0 - 1e-9
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if profile(rows, middle).mean() < share else (low, middle)
        return profile(rows, low)

    return solved


def test_the_discrete_steady_profile_leads_to_the_exact_one() -> None:
    drift, alpha = 5.0, LARGE / SMALL - 1.0
    fine = steady(0.5, drift)(400)
    z = (np.arange(400) + 0.5) / 400
    # phi / (1 - phi)**(1 + alpha) = exp(K / D (z - z_0)), K = k_s alpha
    law = np.log(fine) - (1.0 + alpha) * np.log1p(-fine) - drift * alpha * z
    assert np.ptp(law) < 0.05


@pytest.mark.parametrize("drift", [5.0, 10.0])
def test_the_steady_profile_of_two_sizes(drift: float) -> None:
    rows, cells, diffusivity = 12, 6000, 1e-2
    sizes = two_sizes(0.5, rows, cells)
    expected = steady(float((sizes == LARGE).mean()), drift)(rows)
    errors = []
    for limit in (0.2, 0.05):
        column = column_of(sizes, largest_mixing=limit, largest_segregation=1.0)
        times = [0.0, *np.arange(60.0, 160.0, 10.0)]
        result = column.run(time=times, stress_ratio=0.0, mixing=diffusivity, segregation=drift * diffusivity)
        found = (np.exp(result.psi[1:]) > 1.5).mean(axis=(0, 2))
        errors.append(found - expected)
    assert np.abs(errors[1]).mean() < 0.6 * np.abs(errors[0]).mean()  # of first order in the probability
    at_once = (errors[1] * 4.0 - errors[0]) / 3.0  # Richardson
    assert np.abs(at_once).mean() < 0.008


def test_crushing_by_size_alone_and_mixing_commute_with_nothing_but_the_bottom() -> None:
    grains = cm.Material(fabric_width=np.inf, fragments=UNIFORM)
    loads = np.exp([2.0, 1.6, 1.2, 0.8, 0.4])
    column = cm.ColumnLattice(
        grains, cm.monodisperse(1.0), height=5.0, cells=5, cells_per_row=40_000, largest_mixing=0.5
    )
    still = column.run(time=[0.0], stress_ratio=loads)
    at = np.linspace(0.02, 1.0, 40)
    for row, load in enumerate(loads):
        assert np.abs(still.cdf_at(at)[0, row] - np.minimum(at * load, 1.0)).max() < 0.01  # U(0, s_c)
        assert still.crushes[0, row] == pytest.approx(1.0 + math.log(load), abs=0.03)
    mixed = column.run(time=[0.0, 200.0], stress_ratio=loads, mixing=0.5)
    at = np.linspace(0.02, 1.0, 40) * math.exp(-2.0)
    for row in range(5):
        assert np.abs(mixed.cdf_at(at)[1, row] - at * math.exp(2.0)).max() < 0.012
    counts = column.crushes.astype(np.int64) - 1  # 1 + Poisson(ln(s_max / s_c))
    assert counts.mean() == pytest.approx(2.0, abs=0.02)
    assert counts.var() == pytest.approx(2.0, abs=0.05)


def test_a_finite_rate_leaves_survivors() -> None:
    grains = cm.Material(fabric_width=np.inf, fragments=UNIFORM)
    column = cm.ColumnLattice(grains, cm.monodisperse(1.0), height=1.0, cells=2, cells_per_row=100_000)
    result = column.run(time=[0.0, 1.0, 3.0], stress_ratio=[8.0, 0.0], shear_rate=[0.5, 2.0], crush_rate=0.8)
    survived = (result.psi == 0.0).mean(axis=2)
    assert survived[0].tolist() == [1.0, 1.0]
    assert survived[1, 0] == pytest.approx(math.exp(-0.8 * 0.5), abs=0.006)
    assert survived[2, 0] == pytest.approx(math.exp(-0.8 * 0.5 * 3.0), abs=0.006)
    assert survived[2, 1] == 1.0  # under no load


SWAPPED = 0.0125  # share of the cells
LOAD = 8.0


def crushes_a_swap(column: cm.ColumnLattice, rows: int, crush_rate: float = math.inf) -> float:
    """Load to 8, exchange once, and count the crushes of each swapped cell."""
    column._core.load_to([LOAD] * rows)
    mixing = mixing_of(SWAPPED, column.height, rows)
    _, swaps, crushes, _ = column._core.advance(1.0, [1.0] * rows, mixing, 0.0, 0.0, crush_rate)
    return crushes / (2.0 * swaps)


def test_a_large_rate_is_random_order() -> None:
    options: dict[str, Any] = {"height": 1.0, "cells": 2, "cells_per_row": 400_000, "largest_mixing": 1.0}
    material, one_size = cm.Material(fabric_width=0.2), cm.monodisperse(1.0)
    columns = [cm.ColumnLattice(material, one_size, seed=seed, **options) for seed in range(8)]
    rates = [math.inf] * 4 + [1e5] * 4
    found = [crushes_a_swap(column, 2, rate) for column, rate in zip(columns, rates, strict=True)]
    at_once, by_rate = np.array(found[:4]), np.array(found[4:])
    scatter = math.hypot(float(at_once.std(ddof=1)), float(by_rate.std(ddof=1))) / 2.0
    assert by_rate.mean() == pytest.approx(at_once.mean(), abs=4.0 * scatter)
    assert 4.0 * scatter < 0.12 * at_once.mean()  # weakest first would be 14 % less


@pytest.mark.parametrize(
    ("width", "order", "expected"),
    [(0.05, "random", 0.3545), (0.05, "weakest", 0.3498), (0.2, "random", 0.6472), (0.2, "weakest", 0.5588)],
)
def test_crushes_of_swapped_cells(width: float, order: Any, expected: float) -> None:
    # numbers of another lattice; a standard error of 0.0025 each by the scatter of seeds
    material, one_size = cm.Material(fabric_width=width), cm.monodisperse(1.0)
    options: dict[str, Any] = {"height": 1.0, "cells": 4, "cells_per_row": 400_000, "largest_mixing": 1.0}
    found = [
        crushes_a_swap(cm.ColumnLattice(material, one_size, order=order, seed=seed, **options), 4) for seed in range(4)
    ]
    assert np.mean(found) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("weakest", [False, True])
@pytest.mark.parametrize("width", [0.05, 0.2])
def test_an_exchange_is_that_of_the_rules_cell_by_cell(width: float, weakest: bool) -> None:
    cells, material = 400_000, cm.Material(fabric_width=width, fragments=UNIFORM)
    expected, found = [], []
    for seed in range(4):
        column = cm.ColumnLattice(
            material,
            cm.monodisperse(1.0),
            height=1.0,
            cells=2,
            cells_per_row=cells,
            largest_mixing=1.0,
            order="weakest" if weakest else "random",
            seed=seed,
        )
        rings = cm.Lattice(cells, material, cm.monodisperse(1.0), replicas=2, seed=seed)
        rings.load_to(LOAD)
        rows = np.exp(rings.psi[0]), np.exp(rings.psi[1])
        random = np.random.default_rng(seed)
        touched = exchange(rows, SWAPPED, random)
        options: dict[str, Any] = {"fabric_width": width, "weibull_modulus": 3.0, "random": random, "weakest": weakest}
        crushes = [settle(row, places, math.log(LOAD), **options) for row, places in zip(rows, touched, strict=True)]
        expected.append(sum(crushes) / (2.0 * len(touched[0])))
        found.append(crushes_a_swap(column, 2))
    scatter = math.hypot(float(np.std(expected, ddof=1)), float(np.std(found, ddof=1))) / math.sqrt(len(found))
    assert scatter < 0.02 * np.mean(found)
    assert np.mean(found) == pytest.approx(np.mean(expected), abs=4.0 * scatter)


def test_threads_and_breaks_change_no_bit() -> None:
    def driven(threads: int) -> cm.ColumnLattice:
        return cm.ColumnLattice(
            cm.Material(fabric_width=0.1),
            cm.monodisperse(1.0).with_unit("mm"),
            height=0.02,
            cells=7,
            cells_per_row=3000,
            threads=threads,
        )

    options: dict[str, Any] = {
        "stress_ratio": lambda z, t: 1.0 + 300.0 * t * (0.02 - z),
        "mixing": cm.ShearMixing(2.0),
        "segregation": 1e-4,
        "step": 0.5,
    }
    one, two = driven(1), driven(3)
    whole = one.run(time=[0.0, 1.0, 2.0, 3.0], **options)
    assert whole == two.run(time=[0.0, 1.0, 2.0, 3.0], **options)
    broken = driven(2)
    broken.run(time=[0.0, 1.0], **options)
    broken = pickle.loads(pickle.dumps(broken))
    rest = broken.run(time=[1.0, 2.0, 3.0], **options)
    assert np.array_equal(rest.psi[1:], whole.psi[2:])


def test_probabilities_are_never_cut() -> None:
    wide = cm.power_law(2.5, 1e-3, 1.0)  # a mean far below the largest grain
    column = cm.ColumnLattice(cm.Material(), wide, height=0.01, cells=5, cells_per_row=2000)
    report = column._core
    report.load_to([0.0] * 5)
    exchanges, swaps, _, largest = report.advance(1.0, [1.0] * 5, 1e-5, 0.0, 1e-3, math.inf)
    assert largest <= 0.1 / 1.1 + 0.25 / 1.125 + 1e-12
    assert exchanges > 1
    assert 0 < swaps <= exchanges * 4 * 2000


def test_shear_mixing_goes_with_the_square_of_the_size() -> None:
    rows, cells, seconds = 31, 3000, 4.0
    spread = []
    for size, unit in ((1.0, "m"), (2.0, "m"), (1000.0, "mm")):
        sizes = np.full((rows, cells), size)
        sizes[15] = size * (1.0 + 1e-9)
        column = cm.ColumnLattice.from_sizes(sizes, cm.Material(), height=1.0, unit=unit, largest_mixing=0.2)
        result = column.run(
            time=[0.0, seconds], stress_ratio=0.0, shear_rate=0.5, mixing=cm.ShearMixing(1e-4), step=0.25
        )
        tagged = (result.psi[1] > math.log(size) + 5e-10).mean(axis=1)
        spread.append(float(tagged @ (result.z - result.z[15]) ** 2))
    assert spread[0] == pytest.approx(2.0 * 1e-4 * 0.5 * seconds, rel=0.15)
    assert spread[1] / spread[0] == pytest.approx(4.0, rel=0.2)
    assert spread[2] == pytest.approx(spread[0], rel=0.2)


def test_loads_as_a_callable_a_table_and_numbers() -> None:
    def run(stress_ratio: Any) -> cm.ColumnLatticeResult:
        column = cm.ColumnLattice(cm.Material(), cm.monodisperse(1.0), height=1.0, cells=2, cells_per_row=500)
        return column.run(time=[0.0, 1.0], stress_ratio=stress_ratio, step=0.5)

    table = run(np.array([[1.0, 2.0], [5.0, 4.0]]))
    assert table == run(lambda z, t: np.array([1.0 + 4.0 * t, 2.0 + 2.0 * t]))
    assert run(3.0) == run([3.0, 3.0])
    strong = cm.Material(first_crush_stress=2.0)
    stressed = cm.ColumnLattice(strong, cm.monodisperse(1.0), height=1.0, cells=2, cells_per_row=500)
    by_stress = stressed.run(time=[0.0, 1.0], stress=[6.0, 6.0], step=0.5)
    assert np.array_equal(by_stress.psi, run(3.0).psi)
    assert table.stress_ratio.tolist() == [[1.0, 2.0], [5.0, 4.0]]


def test_what_a_result_says() -> None:
    pytest.importorskip("matplotlib")
    sand = cm.power_law(2.3, 0.02, 2.0).with_unit("mm")
    material = cm.Material(reference_size=2.0, fabric_width=0.3)
    column = cm.ColumnLattice(material, sand, height=0.05, cells=4, cells_per_row=4000)
    result = column.run(time=[0.0, 1.0], stress_ratio=[50.0, 20.0, 5.0, 1.0])
    assert result.pmf.sum(axis=2) == pytest.approx(1.0, abs=1e-12)
    direct = (np.exp(result.psi[0, 1])[:, None] <= result.edge_size[None, :] * (1.0 + 1e-11)).mean(axis=0)
    assert np.array_equal(result.cdf[0, 1], direct)
    sizes = np.exp(result.psi[0, 0])
    d50 = result.percentile(50)[0, 0]
    assert (sizes <= d50).mean() >= 0.5 > (sizes < d50).mean()
    assert np.all(np.diff(result.percentile(50)[0]) > 0.0)
    assert result.mean_size[0, 0] == pytest.approx(sizes.mean(), rel=1e-14)
    figure = result.plot()
    assert figure.axes[0].get_xlabel() == "time (s)"
    assert "D50" in figure.axes[1].get_xlabel()
    with pytest.raises(cm.ParameterError, match="percent is 101"):
        result.percentile(101)


COLUMN = {"height": 1.0, "cells": 2, "cells_per_row": 50}
REFUSED: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"height": 0.0}, {}, "height is 0"),
    ({"cells": 1}, {}, "rows is 1"),
    ({"cells_per_row": 1}, {}, "cells is 1"),
    ({"partners": "other"}, {}, "partners is 'other'"),
    ({"order": "first"}, {}, "order is 'first'"),
    ({"rates": "x"}, {}, "rates is 'x'"),
    ({"largest_mixing": 1.5}, {}, "largest_mixing is 1.5"),
    ({"largest_segregation": 0.0}, {}, "largest_segregation is 0"),
    ({"threads": 0}, {}, "threads is 0"),
    ({"material": cm.Material(strength_scatter=True)}, {}, "strength"),
    ({"start": [cm.monodisperse(1.0)] * 3}, {}, "has 3 gradings; it must have one for each of the 2 rows"),
    ({}, {"time": [1.0, 0.0]}, "time must rise"),
    ({}, {"stress_ratio": [1.0, 2.0, 3.0]}, "stress_ratio has shape"),
    ({}, {"stress_ratio": -1.0}, "stress_ratio"),
    ({}, {"shear_rate": -1.0}, "shear_rate is -1"),
    ({}, {"mixing": -1.0}, "mixing is -1"),
    ({}, {"segregation": -1.0}, "segregation is -1"),
    ({}, {"crush_rate": -1.0}, "crush_rate is -1"),
    ({}, {"step": 0.0}, "step is 0"),
    ({}, {"stress": 2.0}, "give one kind of load"),
    ({}, {"stress_ratio": None}, "give one kind of load"),
    ({}, {"stress_ratio": None, "stress": 2.0}, "first_crush_stress"),
]


@pytest.mark.parametrize(("made", "run", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_is_refused(made: dict[str, Any], run: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"material": cm.Material(), "start": cm.monodisperse(1.0)} | COLUMN | made
    driven: dict[str, Any] = {"time": [0.0, 1.0], "stress_ratio": 1.0} | run
    with pytest.raises(cm.ParameterError, match=message):
        cm.ColumnLattice(**given).run(**driven)


def test_a_factor_of_shear_mixing_is_checked() -> None:
    with pytest.raises(cm.ParameterError, match="factor is -1"):
        cm.ShearMixing(-1.0)

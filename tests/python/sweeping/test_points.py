"""Exact sizes: atoms, ridges, what they crush to, and what is left of them."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import comminute as cm
import reference as ref
import reference_points as rp
from reference import Array, Law, Weibull
from reference_quasi_static import LogNormal, Tabulated
from strategies import Fragments, every_law, log_uniform, random_state

LN055, LN01 = math.log(0.55), math.log(0.1)
MONO = [rp.Atom(0.0, 0.0, 1.0)]
GAP = [  # ratio 10, half by mass, arithmetic means of two neighbours
    rp.Atom(psi, psibar, 0.5 * share)
    for psi in (0.0, LN01)
    for psibar, share in ((0.0, 0.25), (LN055, 0.5), (LN01, 0.25))
]
AXES: tuple[rp.Axis, ...] = ("grain", "neighbour")
LAWS: dict[str, tuple[Fragments, Law]] = {
    "eq 4": (cm.WeibullFragments(), Weibull()),
    "lognormal": (cm.LogNormalFragments(-0.8, 0.4), LogNormal(-0.8, 0.4)),
    "table": (cm.TabulatedFragments([0.1, 0.4, 1.0], [0.0, 0.7, 1.0]), Tabulated((0.1, 0.4, 1.0), (0.0, 0.7, 1.0))),
}


def mass_of(fabric: cm.Fabric) -> float:
    exact = [atom.mass for atom in fabric.atoms] + [float(ridge.mass.sum()) for ridge in fabric.ridges]
    return math.fsum([*fabric.probability.ravel(), *exact])


def ridges_of(fabric: cm.Fabric) -> dict[tuple[str, float], Array]:
    return {(ridge.exact, ridge.at): ridge.mass for ridge in fabric.ridges}


def assert_same(a: cm.Fabric, b: cm.Fabric, atol: float) -> None:
    np.testing.assert_allclose(a.probability, b.probability, rtol=0.0, atol=atol)
    assert a.atoms == b.atoms
    mine, theirs = ridges_of(a), ridges_of(b)
    for place in mine.keys() | theirs.keys():
        nothing = np.zeros(a.grid.bins)
        np.testing.assert_allclose(mine.get(place, nothing), theirs.get(place, nothing), rtol=0.0, atol=atol)


# --- against the reference ----------------------------------------------------------------------------------


def compare(
    bins: int, model: ref.Model, fragments: Fragments, load: float, rate: float, atoms: Sequence[rp.Atom], spread: float
) -> tuple[float, float]:
    """Largest differences of the cdf and of the crushes from the reference, whose lines are cut forty times finer."""
    grid, psi = cm.LogGrid(-6.0, 0.5, bins), ref.centres(-6.0, 0.5, bins)
    material = cm.Material(
        weibull_modulus=model.weibull_modulus,
        fabric_width=model.fabric_width,
        reference_size=model.reference_size,
        fragments=fragments,
    )
    atoms = [rp.Atom(a, b, (1.0 - spread) * mass) for a, b, mass in atoms]
    p = np.zeros((bins, bins))
    lines, ridges = [], []
    if spread > 0.0:
        band = np.exp(-(((psi + 1.0) / 0.5) ** 2))
        p, of_line = 0.4 * spread * np.outer(band, band) / band.sum() ** 2, 0.3 * spread * band / band.sum()
        for exact in AXES:
            lines.append(rp.even_line(exact, -0.7, of_line, 40))
            own = grid.bin_of(-0.7)
            above = float(of_line[own]) * (grid.edges[own + 1] + 0.7) / grid.spacing
            ridges.append(cm.Ridge(exact, -0.7, of_line, above))
    solver = cm.QuasiStatic(grid, material, loading_rate=rate)
    found = solver.solve(cm.Fabric(grid, p, atoms, ridges=ridges), load)
    expected = rp.settle_points(p, list(atoms), lines, psi, model, load, None, rate, 40)
    assert mass_of(found) == pytest.approx(1.0, abs=1e-14)
    assert [tuple(atom) for atom in found.atoms] == [tuple(atom) for atom in expected.atoms]
    cdf = np.cumsum(found.grainsize() - rp.grainsize(expected, psi))
    np.testing.assert_allclose(
        solver.marginal(cm.Fabric(grid, p, atoms, ridges=ridges), load), found.grainsize(), atol=1e-15
    )
    crushes = abs(solver.report.crushed - expected.crushed) + abs(
        solver.report.crushed_neighbour - expected.crushed_neighbour
    )
    return float(np.abs(cdf).max()), crushes


@pytest.mark.parametrize("start", ["mono", "gap", "gap and spread"])
@pytest.mark.parametrize("rate", [0.0, 0.3])
@pytest.mark.parametrize(
    ("n", "load", "law"),
    [(0.05, 1.5, "eq 4"), (0.05, 30.0, "eq 4"), (0.3, 1.5, "lognormal"), (1.0, 8.0, "table"), (5.0, 1.5, "eq 4")],
)
def test_lines_settle_where_lines_cut_ever_finer_do(n: float, load: float, law: str, rate: float, start: str) -> None:
    fragments, reference_law = LAWS[law]
    model = ref.Model(3.0, n, 1.0, reference_law)
    for bins, tolerance in ((27, 8e-3), (53, 2.5e-3)):  # 0.12 h^2, and what the reference's own cuts are worth
        cdf, crushes = compare(
            bins, model, fragments, load, rate, MONO if start == "mono" else GAP, 0.5 if "spread" in start else 0.0
        )
        assert cdf < tolerance
        assert crushes < 4.0 * tolerance


@pytest.mark.parametrize("start", [MONO, GAP], ids=["mono", "gap"])
@pytest.mark.parametrize(("load", "rate"), [(1.0, 0.0), (1.0, 0.3), (1.0, 1.0), (30.0, 1.0), (0.99, 0.0)])
def test_where_no_line_crushes_the_reference_is_met_to_rounding(start: list[rp.Atom], load: float, rate: float) -> None:
    for n in (0.05, 1.0):
        for fragments, law in LAWS.values():
            cdf, crushes = compare(27, ref.Model(3.0, n, 1.0, law), fragments, load, rate, start, 0.0)
            assert cdf < 1e-14
            assert crushes < 1e-13


# --- paths --------------------------------------------------------------------------------------------------


@st.composite
def fabrics(draw: st.DrawFn) -> tuple[cm.Fabric, cm.Material]:
    """Bins, atoms and ridges at random places, equal sizes and sizes on edges and centres among them."""
    bins, top = draw(st.integers(8, 40)), draw(st.floats(-0.5, 1.0))
    grid = cm.LogGrid(top - draw(st.floats(1.0, 8.0)), top, bins)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    places = rng.uniform(grid.edges[1], grid.edges[-1], 4)
    places = np.concatenate([places, rng.choice(grid.centres[1:], 2), rng.choice(grid.edges[1:-1], 1)])
    share = rng.dirichlet(np.ones(3)) if draw(st.booleans()) else np.array([0.0, 1.0, 0.0])
    atoms = [
        cm.Atom(float(rng.choice(places)), float(rng.choice(places)), float(mass))
        for mass in share[1] * rng.dirichlet(np.ones(6))
    ]
    ridges = []
    for part in share[2] * rng.dirichlet(np.ones(3)):
        mass, at = part * rng.dirichlet(np.full(bins, 0.3)), float(rng.choice(places))
        exact: Literal["grain", "neighbour"] = "grain" if rng.random() < 0.5 else "neighbour"
        ridges.append(cm.Ridge(exact, at, mass, float(mass[grid.bin_of(at)] * rng.random())))
    p = share[0] * random_state(draw(st.integers(0, 2**32 - 1)), bins) / 2.0
    material = cm.Material(
        weibull_modulus=draw(log_uniform(0.5, 12.0)),
        fabric_width=draw(log_uniform(0.02, 30.0) | st.just(math.inf)),
        reference_size=draw(log_uniform(0.3, 3.0)),
        fragments=draw(every_law())[0],
    )
    return cm.Fabric(grid, p, atoms, ridges=ridges), material


@settings(max_examples=150)
@given(case=fabrics(), last=log_uniform(0.2, 1e4), steps=st.integers(1, 30), rate=st.sampled_from([0.0, 0.0, 0.4, 1.0]))
def test_stepping_is_one_solve(case: tuple[cm.Fabric, cm.Material], last: float, steps: int, rate: float) -> None:
    start, material = case
    assume(rate == 0.0 or start.grid.bins <= 25)
    solver = cm.QuasiStatic(start.grid, material, loading_rate=rate)
    once, report = solver.solve(start, last), solver.report
    scale = max(1.0, 0.1 * (report.crushed + report.crushed_neighbour))
    loads = [*(last * np.exp(-np.random.default_rng(steps).exponential(1.5, steps))), last]
    fabric, crushed, crushed_neighbour, cdf = start, 0.0, 0.0, start.cdf()
    for load in loads:
        marginal = solver.marginal(fabric, float(load))
        fabric = solver.solve(fabric, float(load))
        np.testing.assert_allclose(marginal, fabric.grainsize(), rtol=0.0, atol=1e-14 * scale)
        assert mass_of(fabric) == pytest.approx(1.0, abs=2e-14 * scale)
        assert (fabric.cdf() >= cdf - 2e-14 * scale).all()
        crushed, crushed_neighbour = (
            crushed + solver.report.crushed,
            crushed_neighbour + solver.report.crushed_neighbour,
        )
        cdf = fabric.cdf()
    assert_same(fabric, once, 1e-14 * scale)
    assert (crushed, crushed_neighbour) == pytest.approx((report.crushed, report.crushed_neighbour), abs=5e-14 * scale)
    assert fabric.settled_at == once.settled_at == last
    assert min(ridge.mass.min() for ridge in [*once.ridges, cm.Ridge("grain", 0.0, np.zeros(1))]) >= 0.0
    for ridge in once.ridges:
        assert 0.0 <= ridge.above <= ridge.mass[start.grid.bin_of(ridge.at)] * (1.0 + 1e-15)
    assert once.probability.min() >= 0.0
    rebuilt = cm.Fabric(once.grid, once.probability, once.atoms, settled_at=last, mean=once.mean, ridges=once.ridges)
    assert rebuilt == once


@given(case=fabrics(), load=log_uniform(0.2, 1e4))
def test_remixing_twice_is_remixing_once(case: tuple[cm.Fabric, cm.Material], load: float) -> None:
    start, material = case
    mixed = cm.remix(cm.QuasiStatic(start.grid, material).solve(start, load))
    assert cm.remix(mixed) == mixed
    assert mixed.settled_at is None
    assert mass_of(mixed) == pytest.approx(1.0, abs=1e-13)


# --- exact answers ------------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:bins are .* wide")  # 20 bins are few on purpose
@pytest.mark.parametrize("bins", [20, 127, 128, 501])
@pytest.mark.parametrize("size", [1.0, 0.8, 2.5])
def test_equal_grains_at_their_threshold(bins: int, size: float) -> None:
    # The reference size is that of the grains: half crush at exactly 1, whatever the grid and the place in the bin.
    grid, law = cm.LogGrid(-5.0, 1.0, bins), cm.WeibullFragments()
    start = cm.mixed_fabric(cm.monodisperse(size), grid)
    sim = cm.Simulation(cm.Material(reference_size=size), start)
    result = sim.run(stress_ratio=[1.0 - 1e-9, 1.0])
    assert result.crushes.tolist() == [0.0, 0.5]
    below = grid.edges[1:] < math.log(size)
    expected = np.where(below, 0.5 * law.cdf(np.minimum(grid.edges[1:] - math.log(size), 0.0)), 1.0)
    np.testing.assert_allclose(result.cdf[1], expected, rtol=0.0, atol=1e-15)
    for percent in (60.0, 75.0, 90.0):  # where the cdf jumps
        assert result.percentile(percent).tolist() == [size, size]
    assert result.percentile(30.0)[1] < size
    [point] = result.fabric(1).points
    assert point.psi == pytest.approx(math.log(size))
    assert point.mass == 0.5


def test_percentile_of_equal_grains_of_size_one_is_exactly_one() -> None:
    result = cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1.0)
    assert result.percentile(60) == 1.0


@pytest.mark.parametrize("load", [1.001, 1.2, 2.0, 100.0])
def test_the_error_from_equal_grains_does_not_grow_where_the_zone_is_narrow(load: float) -> None:
    material, at = cm.Material(), np.linspace(-3.0, 0.0, 13)[:-1]

    def cdf(bins: int, points: Literal["exact", "binned"] = "exact") -> Array:
        grid = cm.LogGrid(-6.0 + 3.0 / (bins - 1), 3.0 / (bins - 1), bins)  # edges on multiples of 6 / (bins - 1)
        start = cm.mixed_fabric(cm.monodisperse(1.0), grid, points=points)
        finer = cm.QuasiStatic(grid, material).solve(start, load).cdf()
        assert np.abs(np.interp(at, grid.edges[1:], grid.edges[1:]) - at).max() < 1e-12
        return np.interp(at, grid.edges[1:], finer)

    exact = cdf(2305)
    for bins, tolerance in ((73, 2e-3), (145, 1e-3), (289, 3e-4)):
        assert np.abs(cdf(bins) - exact).max() < tolerance
    if load == 1.001:
        assert np.abs(cdf(145, "binned") - exact).max() > 0.2


@pytest.mark.parametrize("mean", ["arithmetic", "geometric"])
def test_exact_sizes_among_the_fines_are_neighbours_too(mean: Literal["arithmetic", "geometric"]) -> None:
    grid = cm.LogGrid(-4.0, 0.0, 41)
    assert cm.mixed_fabric(cm.monodisperse(1e-9), grid, mean=mean).probability[0, 0] == 1.0
    for coarse in (1.0, math.exp(-1.0)):  # at the centre of a bin
        gap = cm.gap_graded(coarse, 1e-9)
        found, binned = (cm.mixed_fabric(gap, grid, mean=mean, points=points) for points in ("exact", "binned"))
        np.testing.assert_allclose(found.neighbourhood(), binned.neighbourhood(), rtol=0.0, atol=1e-15)
        assert found.neighbourhood()[0] == pytest.approx(0.25)


@pytest.mark.parametrize("load", [1.0, 1.001])
def test_equal_grains_spread_over_a_bin_wider_than_the_zone_hardly_crush(load: float) -> None:
    def error(bins: int, points: Literal["exact", "binned"]) -> float:
        grid = cm.LogGrid(-6.0, 1.0, bins)
        start = cm.mixed_fabric(cm.monodisperse(1.0), grid, points=points)
        finer = cm.QuasiStatic(grid, cm.Material()).solve(start, load).cdf()
        below = grid.edges[1:][grid.edges[1:] < -1e-9]
        return float(np.abs(finer[: below.size] - 0.5 * cm.WeibullFragments().cdf(below)).max())

    # At 1.001 the coarsest fragments crush again; they are less than a thousandth of the mass.
    for bins in (33, 127, 500, 1001):
        assert error(bins, "exact") < 1e-15 + (load - 1.0)
    assert 0.40 < error(127, "binned") < 0.45
    assert error(1001, "binned") > 0.2


@pytest.mark.parametrize("mean", ["arithmetic", "geometric"])
def test_a_gap_graded_packing_load_by_load(mean: Literal["arithmetic", "geometric"]) -> None:
    grid, material = cm.LogGrid(-8.0, 0.5, 300), cm.Material(fabric_width=0.3)
    start = cm.mixed_fabric(cm.gap_graded(1.0, 0.1, 0.3), grid, mean=mean)
    between = LN055 if mean == "arithmetic" else 0.5 * LN01
    share = {(0.0, 0.0): 0.3**3, (0.0, between): 0.3 * 2 * 0.3 * 0.7, (0.0, LN01): 0.3 * 0.49}
    share |= {(LN01, 0.0): 0.7 * 0.09, (LN01, between): 0.7 * 2 * 0.3 * 0.7, (LN01, LN01): 0.7**3}
    assert len(start.atoms) == 6
    for atom in start.atoms:
        [mass] = [m for place, m in share.items() if place == pytest.approx((atom.psi, atom.psibar), abs=1e-12)]
        assert atom.mass == pytest.approx(mass, abs=1e-15)
    # Equal coarse grains first, half of them in psi; then those beside one coarse and one fine grain, by Eq. (2).
    solver = cm.QuasiStatic(grid, material)
    solver.solve(start, 1.0)
    assert solver.report.crushed == pytest.approx(0.5 * 0.3**3, abs=1e-16)
    for atom in start.atoms:
        larger, smaller = max(atom.psi, atom.psibar), min(atom.psi, atom.psibar)
        critical = cm.critical_stress_ratio(material, math.exp(larger), math.exp(smaller))
        assert atom in solver.solve(start, critical * (1.0 - 1e-9)).atoms
        assert atom not in solver.solve(start, critical * (1.0 + 1e-9)).atoms
    assert [point.psi for point in solver.solve(start, 1.0).points] == [pytest.approx(LN01), 0.0]


@pytest.mark.parametrize(
    "start", [cm.monodisperse(1.0), cm.gap_graded(1.0, 0.07, 0.4), cm.power_law(2.5, 1e-2, 1.0)], ids=repr
)
@pytest.mark.parametrize("mean", ["arithmetic", "geometric"])
def test_mixed_fabrics_are_mixed(start: cm.Grading, mean: Literal["arithmetic", "geometric"]) -> None:
    grid = cm.LogGrid(-9.0, 0.4, 160)
    for points in ("exact", "binned"):
        fabric = cm.mixed_fabric(start, grid, mean=mean, points=points)
        assert cm.remix(fabric) == fabric
    crushed = cm.QuasiStatic(grid, cm.Material()).solve(cm.mixed_fabric(start, grid, mean=mean), 20.0)
    again = cm.remix(crushed)
    assert cm.remix(again) == again
    np.testing.assert_allclose(again.grainsize(), crushed.grainsize(), rtol=0.0, atol=1e-15)
    assert again.points == crushed.points

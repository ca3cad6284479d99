"""Results and the other objects as things: files, pickles, equality, text, plots, optional libraries."""

import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

import comminute as cm
from comminute import plotting

GRID = cm.LogGrid(-6.0, 0.5, 131)
MATERIAL = cm.Material(fabric_width=0.2, fragments=cm.PowerLawFragments(1.5), first_crush_stress=2.0)


@pytest.fixture(scope="module")
def result() -> cm.Result:
    sand = cm.Grading.from_sieves([1.5, 1.0, 0.5, 0.2], [100, 60, 20, 3], unit="mm")
    return cm.Simulation(MATERIAL, sand).run(stress_ratio=[1.0, 8.0])


SAND = cm.Grading.from_sieves([1.5, 1.0, 0.5, 0.2], [100, 60, 20, 3], unit="mm")
RUN = cm.Simulation(MATERIAL, cm.gap_graded(1.0, 0.2), grid=GRID).run(stress_ratio=[1.0, 8.0])
RINGS = cm.Lattice(50, MATERIAL, cm.gap_graded(1.0, 0.2))
RINGS_RUN = RINGS.run(stress_ratio=[1.0, 8.0], grid=GRID)

FITTED = cm.fit([(9.0, SAND)], cm.power_law(2.0, 0.3, 1.5), MATERIAL, ["fabric_width"], starts=1)
SWEPT = cm.sweep(
    {"grading": {"kind": "monodisperse", "size": 1.0}, "load": {"stress_ratio": 8.0}},
    {"material.fabric_width": [0.05, -1.0]},
    store=Path(tempfile.mkdtemp()) / "sweep.zarr",
)
COLUMN = cm.ColumnLattice(MATERIAL, cm.gap_graded(1.0, 0.2), height=1.0, cells=2, cells_per_row=50)
LAWS = cm.Column(MATERIAL, cm.monodisperse(1.0), height=1.0, cells=2, neighbour_length=0.5)
THINGS = [
    GRID,
    MATERIAL,
    cm.Material(first_crush_stress=2.0, stress_measure="energy", poisson=0.2, k0=0.5),
    cm.StressMeasure("energy", poisson=0.2),
    cm.WeibullFragments(2.0, 0.5),
    cm.PowerLawFragments(2.0),
    cm.LogNormalFragments(-1.0, 0.3),
    cm.TabulatedFragments([0.2, 1.0], [0.1, 1.0]),
    cm.fuller(2.0),
    cm.lognormal(1.0, 0.3),
    cm.rosin_rammler(1.0, 1.5),
    cm.monodisperse(1.0),
    cm.gap_graded(1.0, 0.2, 0.3),
    cm.power_law(2.0, 0.1, 1.0),
    cm.Grading.from_sieves([1.0, 0.5, 0.2], [100, 10, 2], unit="mm"),
    cm.CrushZones(GRID, MATERIAL, 3.0),
    cm.SlowUpdate(GRID, MATERIAL, scheme="conservative"),
    cm.FullConvolution(GRID, MATERIAL, "blend", loading_rate=0.25, scheme="paper"),
    cm.mixed_fabric(cm.power_law(2.0, 0.1, 1.0), GRID, mean="geometric"),
    cm.Simulation(MATERIAL, cm.monodisperse(1.0), grid=GRID),
    RUN,
    RUN.recipe,
    RUN.reports[0],
    RUN.points[0][0],
    RUN.start.atoms[0],
    RUN.fabric(0).ridges[0],
    cm.QuasiStatic(GRID, MATERIAL, loading_rate=0.2),
    cm.QuasiStatic(GRID, MATERIAL).grading_after(RUN.start, 2.0),
    cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=2.0, engine="slow-update").reports[0],
    RINGS,
    RINGS_RUN,
    cm.TimeSteppedLattice(50, MATERIAL, cm.monodisperse(1.0)),
    cm.SmallRing(3, cm.LogGrid(-3.0, 0.0, 8), MATERIAL, scheme="paper"),
    cm.compare(RUN, RINGS_RUN),
    cm.SizeCurve.of(SAND),
    SAND.to_sieves([2.0, 1.0, 0.1]),
    cm.folk_ward(SAND),
    cm.breakage_index(cm.monodisperse(1.0), cm.fuller(1.0)),
    cm.fractal_dimension(cm.fuller(16.0), 0.1, 10.0),
    cm.milling(SAND, SAND),
    cm.ResolvedGrid.graded(0.05, -8.0, [0.0]),
    cm.Resolved(MATERIAL, cm.monodisperse(1.0)),
    cm.Simulation(MATERIAL, cm.monodisperse(1.0), closure="resolved", sizes=[0.5]).run(stress_ratio=2.0),
    cm.compare_closures(MATERIAL, cm.monodisperse(1.0), stress_ratio=2.0, cells=200),
    cm.ResponseTable(MATERIAL, SAND, GRID, 5.0, tolerance=0.01),
    cm.MaterialPoints(MATERIAL, SAND, 2, GRID),
    cm.ResponseFamily(MATERIAL, SAND, [0.0, 0.1], variable="loading_rate", grid=GRID, largest=2.0, refine=False),
    cm.Measurement(5.0, np.array([1.0, 0.5]), np.array([0.9, 0.5]), unit="mm"),
    cm.UnknownStart(0.5, 0.6, 2.0),
    cm.strength_slope([40.0, 20.0, 11.0], [1.0, 2.0, 4.0]),
    FITTED,
    RUN.load_table(["D50"]),
    FITTED.problem,
    SWEPT,
    COLUMN,
    COLUMN.run(time=[0.0, 1.0], stress_ratio=[4.0, 2.0], mixing=0.1),
    cm.ShearMixing(0.1),
    LAWS,
    LAWS.run(time=[0.0, 1.0], stress_ratio=[4.0, 2.0], mixing=0.1),
    cm.Feed(cm.fuller(2.0), 0.1),
    cm.fit_compression([10.0, 30.0], [0.6, 0.4], cm.lognormal(1.0, 0.2), cm.Material(), initial=0.7),
    cm.Zone(1),
]
FAULTS = [
    cm.ParameterError("a"),
    cm.ShapeError("b"),
    cm.UnavailableError("c"),
    cm.ResolutionWarning("d"),
    cm.EditedFileWarning("e"),
    cm.FitWarning("f"),
]


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: type(thing).__name__)
def test_everything_pickles_compares_and_prints(thing: object) -> None:
    again = pickle.loads(pickle.dumps(thing))
    assert again == thing
    assert again is not thing or isinstance(thing, cm.Zone)  # of an enum there is one of each
    assert thing != cm.LogGrid(-1.0, 1.0, 9)
    assert type(thing).__name__ in repr(thing)
    assert len(repr(thing)) < 400


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: type(fault).__name__)
def test_faults_pickle(fault: Exception) -> None:
    again = pickle.loads(pickle.dumps(fault))
    assert (type(again), again.args) == (type(fault), fault.args)


def test_an_interruption_takes_its_result_along() -> None:
    for stopped in (cm.Interrupted(RUN), cm.Interrupted(None)):
        again = pickle.loads(pickle.dumps(stopped))
        assert again.result == stopped.result
        assert again.args == stopped.args


def test_no_public_class_is_left_out() -> None:
    tried = {type(thing) for thing in (*THINGS, *FAULTS, cm.Interrupted(None))}
    assert {thing for thing in map(vars(cm).get, cm.__all__) if isinstance(thing, type)} <= tried


def test_a_number_more_or_less_is_another_result() -> None:
    table = SAND.to_sieves([2.0, 1.0])
    assert table != table._replace(percent_finer=table.percent_finer + 1.0)
    assert RUN.resume(stress_ratio=9.0) != RUN
    assert RUN != RINGS_RUN
    assert cm.SizeCurve.of(SAND) != cm.SizeCurve.of(SAND).in_unit("um")


def test_a_result_pickles_and_compares(result: cm.Result) -> None:
    again = pickle.loads(pickle.dumps(result))
    assert again == result
    assert repr(again) == repr(result)
    assert "2 loads up to 8" in repr(result)


def test_different_settings_are_different() -> None:
    assert cm.Material() != cm.Material(fabric_width=0.06)
    assert cm.power_law(2.0, 0.1, 1.0) != cm.power_law(2.1, 0.1, 1.0)
    assert cm.FullConvolution(GRID, MATERIAL, "exact") != cm.FullConvolution(GRID, MATERIAL, "fast")


def test_a_fabric_lends_its_numbers_read_only_and_stays_alive() -> None:
    view = cm.mixed_fabric(cm.power_law(2.0, 0.1, 1.0), GRID).probability
    assert view.sum() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="read-only"):
        view[0, 0] = 1.0


def test_save_keeps_every_array(result: cm.Result, tmp_path: Path) -> None:
    path = result.save(tmp_path / "run.npz")
    with np.load(path) as file:
        for name in ("stress_ratio", "stress", "psi", "size", "edge_size", "pmf", "cdf", "crushes", "fines"):
            np.testing.assert_array_equal(file[name], getattr(result, name))
        np.testing.assert_array_equal(file["fabric"], result.fabric(-1).probability)
        assert str(file["engine"]) == "quasi-static"
        assert str(file["unit"]) == "mm"
    assert [p.name for p in tmp_path.iterdir()] == ["run.npz"]


def test_save_refuses_other_endings_and_leaves_no_scraps(result: cm.Result, tmp_path: Path) -> None:
    with pytest.raises(cm.ParameterError, match=r"it must end in \.nc or \.npz"):
        result.save(tmp_path / "run.txt")
    assert list(tmp_path.iterdir()) == []


def test_to_xarray(result: cm.Result) -> None:
    data = result.to_xarray()
    assert data["cdf"].dims == ("load", "psi")
    np.testing.assert_array_equal(data["pmf"], result.pmf)
    np.testing.assert_array_equal(data.coords["stress"], result.stress)
    assert data.coords["size"].attrs["units"] == "mm"
    assert data.attrs["engine"] == "quasi-static"


def test_percentiles_of_a_result(result: cm.Result) -> None:
    d10, d60 = result.percentile(10), result.percentile(60)
    assert np.all(d10 < d60)
    for k in range(2):
        assert np.interp(np.log(d60[k]), np.log(result.edge_size), result.cdf[k]) == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("cdf", "words"),
    [
        (np.linspace(0.0, 2.0, 131), "the last cdf is 2; it must be 1"),
        (np.full(131, np.nan), "the last cdf is nan; it must be 1"),
        (np.linspace(1.0, 0.0, 131), "cdf[1] is 0.992308, less than 1 before it; a cdf cannot fall"),
    ],
)
def test_what_is_no_cdf_makes_no_curve(cdf: np.ndarray, words: str) -> None:
    with pytest.raises(cm.ParameterError) as refused:
        cm.SizeCurve.on_grid(GRID, cdf)
    assert words in str(refused.value)


def test_percentiles_in_the_fines_bin_are_refused_or_extrapolated() -> None:
    sim = cm.Simulation(cm.Material(), cm.power_law(2.0, 1e-4, 1.0), grid=cm.LogGrid(-4.0, 0.1, 83))
    with pytest.warns(cm.ResolutionWarning):
        result = sim.run(stress_ratio=0.5)
    with pytest.raises(cm.ParameterError, match="D1 lies in the fines bin"):
        result.percentile(1)
    # F ~ s below: a tenth of the share lies at a tenth of the size
    share = 100 * result.fines[0]
    ten, one = (result.percentile(q, extrapolate=True)[0] for q in (share / 2, share / 20))
    assert one == pytest.approx(ten / 10, rel=0.02)


def test_plot_draws_what_the_result_has(result: cm.Result) -> None:
    figure = result.plot()
    left, right = figure.axes[:2]
    curves = {line.get_label(): line for line in left.get_lines()}
    assert {name for name in curves if not str(name).startswith("_")} == {"start", "2", "16"}  # tails have no entry
    curve = result.curve(1)
    np.testing.assert_allclose(np.asarray(curves["16"].get_ydata()), 100 * curve.finer)
    np.testing.assert_allclose(np.asarray(curves["16"].get_xdata()), curve.size)
    np.testing.assert_allclose(curve.finer_than(result.edge_size[1:]), result.cdf[1, 1:], rtol=0.0, atol=1e-12)
    assert left.get_xlabel() == "grainsize (mm)"
    zone = right.get_lines()[0]
    larger, smaller = zone.get_data()
    critical = cm.critical_stress_ratio(MATERIAL, np.exp(larger), np.exp(smaller))
    np.testing.assert_allclose(critical, 8.0, rtol=1e-6)


def test_plots_take_an_axes_and_return_it(result: cm.Result) -> None:
    ax = result.plot().axes[0]
    assert plotting.plot_curves(result, ax) is ax
    assert plotting.plot_fabric(result.start).get_xlabel()


@pytest.mark.parametrize(
    ("library", "call", "extra"),
    [("matplotlib", "plot()", "plot"), ("xarray", "to_xarray()", "io")],
)
def test_a_missing_library_is_named_with_its_extra(library: str, call: str, extra: str) -> None:
    script = (
        f"import sys; sys.modules['{library}'] = None\n"
        "import comminute as cm\n"
        "result = cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1)\n"
        f"try: result.{call}\n"
        "except ImportError as error: print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == (f"{call[:-2]} needs {library}; install it with: pip install 'comminute[{extra}]'")

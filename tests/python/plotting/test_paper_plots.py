"""The paper's plots show what was computed, say what they show, and open no window."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import comminute as cm
from comminute import plotting
from comminute.plotting.paper import zone_edge

GALLERY = Path(__file__).parents[3] / "docs" / "gallery"
MATERIAL = cm.Material()
WIDE = cm.Material(fabric_width=1.2)
LOADS = [1.0, 8.0, 1e3]
GRID = cm.LogGrid(-8.0, 0.0, 101)


@pytest.fixture(scope="module")
def pair() -> tuple[cm.LatticeResult, cm.Result]:
    start = cm.gap_graded(1.0, 0.1)
    continuum = cm.Simulation(MATERIAL, start, grid=cm.LogGrid(-6.0, 0.0, 101)).run(stress_ratio=LOADS)
    lattice = cm.Lattice(10_000, MATERIAL, start, replicas=3, seed=2)
    return lattice.run(stress_ratio=LOADS, grid=continuum.grid), continuum


def mesh_of(ax: Axes) -> np.ma.MaskedArray:
    array = ax.collections[0].get_array()
    assert array is not None
    return np.ma.asarray(array)


@pytest.mark.parametrize("material", [MATERIAL, WIDE, cm.Material(reference_size=2.0, weibull_modulus=5.0)])
@pytest.mark.parametrize("load", [0.5, 1.0, 8.0, 1e4])
def test_the_edge_of_the_zone_is_where_the_stress_function_meets_the_load(material: cm.Material, load: float) -> None:
    top = float(np.log(material.reference_size)) + 2.0
    psi, psibar = zone_edge(material, load, top)
    level = cm.logspace_load(material, load)
    scale = abs(level) + material.k * float(np.abs(psi).max())
    np.testing.assert_allclose(cm.stress_function(material, psi, psibar), level, atol=1e-12 * scale)
    # the tip: equal sizes, whose strength is Weibull's
    tip = psi.size // 2
    assert psi[tip] == pytest.approx(psibar[tip], abs=1e-12)
    assert np.exp(psi[tip]) == pytest.approx(material.reference_size * load ** (-material.weibull_modulus / 3.0))
    assert psi[[0, -1]] == pytest.approx(top)


def test_a_load_that_crushes_nothing_has_no_edge_and_no_fabric_makes_it_straight() -> None:
    assert zone_edge(MATERIAL, 0.5, 0.0)[0].size == 0
    psi, psibar = zone_edge(cm.Material(fabric_width=np.inf), 8.0, 0.0)
    np.testing.assert_allclose(psi, -np.log(8.0))
    assert psibar.min() < psi[0] < psibar.max()


@pytest.mark.parametrize("log_sizes", [False, True])
def test_contours_pass_where_they_must_with_one_line_for_each_load(log_sizes: bool) -> None:
    ax = plotting.plot_stress_contours(MATERIAL, [1.0, *LOADS[1:]], log_sizes=log_sizes)
    _, zero, *_ = ax.lines  # the diagonal comes first; sigma* = 1 is g* = 0
    x, y = np.asarray(zero.get_xdata()), np.asarray(zero.get_ydata())
    if not log_sizes:
        x, y = np.log(x), np.log(y)
    np.testing.assert_allclose((x - y) ** 2, MATERIAL.k * x, atol=1e-12)
    assert np.hypot(x, y).min() < 1e-12  # through the reference size among equals
    assert [line.get_label() for line in ax.lines[1:]] == ["1", "8", "1000"]
    assert "grainsize" in ax.get_xlabel()
    assert "neighbourhood" in ax.get_ylabel()
    assert len({line.get_linestyle() for line in ax.lines[1:]}) == 3  # to tell apart without colour


def test_one_load_may_be_given_as_a_number() -> None:
    assert len(plotting.plot_stress_contours(MATERIAL, 8.0).lines) == 2


def test_the_zone_map_shows_the_zones_and_names_them_inside() -> None:
    grid = cm.LogGrid(-4.0, 1.0, 101)
    ax = plotting.plot_zones(grid, WIDE, 8.0)
    zones = cm.crush_zones(grid, WIDE, 8.0)
    np.testing.assert_array_equal(mesh_of(ax), zones.T)
    names = {"$A_{00}$": 0, "$A_{01}$": 1, "$A_{10}$": 2, "$A_{11}$": 3}
    assert len(ax.texts) == 4
    for text in ax.texts:
        x, y = text.get_position()
        assert zones[grid.bin_of(x), grid.bin_of(y)] == names[text.get_text()]
    below_all = plotting.plot_zones(grid, WIDE, 1e-3)
    assert [text.get_text() for text in below_all.texts] == ["$A_{00}$"]


@pytest.mark.parametrize(("cell", "zone"), [((33, 14), "10"), ((14, 33), "01"), ((35, 32), "11"), ((2, 30), "00")])
def test_the_fragment_kernel_is_the_engines(cell: tuple[int, int], zone: str) -> None:
    grid = cm.LogGrid(-4.0, 1.0, 40)
    ax = plotting.plot_fragment_kernel(grid, WIDE, 8.0, *cell, decades=3.0, scheme="paper")
    kernel = cm.cell_kernel(grid, WIDE, 8.0, *cell, scheme="paper")
    drawn = mesh_of(ax)
    shown = kernel.T / kernel.max()
    np.testing.assert_array_equal(drawn.filled(0.0), np.where(shown >= 1e-3, shown, 0.0))
    assert ax.get_title() == f"from zone {zone}"
    cross = ax.lines[-1]
    assert (cross.get_xdata()[0], cross.get_ydata()[0]) == tuple(grid.centres[list(cell)])  # type: ignore[index]


def test_a_state_is_drawn_bin_by_bin_with_its_marginals(pair: tuple[cm.LatticeResult, cm.Result]) -> None:
    for result in pair:
        fabric = result.fabric(1)
        ax = plotting.plot_state(fabric, material=MATERIAL, stress_ratio=8.0, marginals=True)
        density = fabric.binned().probability.T / fabric.grid.spacing**2
        np.testing.assert_array_equal(mesh_of(ax).filled(0.0), np.where(density >= 1e-3, density, 0.0))
        across = ax.child_axes[0].patches[0].get_data().values  # type: ignore[attr-defined]
        np.testing.assert_array_equal(across, fabric.grainsize() / fabric.grid.spacing)
        larger, smaller = ax.lines[0].get_data()
        assert (np.asarray(larger) >= np.asarray(smaller)).all()  # of a pair the larger one decides
        heavy = int((fabric.binned().probability > 0.05).sum())
        assert len(ax.collections[1].get_offsets()) == heavy  # type: ignore[arg-type]


def test_no_load_draws_no_edge() -> None:
    fabric = cm.mixed_fabric(cm.power_law(2.5, 1e-2, 1.0), GRID)
    assert not plotting.plot_state(fabric, material=MATERIAL).lines
    assert not plotting.plot_state(fabric, material=MATERIAL, stress_ratio=0.0).lines


def test_the_evolution_has_lattice_above_and_continuum_below(pair: tuple[cm.LatticeResult, cm.Result]) -> None:
    axes = plotting.plot_evolution(*pair, loads=[0, 2])
    assert axes.shape == (2, 2)
    for row, (name, result) in enumerate(zip(("lattice", "continuum"), pair, strict=True)):
        for ax, k in zip(axes[row], (0, 2), strict=True):
            assert ax.get_title() == f"{name}\n" + rf"$\sigma^*$ = {LOADS[k]:g}"
            density = result.fabric(k).binned().probability.T / result.grid.spacing**2
            assert mesh_of(ax).max() == density.max()
    assert axes[0, 0].figure.axes[-1].get_ylabel() == "density of mass"


def test_curves_are_those_of_the_result(pair: tuple[cm.LatticeResult, cm.Result]) -> None:
    lattice, continuum = pair
    ax = plotting.plot_cdf_families(continuum, behind=lattice)
    named = [line for line in ax.lines if not str(line.get_label()).startswith("_")]
    assert [line.get_label() for line in named] == ["start", "1", "8", "1000"]
    for k, line in enumerate(named[1:]):
        np.testing.assert_array_equal(line.get_data(), (continuum.curve(k).size, continuum.curve(k).finer))
    behind = [line for line in ax.lines if line.get_label() == "_behind"]
    for k, line in enumerate(behind):
        np.testing.assert_array_equal(line.get_data(), (lattice.curve(k).size, lattice.curve(k).finer))
    assert ax.get_xscale() == "log"
    assert ax.get_ylabel() == "mass fraction finer"


@pytest.mark.parametrize(("width", "shape"), [(170.0, (2, 3)), (85.0, (3, 2))])
def test_the_comparison_says_how_far_the_two_are_apart(
    pair: tuple[cm.LatticeResult, cm.Result], width: float, shape: tuple[int, int]
) -> None:
    figure = Figure(figsize=plotting.figure_size(width, 160.0), layout="constrained")
    assert plotting.plot_comparison(*pair, figure) is figure
    states, curves = figure.subfigs
    spec = states.axes[0].get_subplotspec()
    assert spec is not None
    assert spec.get_gridspec().get_geometry() == shape
    found = cm.compare(pair[1], pair[0])
    assert f"{found.distance.max():.2g} apart" in curves.axes[1].texts[0].get_text()
    figure.canvas.draw()


def test_distances_have_error_bars_of_two_standard_errors(pair: tuple[cm.LatticeResult, cm.Result]) -> None:
    found = cm.compare(pair[1], pair[0])
    ax = plotting.plot_distances({"gap-graded": found, "again": found})
    assert ax.get_legend_handles_labels()[1] == ["gap-graded", "again"]
    line, _, (bars,) = ax.containers[0].lines  # type: ignore[attr-defined]
    np.testing.assert_array_equal(line.get_ydata(), found.distance)
    lengths = [segment[1, 1] - segment[0, 1] for segment in bars.get_segments()]
    np.testing.assert_allclose(lengths, 4.0 * found.standard_error)


def test_axes_of_the_caller_are_used() -> None:
    figure = Figure()
    ax = figure.add_subplot()
    assert plotting.plot_stress_contours(MATERIAL, 8.0, ax) is ax
    assert plotting.plot_zones(GRID, MATERIAL, 8.0, ax) is ax
    assert plotting.plot_fragment_kernel(GRID, MATERIAL, 8.0, 100, 99, ax) is ax
    fabric = cm.mixed_fabric(cm.power_law(2.5, 1e-2, 1.0), GRID)
    assert plotting.plot_state(fabric, ax) is ax


def test_a_gallery_script_ends_without_a_display(tmp_path: Path) -> None:
    """One of them, quickly, with no backend named; `make figures` runs all, at both widths."""
    code = "import runpy, sys; runpy.run_path(sys.argv[1])['draw'](85).savefig(sys.argv[2], dpi=60)"
    picture = tmp_path / "zones.png"
    command = [sys.executable, "-c", code, str(GALLERY / "plot_figure_4.py"), str(picture)]
    subprocess.run(command, check=True, env={"OPENBLAS_NUM_THREADS": "1", "HOME": str(tmp_path)}, timeout=120)
    assert picture.stat().st_size > 5_000

"""Each plot as a reader sees it: nothing overlaps or is cut off, every axis says what it shows and in which unit."""

from collections.abc import Callable
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pictures import objections

import comminute as cm
from comminute import plotting

SAND = cm.Grading.from_sieves([2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1], unit="mm")
BAND = cm.Grading.from_sieves([1.18, 1.0, 0.85], [100, 8, 0], unit="mm")
MATERIAL = cm.Material(reference_size=2.0, first_crush_stress=1.2)
HIGH = 123_456.0  # of six digits, which titles must have room for
LOADS = [2.0, 80.0, 400.0, 4000.0, 25_000.0, HIGH]


@pytest.fixture(scope="module")
def sand() -> cm.Result:
    return cm.Simulation(MATERIAL, SAND).run(stress=[1.2 * load for load in LOADS])


@pytest.fixture(scope="module")
def pair() -> tuple[cm.LatticeResult, cm.Result]:
    continuum = cm.Simulation(MATERIAL, SAND, grid=cm.LogGrid(-8.0, 0.75, 180)).run(stress_ratio=LOADS)
    rings = cm.Lattice(4000, MATERIAL, SAND, replicas=2)
    return rings.run(stress_ratio=LOADS, grid=continuum.grid), continuum


def figure_of(drawn: Axes | Figure) -> Figure:
    figure = drawn if isinstance(drawn, Figure) else drawn.get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure


EVERYDAY: dict[str, Callable[[cm.Result], Axes | Figure]] = {
    "curves": plotting.plot_curves,
    "coarse left": lambda result: plotting.plot_curves(result, coarse_left=True),
    "phi": lambda result: plotting.plot_curves(replace(result, unit="mm"), phi=True),
    "loglog": lambda result: plotting.plot_curves(result, axes="loglog"),
    "rosin-rammler": lambda result: plotting.plot_curves(result, axes="rosin-rammler"),
    "D50": plotting.plot_index,
    "Cu": lambda result: plotting.plot_index(result, "Cu"),
    "B": lambda result: plotting.plot_index(result, "B"),
    "crushes": lambda result: plotting.plot_index(result, "crushes"),
    "fabric": lambda result: plotting.plot_fabric(result.fabric(-1), material=result.material, unit=result.unit),
    "result": plotting.plot_result,
    "state": lambda result: plotting.plot_state(
        result.fabric(-1), material=result.material, stress_ratio=HIGH, marginals=True, unit=result.unit
    ),
    "families": plotting.plot_cdf_families,
    "contours": lambda result: plotting.plot_stress_contours(result.material, [2.0, 8.0, HIGH], unit=result.unit),
    "log contours": lambda result: plotting.plot_stress_contours(
        result.material, [2.0, 8.0, HIGH], log_sizes=True, unit=result.unit
    ),
    "zones": lambda result: plotting.plot_zones(cm.LogGrid(-4.0, 1.0, 100), cm.Material(fabric_width=1.2), 8.0),
    "kernel": lambda result: plotting.plot_fragment_kernel(
        cm.LogGrid(-4.0, 1.0, 40), cm.Material(fabric_width=1.2), 8.0, 33, 14
    ),
}


@pytest.mark.parametrize("name", EVERYDAY)
@pytest.mark.parametrize("start", ["sand", "band", "gap"])
def test_nothing_overlaps_and_every_axis_has_a_label(name: str, start: str, sand: cm.Result) -> None:
    result = {
        "sand": lambda: sand,
        "band": lambda: cm.Simulation(cm.Material(reference_size=1.18), BAND).run(stress_ratio=LOADS),
        "gap": lambda: cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=LOADS),
    }[start]()
    assert objections(figure_of(EVERYDAY[name](result))) == []


@pytest.mark.parametrize(("width", "loads"), [(170.0, None), (170.0, [0, 1, 4, 5]), (85.0, [0, 5])])
def test_comparisons_have_room_for_their_titles_and_say_their_units(
    pair: tuple[cm.LatticeResult, cm.Result], width: float, loads: list[int] | None
) -> None:
    with mpl.rc_context(plotting.PRINT_STYLE):
        figure = Figure(figsize=plotting.figure_size(width, 170.0), layout="constrained")
        plotting.plot_comparison(*pair, figure, loads=loads)
        assert objections(figure) == []
        states, curves = figure.subfigs
        assert states.axes[0].get_title() == "lattice\n$\\sigma^*$ = 2"
        assert any("123500" in ax.get_title() for ax in states.axes)
        assert curves.axes[0].get_xlabel() == "grainsize $s$ (mm)"
        assert any(ax.get_xlabel() == r"$\psi$ = ln($s$ / mm)" for ax in states.axes)
        assert objections(figure_of(plotting.plot_distances({"sand": cm.compare(*pair)}))) == []


@pytest.mark.parametrize(("width", "loads"), [(170.0, [0, 1, 4, 5]), (85.0, [0, 5])])
def test_the_resolved_closure_has_a_row_and_a_panel_of_its_own(
    pair: tuple[cm.LatticeResult, cm.Result], width: float, loads: list[int]
) -> None:
    lattice, continuum = pair
    start = continuum.measured
    assert start is not None
    sand = cm.Grading.from_sieves(start.size, 100.0 * start.finer, unit=start.unit)
    sizes = lattice.edge_size[40::20].tolist()
    sim = cm.Simulation(continuum.material, sand, closure="resolved", sizes=sizes)
    resolved = sim.run(stress_ratio=continuum.stress_ratio)
    with mpl.rc_context(plotting.PRINT_STYLE):
        figure = Figure(figsize=plotting.figure_size(width, 150.0 if width < 100.0 else 210.0), layout="constrained")
        plotting.plot_comparison(lattice, continuum, figure, resolved=resolved, loads=loads)
        assert objections(figure) == []
    states, curves = figure.subfigs
    assert [ax.get_title() for ax in curves.axes] == ["lattice", "continuum", "resolved"]
    shared = np.isclose(resolved.edge_size[:, None], lattice.edge_size[None, :])
    apart = np.abs(resolved.cdf[:, shared.any(axis=1)] - lattice.cdf[:, shared.any(axis=0)]).max()
    assert f"{apart:.2g} apart" in curves.axes[2].texts[0].get_text()
    assert sum(ax.get_title().startswith("resolved") for ax in states.axes) == len(loads)
    without = cm.Simulation(continuum.material, sand, closure="resolved").run(stress_ratio=continuum.stress_ratio)
    with pytest.raises(cm.ParameterError, match="edge_size"):
        plotting.plot_comparison(lattice, continuum, resolved=without)


@pytest.mark.parametrize("load", [0, 3, 5])
def test_marginals_show_their_peaks(load: int, sand: cm.Result) -> None:
    """Mass of an exact size alone is a stem of no height; all else is to scale, in view, and adds up to the mass."""
    gap = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=LOADS)
    band = cm.Simulation(cm.Material(reference_size=1.18), BAND).run(stress_ratio=LOADS)
    for result in (sand, band, gap):
        fabric = result.fabric(load)
        across, along = plotting.plot_fabric(fabric).child_axes[:2]
        assert isinstance(across, Axes)
        assert isinstance(along, Axes)
        heights = across.patches[0].get_data().values  # type: ignore[attr-defined]
        widths = along.patches[0].get_data().values  # type: ignore[attr-defined]
        exact = sum(point.mass for point in fabric.points)
        assert heights.sum() * fabric.grid.spacing == pytest.approx(1.0 - exact, abs=1e-12)
        for values, top in ((heights, across.get_ylim()[1]), (widths, along.get_xlim()[1])):
            assert values.min() >= 0.0
            assert values.max() <= top <= max(1.2 * values.max(), 1.0)
        stems = sorted(float(np.asarray(line.get_xdata())[0]) for line in across.lines)
        assert stems == pytest.approx(sorted(point.psi for point in fabric.points))

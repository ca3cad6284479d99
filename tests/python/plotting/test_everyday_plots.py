"""The everyday plots: their curves and axes."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("matplotlib")

from matplotlib.lines import Line2D

from comminute import plotting
from comminute.plotting import everyday as everyday_plots
from comminute.runs.remarks import load_labels

SAND = cm.Grading.from_sieves([2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1], unit="mm")
MATERIAL = cm.Material(reference_size=2.0, first_crush_stress=1.2)


@pytest.fixture(scope="module")
def result() -> cm.Result:
    return cm.Simulation(MATERIAL, SAND).run(stress=[1.2, 12.0, 120.0], keep_fabrics=[0, 2])


def line_of(lines: list[Line2D], points: int) -> Line2D:
    return next(line for line in lines if np.size(line.get_xdata()) == points)


def test_a_sieve_curve_shows_its_sieves_and_dots_its_tail() -> None:
    ax = everyday_plots.plot_curves(SAND)
    measured = line_of(ax.get_lines(), 6)
    np.testing.assert_allclose(np.asarray(measured.get_xdata()), [0.08, 0.16, 0.5, 1.0, 1.6, 2.0])
    np.testing.assert_allclose(np.asarray(measured.get_ydata()), [1, 13, 33, 67, 93, 100])
    assert measured.get_marker() == "o"
    tail = line_of(ax.get_lines(), 40)
    assert tail.get_linestyle() == ":"
    assert np.max(np.asarray(tail.get_xdata())) == pytest.approx(0.08)
    assert (ax.get_xscale(), ax.get_xlabel(), ax.get_ylabel()) == ("log", "grainsize (mm)", "per cent finer by mass")
    assert ax.get_xlim()[0] < ax.get_xlim()[1]


def test_every_axis_option(result: cm.Result) -> None:
    assert np.diff(everyday_plots.plot_curves(result, coarse_left=True).get_xlim()) < 0.0
    ax = everyday_plots.plot_curves({"sand": SAND}, phi=True)
    np.testing.assert_allclose(
        np.asarray(line_of(ax.get_lines(), 6).get_xdata())[[-1, -3, 2]], [-1.0, 0.0, 1.0], atol=1e-12
    )
    assert "varphi" in ax.get_xlabel()
    ax = everyday_plots.plot_curves(result, axes="loglog")
    guide = next(line for line in ax.get_lines() if "2.6" in str(line.get_label()))
    x, y = np.log(np.asarray(guide.get_xdata())), np.log(np.asarray(guide.get_ydata()))
    assert (y[1] - y[0]) / (x[1] - x[0]) == pytest.approx(3 - 2.6)
    assert "2.6" not in "".join(
        str(i.get_label()) for i in everyday_plots.plot_curves(SAND, axes="loglog", guide=False).lines
    )
    law = cm.rosin_rammler(0.5, 1.4, largest=50.0).with_unit("mm")
    ax = everyday_plots.plot_curves(law, axes="rosin-rammler")
    straight = max(ax.get_lines(), key=lambda line: np.size(line.get_xdata()))
    x, y = np.log(np.asarray(straight.get_xdata())), np.asarray(straight.get_ydata())
    inside = (y > -5) & (y < 1)
    slope, offset = np.polyfit(x[inside], y[inside], 1)
    assert slope == pytest.approx(1.4, rel=1e-3)
    assert np.exp(-offset / slope) == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(
        cm.ParameterError, match="axes is 'linear'; it must be one of 'semilog', 'loglog', 'rosin-rammler'"
    ):
        everyday_plots.plot_curves(SAND, axes="linear")  # type: ignore[arg-type]
    with pytest.raises(cm.ParameterError, match="unit is ''; phi needs sizes in a known unit"):
        everyday_plots.plot_curves(cm.fuller(1.0), phi=True)
    with pytest.raises(cm.ParameterError, match="the gradings are in , mm; bring them to one unit"):
        everyday_plots.plot_curves({"a": SAND, "b": cm.fuller(1.0)})


def test_a_result_draws_its_start_and_every_load(result: cm.Result) -> None:
    ax = everyday_plots.plot_curves(result)
    texts = [text.get_text() for text in ax.get_legend().get_texts()]  # type: ignore[union-attr]
    assert texts == ["start", "1.2", "12", "120"]
    assert ax.get_legend().get_title().get_text() == "stress"  # type: ignore[union-attr]
    again = everyday_plots.plot_curves(result, ax)
    assert again is ax


@pytest.mark.parametrize("index", ["D50", "Cu", "Cc", "B", "Br", "crushes", "fines"])
def test_indices_against_stress(result: cm.Result, index: str) -> None:
    ax = everyday_plots.plot_index(result, index)
    (line,) = ax.get_lines()
    np.testing.assert_array_equal(np.asarray(line.get_xdata()), [1.2, 12.0, 120.0])
    assert np.all(np.isfinite(np.asarray(line.get_ydata(), dtype=float)))
    if index == "D50":
        np.testing.assert_allclose(np.asarray(line.get_ydata()), result.percentile(50))
    assert ax.get_xlabel() == "stress (unit of the first crush stress)"


def test_an_index_of_ones_own_and_one_that_is_none(result: cm.Result) -> None:
    def sorting(curve: cm.SizeCurve) -> float:
        return cm.folk_ward(curve).sorting

    assert everyday_plots.plot_index(result, sorting, color="k").get_ylabel() == "sorting"
    with pytest.raises(
        cm.ParameterError, match="index is 'C_u'; it must be a size such as D50, or one of Cu, Cc, B, Br"
    ):
        everyday_plots.plot_index(result, "C_u")


def test_the_slider_goes_over_the_kept_loads(result: cm.Result) -> None:
    pytest.importorskip("ipywidgets")
    control, picture = result.slider().children
    assert control.description == "stress"
    assert control.options == (("1.2", 0), ("120", 2))
    assert control.value == 2
    assert bytes(picture.value) == plotting.plot_result(result, 2).png()
    control.index = 0
    assert bytes(picture.value) == plotting.plot_result(result, 0).png()
    with pytest.raises(cm.ParameterError, match="no fabric was kept, so there is nothing to slide over"):
        dataclasses.replace(result, fabrics=(None,) * 3).slider()


def test_pictures_of_one_result_lie_side_by_side(result: cm.Result) -> None:
    first, last = (result.plot(k).axes[1] for k in (0, 2))
    assert first.get_xlim() == last.get_xlim() == first.get_ylim()
    for pmf in result.pmf:  # all but a thousandth, the finest, is in the picture
        assert pmf[result.psi < first.get_xlim()[0]].sum() < 1e-3


def test_loads_are_named_once_and_not_too_often(result: cm.Result) -> None:
    sim = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1), grid=cm.LogGrid(-9.0, 0.0, 91))
    again = sim.run(stress_ratio=[8, 80, 80, 8], remix_after=[1])
    assert load_labels(again) == ("stress ratio", ["8", "80", "80'", "8'"])
    legend = everyday_plots.plot_curves(sim.run(stress_ratio=np.geomspace(1, 100, 25))).get_legend()
    texts = [text.get_text() for text in legend.get_texts()]  # type: ignore[union-attr]
    assert (texts[0], texts[1], texts[-1]) == ("start", "1", "100")
    assert len(texts) == 10


NOTEBOOK = (
    """
import comminute as cm
result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8])
box = result.slider()
box
""",
    "box.children[0].index = 0\nresult.plot(0)",
)


@pytest.mark.filterwarnings("ignore")  # of the kernel's own libraries
def test_a_notebook_shows_the_slider_and_the_plot() -> None:
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in NOTEBOOK])
    nbclient.NotebookClient(notebook, kernel_name="python3", timeout=120).execute()
    (shown,), (plotted,) = (cell.outputs for cell in notebook.cells)
    state = notebook.metadata.widgets["application/vnd.jupyter.widget-state+json"]["state"]
    box = state[shown.data["application/vnd.jupyter.widget-view+json"]["model_id"]]["state"]
    slider, picture = (state[name.removeprefix("IPY_MODEL_")] for name in box["children"])
    assert slider["state"]["_options_labels"] == ["1", "8"]
    assert slider["state"]["index"] == 0
    (sent,) = (buffer["data"] for buffer in picture["buffers"])
    assert sent == plotted.data["image/png"].replace("\n", "")  # what the slider shows is the plot of its load


def test_plots_never_ask_for_a_display() -> None:
    script = (
        "import sys; import comminute as cm; from comminute.plotting import everyday as everyday_plots\n"
        "r = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8])\n"
        "everyday_plots.plot_curves(r); everyday_plots.plot_index(r); r.plot()\n"
        "print('matplotlib.pyplot' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env={"MPLBACKEND": "TkAgg"}
    )
    assert done.stdout.strip() == "False"

"""Response tables as their users meet them: against runs, indices of whole curves, files, and what is refused."""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm

MATERIAL = cm.Material()
MOST = 1000.0
SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.25], [100, 70, 20, 0], unit="mm")
STARTS = {
    "equal": cm.monodisperse(1.0).with_unit("mm"),
    "gap": cm.gap_graded(1.0, 0.1).with_unit("mm"),
    "sand": SAND,
    "power": cm.power_law(2.5, 1e-2, 1.0).with_unit("mm"),
}


def table_of(start: cm.Grading, **options: object) -> cm.ResponseTable:
    grid = cm.fitting_grid(start, MATERIAL, MOST, bins=128)
    return cm.ResponseTable(MATERIAL, start, grid, MOST, **options)  # type: ignore[arg-type]


TABLES = {name: table_of(start, quantities=["breakage", "Br"]) for name, start in STARTS.items()}


@pytest.mark.parametrize("name", STARTS)
def test_a_table_is_a_run_at_every_load(name: str) -> None:
    table, start = TABLES[name], STARTS[name]
    loads = np.exp(np.random.default_rng(7).uniform(np.log(0.3), np.log(MOST), 60))
    run = cm.Simulation(MATERIAL, start, grid=table.grid).run(stress_ratio=np.sort(loads), keep_fabrics=[])
    before = cm.SizeCurve.of(start)
    for k, load in enumerate(np.sort(loads).tolist()):
        assert np.abs(table.cdf(load) - run.cdf[k]).max() <= table.tolerance
        curve, theirs = table.curve(load), run.curve(k)
        at = table.grid.edge_sizes[1:]
        assert np.abs(curve.finer_than(at) - theirs.finer_than(at)).max() <= 3.0 * table.tolerance
        assert table.value("crushes", load) == pytest.approx(run.crushes[k], abs=1e-3)
        assert table.value("fines", load) == pytest.approx(run.fines[k], abs=table.tolerance)
        # an index is an integral of the curve over a few decades of size, relative to that of its ultimate grading
        assert table.value("breakage", load) == pytest.approx(cm.breakage_index(before, curve).index, abs=5e-3)
        assert table.value("Br", load) == pytest.approx(cm.relative_breakage(before, curve), abs=5e-3)
        assert table.value("d60", load) == pytest.approx(curve.percentile(60), rel=1e-9)


@settings(deadline=None)
@given(name=st.sampled_from(sorted(STARTS)), one=st.floats(0.0, MOST), other=st.floats(0.0, MOST))
def test_more_load_never_coarsens(name: str, one: float, other: float) -> None:
    table, loads = TABLES[name], np.sort([one, other])
    for rising in ("crushes", "fines"):
        less, more = table.value(rising, loads)
        assert less <= more + 1e-15
    assert (table.derivative("crushes", loads) >= 0.0).all()
    for percent in (50, 90):
        coarse, fine = table.value(f"D{percent}", loads)
        assert fine <= coarse * (1.0 + 1e-9)


@pytest.mark.parametrize("name", STARTS)
def test_below_the_first_crush_there_is_the_start(name: str) -> None:
    table, start = TABLES[name], STARTS[name]
    for load in (0.0, 1e-3, 0.999 * float(table.loads[0])):
        on_grid = cm.mixed_fabric(start, table.grid).cdf()
        np.testing.assert_allclose(table.cdf(load), on_grid, atol=1e-14)
        np.testing.assert_allclose(table.pmf(load), np.diff(on_grid, prepend=0.0), atol=1e-14)
        for index in ("crushes", "D50", "breakage"):
            assert table.derivative(index, load) == 0.0


def test_shapes_of_loads_are_kept() -> None:
    loads = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 600.0]])
    assert TABLES["sand"].value("D50", loads).shape == (2, 3)
    assert TABLES["sand"].value("D50", 2.0).shape == ()
    assert TABLES["sand"].value("D50", [2.0, 3.0]).tolist() == TABLES["sand"].value("D50", loads)[0, 1:].tolist()


def test_a_loading_rate_and_a_fabric_are_followed_too() -> None:
    grid = cm.fitting_grid(SAND, MATERIAL, MOST, bins=128)
    fabric = cm.mixed_fabric(SAND, grid, mean="geometric")
    table = cm.ResponseTable(MATERIAL, fabric, largest=MOST, loading_rate=0.5, tolerance=1e-3)
    run = cm.Simulation(MATERIAL, fabric).run(stress_ratio=[3.0, 70.0], loading_rate=0.5)
    for k, load in enumerate((3.0, 70.0)):
        assert np.abs(table.cdf(load) - run.cdf[k]).max() <= 1e-3


@pytest.mark.parametrize("name", STARTS)
def test_bytes_files_and_pickles_give_an_equal_table(name: str, tmp_path: Path) -> None:
    table = TABLES[name]
    again = [
        cm.ResponseTable.open(table.save(tmp_path / "table.nc")),
        cm.ResponseTable.from_bytes(bytes(table), table.unit),
        pickle.loads(pickle.dumps(table)),
    ]
    loads = np.linspace(0.0, MOST, 50)
    for other in again:
        assert other == table
        np.testing.assert_array_equal(other.value("D50", loads), table.value("D50", loads))
        assert other.curve(30.0) == table.curve(30.0)
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(tmp_path / "table.nc", engine="h5netcdf") as data:
        np.testing.assert_array_equal(data["stress_ratio"], table.loads)
        np.testing.assert_array_equal(data["cdf"][5], table.cdf(float(table.loads[5])))
        assert set(data.data_vars) == {"cdf", "table", "crushes", "fines", "breakage", "Br"}


def test_files_that_are_no_table_are_refused(tmp_path: Path) -> None:
    run = cm.Simulation(MATERIAL, SAND).run(stress_ratio=2.0).save(tmp_path / "run.nc")
    text = tmp_path / "text.nc"
    text.write_text("no table")
    damaged = TABLES["equal"].save(tmp_path / "damaged.nc")
    content = bytearray(damaged.read_bytes())
    content[len(content) // 2] ^= 0xFF
    damaged.write_bytes(bytes(content))
    for file in (run, text, damaged, tmp_path / "none.nc"):
        with pytest.raises(cm.ParameterError, match=file.name):
            cm.ResponseTable.open(file)


def test_bins_that_are_too_wide_or_end_too_early_are_said() -> None:
    for grid, words in ((cm.LogGrid(-6.0, 0.6, 24), "bins are 0.29 wide"), (cm.LogGrid(-1.5, 0.69, 87), "fines bin")):
        with pytest.warns(cm.ResolutionWarning, match=words) as said:
            cm.ResponseTable(MATERIAL, SAND, grid, MOST, tolerance=1e-3)
        assert said[0].filename == __file__


def test_what_a_table_does_not_know_is_refused() -> None:
    table = TABLES["sand"]
    loaded = cm.QuasiStatic(table.grid, MATERIAL).solve(cm.mixed_fabric(SAND, table.grid), 5.0)
    refused: dict[str, Callable[[], object]] = {
        r"stress_ratio is 2000.*from 0 to 1000": lambda: table.value("D50", 2000.0),
        r"stress_ratio\[1\] is -1": lambda: table.value("crushes", [1.0, -1.0]),
        r"stress_ratio is nan": lambda: table.derivative("breakage", float("nan")),
        r"stress_ratio is 1e\+06.*from 0": lambda: table.curve(1e6),
        r"name is 'D101'.*crushes, fines, breakage, Br": lambda: table.value("D101", 1.0),
        r"name is 'Cu'": lambda: table.value("Cu", 1.0),
        r"D0.* lies in the fines bin": lambda: table.value("D0", 900.0),
        r"index is 'BB'": lambda: table_of(SAND, quantities=["BB"]),
        r"largest is 0": lambda: cm.ResponseTable(MATERIAL, SAND, largest=0.0),
        r"largest is inf": lambda: cm.ResponseTable(MATERIAL, SAND, largest=float("inf")),
        r"tolerance is 0": lambda: table_of(SAND, tolerance=0.0),
        r"loading_rate is 2": lambda: table_of(SAND, loading_rate=2.0),
        r"start is at rest under a stress ratio of 5": lambda: cm.ResponseTable(MATERIAL, loaded),
        r"leave grid out": lambda: cm.ResponseTable(
            MATERIAL, cm.mixed_fabric(SAND, table.grid), cm.LogGrid(-1.0, 0.0, 9)
        ),
        r"strength_scatter": lambda: cm.ResponseTable(cm.Material(strength_scatter=True), SAND),
        r"path is .*\.nc": lambda: table.save("table.txt"),
        r"bytes are no response table": lambda: cm.ResponseTable.from_bytes(b"no table, but long enough to be one"),
    }
    for words, call in refused.items():
        with pytest.raises(cm.ParameterError, match=words):
            call()

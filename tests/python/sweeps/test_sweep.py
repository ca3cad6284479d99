"""Sweeps: each member is what a run of it gives, whatever runs it, and whatever stops the rest."""

import pickle
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("pydantic")
pytest.importorskip("zarr")
pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")

import sweeps

MEASURED = {
    "kind": "sieves",
    "size": [2.0, 1.0, 0.5, 0.25, 0.125],
    "percent_finer": [100.0, 70.0, 35.0, 12.0, 2.0],
}
WIDTHS = [0.05, 0.2, 0.45]


def case_of(grading: dict[str, Any], **tables: Any) -> dict[str, Any]:
    material = {"reference_size": 2.0, "first_crush_stress": 1.5, "fabric_width": 0.3}
    load = {"stress": [1.5, 15.0, 7.0, 60.0]}
    return {"units": {"size": "mm"}, "material": material, "grading": grading, "load": load} | tables


CASES = {
    "measured": case_of(MEASURED),
    "gap-graded": case_of({"kind": "gap-graded", "coarse": 2.0, "fine": 0.2}),
    "power law": case_of({"kind": "power-law", "fractal_dimension": 2.4, "smallest": 0.02, "largest": 2.0}),
    "at a rate": case_of(MEASURED, load={"stress": [3.0, 30.0], "loading_rate": 0.4}, grid={"bins": 60}),
    "fast": case_of(MEASURED, engine={"kind": "fast"}, grid={"bins": 60}),
    "remixed": case_of(MEASURED, load={"stress": [3.0, 30.0], "remix_after": [0]}),
    "by steps": case_of(
        MEASURED, grid={"bins": 60}, engine={"name": "slow-update", "steps_per_load": 30}, load={"stress": [20.0]}
    ),
    "resolved": case_of({"kind": "monodisperse", "size": 2.0}, engine={"closure": "resolved"}),
    "coarse fines bin": case_of(MEASURED, grid={"bins": 90, "psi_min": -2.5, "psi_max": 0.7}),
}


def swept(folder: Path, case: dict[str, Any], over: dict[str, Any], **options: Any) -> cm.Sweep:
    return cm.sweep(case, over, store=folder / "sweep.zarr", **options)


def require_same(found: cm.Sweep, member: int) -> None:
    """Every number of a member is that of its run, bit for bit."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("warnings.warn", lambda *_, **__: None)
        run = found.result(member)
    curves = [run.curve(k) for k in range(run.stress_ratio.size)]
    for name in ("stress_ratio", "crushes", "mass_error", "fines"):
        assert np.array_equal(found.values(name)[member], getattr(run, name)), name
    for percent in (10, 50, 90):
        inside = [percent / 100 > curve.finer[0] for curve in curves]
        wanted = [c.percentile(percent) if ok else np.nan for c, ok in zip(curves, inside, strict=True)]
        assert np.array_equal(found.values(f"D{percent}")[member], wanted, equal_nan=True)
    data = found.to_xarray()
    finer = [curve.finer_than(data["size"].values) for curve in curves]
    assert np.array_equal(data["finer"].values[member], finer)
    index = [cm.breakage_index(run.start_curve, curve).index for curve in curves]
    np.testing.assert_allclose(found.values("breakage")[member], index, rtol=1e-12, atol=1e-14)
    if run.unit:
        relative = [cm.relative_breakage(run.start_curve, curve) for curve in curves]
        np.testing.assert_allclose(found.values("relative_breakage")[member], relative, rtol=1e-12, atol=1e-14)
    assert found.warned.get(member, "") == "; ".join(run.warnings)[:256]


@pytest.mark.parametrize("name", CASES)
def test_each_member_is_its_own_run(tmp_path: Path, name: str) -> None:
    found = swept(tmp_path, CASES[name], {"material.fabric_width": WIDTHS})
    assert not found.failed
    for member in range(len(found)):
        require_same(found, member)


def test_members_may_differ_in_anything(tmp_path: Path) -> None:
    over = {
        "grading.fractal_dimension": [2.1, 2.6],
        "material.fragments.shape": [0.8, 1.5],
        "engine.closure": ["paper", "resolved"],
    }
    found = swept(tmp_path, CASES["power law"], over, sizes=[0.1, 1.0])
    assert len(found) == 8
    assert not found.failed
    assert found.keys == tuple(over)
    assert list(found.values("engine.closure")[:2]) == ["paper", "resolved"]  # the last key is the fastest
    for member in range(8):
        require_same(found, member)


def test_rows_are_members(tmp_path: Path) -> None:
    over = {"material.fabric_width": [0.1, 0.4], "material.first_crush_stress": [1.0, 3.0]}
    rows = swept(tmp_path, CASES["measured"], over, how="rows")
    product = cm.sweep(CASES["measured"], over, store=tmp_path / "product.zarr")
    assert (len(rows), len(product)) == (2, 4)
    assert np.array_equal(rows.values("breakage"), product.values("breakage")[[0, 3]])
    assert np.array_equal(rows.values("stress_ratio")[1], np.array([1.5, 15.0, 7.0, 60.0]) / 3.0)


def test_lists_of_a_case_file_vary(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    (tmp_path / "sand.csv").write_text("size_mm,percent_finer\n2,100\n1,60\n0.5,20\n0.25,0\n")
    file.write_text(
        '[material]\nreference_size = 2.0\nfabric_width = [0.1, 0.3]\n[grading]\nfile = "sand.csv"\n'
        "[load]\nstress_ratio = [10.0]\n"
    )
    found = cm.sweep(file, {"material.weibull_modulus": [3, 6]}, store=tmp_path / "s.zarr")
    assert found.keys == ("material.fabric_width", "material.weibull_modulus")
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    file.rename(moved / "case.toml")
    (tmp_path / "sand.csv").rename(moved / "sand.csv")
    over = {"material.weibull_modulus": [3, 6]}
    assert cm.sweep(moved / "case.toml", over, store=tmp_path / "s.zarr", resume=True) == found
    (moved / "sand.csv").unlink()  # which the store has written out
    require_same(cm.Sweep(tmp_path / "s.zarr"), 3)


def test_many_loads_of_a_member_are_refused_where_the_first_has_few(tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text("stress_ratio\n10\n")
    (tmp_path / "two.csv").write_text("stress_ratio\n10\n20\n")
    case = CASES["measured"] | {"load": {"file": str(tmp_path / "one.csv")}}
    over = {"load.file": [str(tmp_path / "one.csv"), str(tmp_path / "two.csv")]}
    found = swept(tmp_path, case, over)
    assert found.failed == {
        1: "the member has 2 loads, where the first member has 1; members of one sweep have the same number"
    }


def test_failed_members_are_kept_with_their_reason(tmp_path: Path) -> None:
    over = {"material.fabric_width": [0.1, -1.0, 0.3], "engine.mean": ["arithmetic", "none"]}
    found = swept(tmp_path, CASES["measured"], over)
    assert list(found.status) == [1, 3, 3, 3, 1, 3]
    assert "fabric_width is -1; it must be greater than 0" in found.failed[2]
    assert "mean" in found.failed[1]
    assert np.isnan(found.values("D50")[1]).all()
    assert "4 failed" in repr(found)
    with pytest.raises(cm.ParameterError, match="fabric_width is -1"):
        found.result(2)


REFUSED = [
    ({"material.fabric_wdth": [0.1]}, {}, "fabric_wdth is an unknown key; did you mean fabric_width"),
    ({"material.fabric_width": [-1.0, 0.1]}, {}, "fabric_width is -1"),  # a first member that cannot run
    ({}, {}, "over names no key"),
    ({"material.fabric_width": []}, {}, "needs a list of values"),
    ({"material.fabric_width": "wide"}, {}, "needs a list of values"),
    ({"material.fabric_width": [0.1, "wide"]}, {}, "must be all numbers, all words"),
    ({"material.fabric_width": [0.1, 0.2], "material.k0": [1.0]}, {"how": "rows"}, "rows need equal lists"),
    ({"material.fabric_width": [0.1]}, {"how": "pairs"}, '"product" or "rows"'),
    ({"material.fabric_width": [0.1]}, {"jobs": 0}, "jobs is 0"),
    ({"material.fabric_width": [0.1]}, {"chunk": 0}, "chunk is 0"),
    ({"material.fabric_width": [0.1]}, {"percents": [101.0]}, "percents"),
    ({"material.fabric_width": [0.1]}, {"sizes": [0.0]}, "sizes"),
    ({"material.fabric_width": [0.1]}, {"executor": "dask"}, "concurrent.futures.Executor"),
    ({f"material.fabric_width{k}": range(1000) for k in range(3)}, {}, "10,000,000 members"),
]


@pytest.mark.parametrize(("over", "options", "message"), REFUSED)
def test_what_cannot_be_swept_is_refused(
    tmp_path: Path, over: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(cm.ParameterError, match=message):
        swept(tmp_path, CASES["measured"], over, **options)
    assert not list(tmp_path.iterdir())


def test_a_store_says_of_which_kind_it_is(tmp_path: Path) -> None:
    for store, message in (("sweep.csv", "must end in .zarr or .nc"), ("no/sweep.nc", "its folder does not exist")):
        with pytest.raises(cm.ParameterError, match=message):
            cm.sweep(CASES["measured"], {"material.fabric_width": WIDTHS}, store=tmp_path / store)
    (tmp_path / "other.zarr").mkdir()
    with pytest.raises(cm.ParameterError, match="is no sweep of comminute"):
        cm.Sweep(tmp_path / "other.zarr")
    with pytest.raises(cm.ParameterError, match="is no sweep of comminute"):
        cm.Sweep(tmp_path / "nowhere.nc")


def test_names_of_numbers(tmp_path: Path) -> None:
    found = swept(tmp_path, CASES["measured"], {"material.fabric_width": WIDTHS}, percents=[50, 84])
    assert found.values("d84").shape == (3, 4)
    with pytest.raises(cm.ParameterError, match=re.escape("one of material.fabric_width") + ".*D84"):
        found.values("D10")
    table = found.to_pandas()
    assert list(table.columns[:3]) == ["material.fabric_width", "status", "stress_ratio"]
    assert list(table["D84"]) == list(found.values("D84")[:, -1])
    again = pickle.loads(pickle.dumps(found))
    assert again == found


def test_netcdf_holds_what_zarr_holds(tmp_path: Path) -> None:
    over: dict[str, Any] = {"material.fabric_width": [0.1, -1.0], "engine.scheme": ["conservative", "paper"]}
    zarr, netcdf = (cm.sweep(CASES["measured"], over, store=tmp_path / f"s{end}") for end in (".zarr", ".nc"))
    assert not (tmp_path / "s.part.zarr").exists()
    assert zarr == netcdf
    assert netcdf.failed == zarr.failed
    assert cm.sweep(CASES["measured"], over, store=tmp_path / "s.nc", resume=True) == zarr


@pytest.fixture(params=["threads", "processes", "dask"])
def executor(request: pytest.FixtureRequest) -> Iterator[Any]:
    if request.param == "dask":
        distributed = pytest.importorskip("distributed")
        with (
            distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield client
        return
    pool: Executor = ThreadPoolExecutor(2) if request.param == "threads" else ProcessPoolExecutor(2)
    with pool:
        yield pool


@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_whatever_runs_the_chunks_gives_the_same_bits(tmp_path: Path, executor: Any) -> None:
    widths = np.linspace(0.05, 0.5, 12)
    over: dict[str, Any] = {"material.fabric_width": widths, "material.weibull_modulus": [3.0, -1.0]}
    alone = swept(tmp_path, CASES["measured"], over)
    found = cm.sweep(CASES["measured"], over, store=tmp_path / "other.zarr", executor=executor, chunk=5)
    assert found == alone
    assert found.failed == alone.failed


def test_a_killed_sweep_goes_on(tmp_path: Path) -> None:
    store, script = tmp_path / "sweep.zarr", Path(sweeps.__file__)
    with subprocess.Popen([sys.executable, script, store], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(3)]
        process.send_signal(signal.SIGKILL)
    written = int(lines[-1].split()[0])
    assert written == 3 * sweeps.CHUNK
    kept = int(np.sum(cm.Sweep(store).status != 0))
    assert kept >= written  # not one chunk that was reported is lost
    found, reached = sweeps.sweep(store, resume=True)
    assert reached == list(range(kept + sweeps.CHUNK, sweeps.MEMBERS + 1, sweeps.CHUNK))  # nor run again
    assert found == sweeps.sweep(tmp_path / "whole.zarr", jobs=2)[0]


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_interrupted_sweep_keeps_what_came_back(tmp_path: Path, jobs: int) -> None:
    def stop(done: int, total: int) -> None:
        assert total == 12
        if done >= 6:
            raise KeyboardInterrupt

    case, over = CASES["measured"], {"material.fabric_width": np.linspace(0.1, 0.5, 12)}
    with pytest.raises(KeyboardInterrupt):
        swept(tmp_path, case, over, jobs=jobs, chunk=2, on_chunk=stop)
    finished = int(np.sum(cm.Sweep(tmp_path / "sweep.zarr").status == 1))
    assert 6 <= finished < 12 + 2 * (jobs - 1)
    with pytest.raises(FileExistsError, match="resume=True goes on with it, force=True throws it away"):
        swept(tmp_path, case, over)
    with pytest.raises(cm.ParameterError, match="belongs to another sweep"):
        swept(tmp_path, case, {"material.fabric_width": np.linspace(0.1, 0.6, 12)}, resume=True)
    found = swept(tmp_path, case, over, resume=True)
    assert found == cm.sweep(case, over, store=tmp_path / "whole.zarr")
    assert swept(tmp_path, case, {"material.fabric_width": WIDTHS}, force=True).status.size == 3

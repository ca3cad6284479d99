"""Results in files: nothing lost, nothing silently wrong, and runs that go on or repeat bit for bit."""

import contextlib
import hashlib
import json
import pickle
import signal
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import comminute as cm
from comminute.files import storage
from comminute.util.whole_files import write_whole

xr = pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")

MATERIAL = cm.Material(
    reference_size=2.0, first_crush_stress=1.2, fragments=cm.TabulatedFragments([0.2, 1.0], [0.1, 1.0])
)
SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.2], [100, 60, 20, 3], unit="mm")
GRID = cm.LogGrid(-7.0, 0.7, 112)
GOLDEN = Path(__file__).parents[2] / "golden"
STARTS = {
    "sieves": SAND,
    "gap-graded": cm.gap_graded(2.0, 0.2),
    "monodisperse": cm.monodisperse(2.0),
    "geometric": cm.mixed_fabric(cm.power_law(2.5, 0.01, 2.0), GRID, mean="geometric"),
    "loaded before": cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=3.0).fabric(-1),
}


def simulation(start: str, **options: object) -> cm.Simulation:
    begun = STARTS[start]
    grid = None if isinstance(begun, cm.Fabric) else GRID
    return cm.Simulation(MATERIAL, begun, grid=grid, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("start", STARTS)
def test_a_file_gives_back_the_result(start: str, tmp_path: Path) -> None:
    result = simulation(start).run(stress=[1.2, 12.0, 3.0], remix_after=[0], keep_fabrics=[0, 2])
    again = cm.open_result(result.save(tmp_path / "run.nc"))
    assert again == result
    assert repr(again) == repr(result)
    assert pickle.loads(pickle.dumps(again)) == result
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


@pytest.mark.parametrize("replicas", [1, 3])
def test_a_file_gives_back_the_result_of_a_lattice(replicas: int, tmp_path: Path) -> None:
    rings = cm.Lattice(100, MATERIAL, cm.gap_graded(2.0, 0.2), replicas=replicas)
    result = rings.run(stress_ratio=[1.0, 8.0], grid=GRID)
    again = cm.open_result(result.save(tmp_path / "rings.nc"))
    assert isinstance(again, cm.LatticeResult)
    assert again == result
    continuum = simulation("gap-graded").run(stress_ratio=[1.0, 8.0])
    assert cm.compare(continuum, again) == cm.compare(continuum, result)


def test_a_file_can_be_read_by_others(tmp_path: Path) -> None:
    result = simulation("sieves").run(stress=[1.2, 12.0])
    path = result.save(tmp_path / "run.nc")
    with xr.open_dataset(path) as data:
        assert set(data.sizes) == {"load", "psi", "psibar", "fabric_load", "sieve"}
        np.testing.assert_array_equal(data["cdf"], result.cdf)
        np.testing.assert_array_equal(data["fabric"][1], result.fabric(1).probability)
        assert data["size"].attrs == {"long_name": "grainsize at bin centres", "units": "mm"}
        assert all("long_name" in data[name].attrs for name in data.variables)
        assert data.attrs["comminute_version"] == cm.__version__
    h5py = pytest.importorskip("h5py")
    with h5py.File(path) as file:
        np.testing.assert_array_equal(file["pmf"][...], result.pmf)


def test_a_file_from_before_lattices_had_errors_is_read(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    result = simulation("sieves").run(stress=[1.2, 12.0])
    path = result.save(tmp_path / "run.nc")
    with h5py.File(path, "r+") as file:
        del file.attrs["lattice"]
        del file.attrs[storage.FINGERPRINTS]
    assert cm.open_result(path) == result


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("cut", [1, 2, 4])
def test_resuming_equals_one_run(start: str, cut: int, tmp_path: Path) -> None:
    loads, rates, remixed = [1.0, 8.0, 2.0, 30.0, 100.0], [0.0, 0.0, 0.3, 0.0, 0.0], [1, 3]
    sim = simulation(start)
    whole = sim.run(stress_ratio=loads, loading_rate=rates, remix_after=remixed)
    first = sim.run(stress_ratio=loads[:cut], loading_rate=rates[:cut], remix_after=[k for k in remixed if k < cut])
    first = cm.open_result(first.save(tmp_path / "run.nc"))
    again = first.resume(loads[cut:], loading_rate=rates[cut:], remix_after=[k - cut for k in remixed if k >= cut])
    assert again == whole


@pytest.mark.parametrize("start", STARTS)
def test_resuming_without_all_fabrics_equals_one_run_to_rounding(start: str) -> None:
    sim = simulation(start)
    whole = sim.run(stress_ratio=[1.0, 8.0, 30.0, 100.0], keep_fabrics="last")
    again = sim.run(stress_ratio=[1.0, 8.0], keep_fabrics="last").resume([30.0, 100.0], keep_fabrics="last")
    for name in ("pmf", "crushes"):
        np.testing.assert_allclose(getattr(again, name), getattr(whole, name), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(
    "options",
    [{}, {"kind": "exact", "steps_per_load": 2}, {"loading_rate": [0.0, 0.5, 1.0]}, {"keep_fabrics": "last"}],
)
def test_running_again_gives_every_bit(start: str, options: dict[str, object], tmp_path: Path) -> None:
    result = simulation(start, scheme="paper").run(stress=[1.2, 12.0, 50.0], remix_after=[1], **options)  # type: ignore[arg-type]
    again = cm.open_result(result.save(tmp_path / "run.nc"))
    assert cm.run_again(again) == result


def test_what_cannot_go_on_says_why(tmp_path: Path) -> None:
    result = simulation("sieves").run(stress_ratio=[1.0, 2.0], keep_fabrics=[0])
    with pytest.raises(cm.ParameterError, match=r"stress_ratio\[0\] is -1"):
        result.resume(stress_ratio=-1.0)
    bare = pickle.loads(pickle.dumps(result))
    object.__setattr__(bare, "recipe", None)
    with pytest.raises(cm.ParameterError, match="the result does not say how it was made"):
        cm.run_again(bare)
    assert cm.open_result(bare.save(tmp_path / "bare.nc")) == bare


def test_an_interrupted_resume_keeps_what_is_finished() -> None:
    sim = simulation("sieves")

    def stop(load: int) -> None:
        if load == 1:
            raise KeyboardInterrupt

    first = sim.run(stress_ratio=[1.0])
    with pytest.raises(cm.Interrupted) as stopped:
        first.resume(stress_ratio=[2.0, 8.0, 20.0], on_load=stop)
    assert stopped.value.result == sim.run(stress_ratio=[1.0, 2.0, 8.0])


def test_damage_is_found(tmp_path: Path) -> None:
    path = simulation("sieves").run(stress_ratio=[1.0, 8.0]).save(tmp_path / "run.nc")
    whole = path.read_bytes()
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "r+") as file:
        file["pmf"][0, 0] = 0.5
    with pytest.raises(
        cm.ParameterError, match=r"run\.nc is no result as comminute wrote it: it is damaged, cut short"
    ):
        cm.open_result(path)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(cm.ParameterError, match=r"run\.nc is no result as comminute wrote it"):
        cm.open_result(path)
    path.write_text("size_mm,percent_finer\n")
    with pytest.raises(cm.ParameterError, match=r"run\.nc is no NetCDF 4 file; give a result file"):
        cm.open_result(path)
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(cm.ParameterError, match=r"run\.nc is no result as comminute wrote it"):
        cm.open_result(path)
    with pytest.raises(cm.ParameterError, match=r"none\.nc does not exist"):
        cm.open_result(tmp_path / "none.nc")


def edited(path: Path, edit: Callable[[Any], object]) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "r+") as file:
        edit(file)
    return path


ATTRIBUTE_EDITS: dict[str, Callable[[Any], object]] = {
    "attribute history added": lambda file: file.attrs.update({"history": "ncatted -a institution,global,c,c,ETH"}),
    "attribute title changed": lambda file: file.attrs.update({"title": "sand of the second pit"}),
    "attribute references removed": lambda file: file.attrs.pop("references"),
    "attribute pmf:units changed": lambda file: file["pmf"].attrs.update({"units": "per cent"}),
    "attribute pmf:comment added": lambda file: file["pmf"].attrs.update({"comment": "checked"}),
}


@pytest.mark.parametrize("words", ATTRIBUTE_EDITS)
def test_a_file_with_edited_attributes_opens_with_a_warning_that_names_them(words: str, tmp_path: Path) -> None:
    result = simulation("gap-graded").run(stress=[1.2, 12.0])
    path = edited(result.save(tmp_path / "run.nc"), ATTRIBUTE_EDITS[words])
    with pytest.warns(cm.EditedFileWarning, match=rf"^run\.nc was changed after it was written: {words}; it is read"):
        assert cm.open_result(path) == result
    again = cm.open_result(result.save(path))  # written anew it is as it was
    assert again == result


def test_a_file_with_an_edited_array_opens_with_a_warning_that_names_it(tmp_path: Path) -> None:
    result = simulation("sieves").run(stress_ratio=[1.0, 8.0])

    def edit(file: Any) -> None:
        file["crushes"][0] = 0.5
        file.attrs["engine"] = "by hand"
        file["thoughts"] = np.array([1.0, 2.0])

    path = edited(result.save(tmp_path / "run.nc"), edit)
    with pytest.warns(cm.EditedFileWarning) as told:
        found = cm.open_result(path)
    assert str(told[0].message).startswith(
        "run.nc was changed after it was written: array crushes changed, attribute engine changed, array thoughts added"
    )
    assert told[0].filename == __file__
    assert found.crushes.tolist() == [0.5, result.crushes[1]]
    assert found.engine == "by hand"
    np.testing.assert_array_equal(found.pmf, result.pmf)


INCONSISTENT: dict[str, Callable[[Any], object]] = {
    "cdf": lambda file: file["cdf"].write_direct(np.zeros(file["cdf"].shape)),
    "grid": lambda file: file.attrs.update({"grid": file.attrs["grid"].replace("-7.0", "-6.0")}),
    "mass": lambda file: file["mass_error"].write_direct(np.array([0.1, 0.0])),
    "not a number": lambda file: file["pmf"].write_direct(np.full(file["pmf"].shape, np.nan)),
    "material": lambda file: file.attrs.update({"material": "{"}),
    "missing array": lambda file: file.pop("crushes"),
    "missing attribute": lambda file: file.attrs.pop("grid"),
    "hash": lambda file: file.attrs.update({storage.FINGERPRINTS: "?"}),
}


@pytest.mark.parametrize("edit", INCONSISTENT.values(), ids=INCONSISTENT)
def test_a_file_whose_parts_no_longer_agree_is_refused(edit: Callable[[Any], object], tmp_path: Path) -> None:
    path = edited(simulation("sieves").run(stress_ratio=[1.0, 8.0]).save(tmp_path / "run.nc"), edit)
    with pytest.raises(cm.ParameterError, match=r"run\.nc is no result as comminute wrote it: it is damaged"):
        cm.open_result(path)


def test_the_hash_is_what_its_description_says(tmp_path: Path) -> None:
    result = simulation("sieves").run(stress_ratio=[1.0, 8.0])
    path = result.save(tmp_path / "run.nc")
    record = json.loads(xr.load_dataset(path).attrs[storage.FINGERPRINTS])
    content = f"<f8 {result.pmf.shape} ".encode() + result.pmf.astype("<f8").tobytes()
    assert record["array pmf"] == hashlib.sha256(content).hexdigest()[:16]
    assert record["attribute engine"] == hashlib.sha256(result.engine.encode()).hexdigest()[:16]
    whole = path.read_bytes()
    assert result.save(path).read_bytes() == whole


def test_files_from_before_there_was_a_hash_open_without_a_warning() -> None:
    for name in ("sand.nc", "lattice.nc"):
        assert cm.open_result(GOLDEN / name).warnings == ()


def test_control_c_is_heard_when_the_file_is_whole(tmp_path: Path) -> None:
    def write(path: Path) -> None:  # as libraries do in their callbacks
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        path.write_text("whole")

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path / "run.nc", write)
    assert (tmp_path / "run.nc").read_text() == "whole"
    assert signal.getsignal(signal.SIGINT) is before
    in_a_thread = threading.Thread(target=write_whole, args=(tmp_path / "other.nc", lambda path: path.write_text("")))
    in_a_thread.start()
    in_a_thread.join()
    assert (tmp_path / "other.nc").exists()


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = simulation("sieves").run(stress_ratio=[1.0])
    path = result.save(tmp_path / "run.nc")
    before = path.read_bytes()

    def fail(*_: object, **__: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(xr.Dataset, "dump_to_store", fail)
    with pytest.raises(OSError, match="disk full"):
        result.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]

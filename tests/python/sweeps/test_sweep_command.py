"""The command `sweep`."""

import json
from pathlib import Path

import pytest

import comminute as cm

pytest.importorskip("typer")
pytest.importorskip("pydantic")
pytest.importorskip("zarr")
pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")

from commands import call

CASE = """
[material]
reference_size = 2.0
fabric_width = 0.3
[grading]
kind = "fuller"
largest = 2.0
[load]
stress_ratio = [10.0, 100.0]
"""
OVER = ("--over", "material.fabric_width=0.1,0.4,-1", "--over", "engine.mean=arithmetic,geometric")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path / "case.toml"


def test_a_sweep_from_the_shell(case: Path) -> None:
    ran = call("sweep", case, *OVER, "--jobs", 2, "--table", case.with_name("t.csv"), "--percentiles", "50,80")
    assert ran.exit_code == 0, ran.output
    assert "6 members over material.fabric_width, engine.mean: 4 done, 2 failed" in ran.output
    assert "member 4 failed: case.toml [material]: fabric_width is -1" in ran.output
    found = cm.Sweep(case.with_name("case.zarr"))
    rows = case.with_name("t.csv").read_text().splitlines()
    assert rows[0].startswith("member,material.fabric_width,engine.mean,status,stress_ratio,crushes")
    assert rows[1].split(",")[-3:-1] == [repr(float(found.values(name)[0, -1])) for name in ("D50", "D80")]
    assert len(rows) == 7


def test_stores_are_not_overwritten(case: Path) -> None:
    store = case.with_name("s.nc")
    assert call("sweep", case, *OVER, "-o", store).exit_code == 0
    again = call("sweep", case, *OVER, "-o", store)
    assert again.exit_code == 3
    assert "--resume goes on with it, --force throws it away" in again.stderr
    whole = call("sweep", case, *OVER, "-o", store, "--resume", "--json")
    assert json.loads(whole.stdout)["failed"].keys() == {"4", "5"}
    assert call("sweep", case, *OVER, "-o", store, "--force").exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--over", "fabric_width=0.1"], "must be KEY=VALUE,VALUE"),
        (["--over", "material.fabric_width"], "must be KEY=VALUE,VALUE"),
        (["--over", "material.fabric_wdth=0.1"], "did you mean fabric_width"),
        ([*OVER, "--table", "t.xlsx"], "must end in .csv"),
        ([], "over names no key"),
    ],
)
def test_wrong_words(case: Path, words: list[str], message: str) -> None:
    refused = call("sweep", case, *words)
    assert refused.exit_code == 2
    assert message in refused.stderr
    assert len(refused.stderr.splitlines()) == 1


def test_a_stopped_sweep_says_how_to_go_on(case: Path) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("comminute.cli.texts.ProgressBar.reach", stop)
        stopped = call("sweep", case, *OVER, "--chunk", 2)
    assert stopped.exit_code == 130
    assert "--resume goes on with" in stopped.stderr
    assert call("sweep", case, *OVER, "--resume").exit_code == 0

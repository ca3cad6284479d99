"""Runs of the command line that are stopped, by Ctrl-C or worse: what survives, and how they go on."""

import signal
from pathlib import Path
from typing import Any

import pytest

import comminute as cm
import kills

pytest.importorskip("typer")
pytest.importorskip("h5netcdf")

from typer.testing import Result

from commands import call
from comminute.runs.outcomes import Outcome
from comminute.runs.walk import ContinuumWalker

CASE = kills.case(loads=10)
OTHER = CASE.replace("first_crush_stress = 1.2", "first_crush_stress = 1.3")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def whole_run(folder: Path) -> cm.Result:
    assert call("run", folder / "case.toml", "-o", folder / "whole.nc").exit_code == 0
    return cm.open_result(folder / "whole.nc")


def stop_after(loads: int, *words: object) -> Result:
    """Call a command and press Ctrl-C when so many loads are finished."""
    load, count = ContinuumWalker.load, iter(range(100))

    def stop(*args: Any, **options: Any) -> Outcome:
        if next(count) == loads:
            raise KeyboardInterrupt
        return load(*args, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ContinuumWalker, "load", stop)
        stopped = call(*words)
    assert stopped.exit_code == 130
    return stopped


def test_control_c_keeps_the_finished_loads(folder: Path) -> None:
    whole = whole_run(folder)
    stopped = stop_after(7, "run", folder / "case.toml")
    assert "interrupted after 7 finished loads; they are in" in stopped.stderr
    assert cm.open_result(folder / "run.part.nc").stress_ratio.size == 7
    assert call("run", folder / "case.toml").exit_code == 3
    resumed = call("run", folder / "case.toml", "--resume")
    assert "going on after 7 finished loads" in resumed.output
    assert cm.open_result(folder / "run.nc") == whole
    assert sorted(p.name for p in folder.glob("*.nc")) == ["run.nc", "whole.nc"]


def test_a_part_of_another_case_is_not_gone_on_from(folder: Path) -> None:
    assert call("run", folder / "case.toml").exit_code == 0
    (folder / "run.nc").rename(folder / "run.part.nc")
    (folder / "case.toml").write_text(OTHER)
    refused = call("run", folder / "case.toml", "--resume")
    assert refused.exit_code == 2
    assert "run.part.nc belongs to another case; --force without --resume throws it away" in refused.stderr
    assert call("run", folder / "case.toml", "--force").exit_code == 0


def test_a_stopped_overwriting_goes_on_with_force(folder: Path) -> None:
    assert call("run", folder / "case.toml").exit_code == 0
    earlier = (folder / "run.nc").read_bytes()
    (folder / "case.toml").write_text(OTHER)
    assert call("run", folder / "case.toml", "-o", folder / "whole.nc").exit_code == 0
    stop_after(1, "run", folder / "case.toml", "--force")
    assert (folder / "run.nc").read_bytes() == earlier
    refused = call("run", folder / "case.toml", "--resume")
    assert refused.exit_code == 2
    assert "run.nc belongs to another case; --resume --force overwrites it and goes on from run.part" in refused.stderr
    resumed = call("run", folder / "case.toml", "--resume", "--force")
    assert "going on after 1 finished loads" in resumed.output
    assert cm.open_result(folder / "run.nc") == cm.open_result(folder / "whole.nc")


def test_stopped_runs_go_on_bit_for_bit(tmp_path: Path) -> None:
    trials = kills.Trials(tmp_path, loads=25)
    for forced, how in ((False, signal.SIGKILL), (True, signal.SIGINT)):
        trials.one([0.8 * trials.seconds], forced=forced, how=how)

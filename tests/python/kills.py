"""Runs killed at random moments, and what must be left of them.

As a script: `python tests/python/kills.py KILLS`; from 50 kills on it writes a page of docs/validation.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import comminute as cm

LONG = 50  # kills, from which on the run writes its report
LOADS = 100
KILLS_A_TRIAL = 2  # of the run, and of the run that goes on after it
REPORT = Path(__file__).parents[2] / "docs" / "validation" / "killed-runs.md"


def case(loads: int) -> str:
    """Text of a case whose loads are slow enough to be stopped among them."""
    return f"""
[material]
reference_size = 2.0
first_crush_stress = 1.2
[grading]
kind = "sieves"
size = [2.0, 1.0, 0.5, 0.2]
percent_finer = [100.0, 60.0, 20.0, 0.0]
[grid]
bins = 150
[load]
stress = {{ from = 1.2, to = 1200.0, steps = {loads} }}
[engine]
name = "full-convolution"
"""


@dataclass(frozen=True)
class Remains:
    """What a kill left: loads that can be gone on from, and whether it fell into the writing of a file."""

    loads: int
    writing: bool


class Trials:
    """A folder with a case, the result of its whole run, and an earlier result of another case."""

    def __init__(self, folder: Path, loads: int) -> None:
        self.folder = folder
        self.target, self.part = folder / "run.nc", folder / "run.part.nc"
        (folder / "case.toml").write_text(case(loads))
        (folder / "other.toml").write_text(case(2))
        self._call("run", "other.toml", "-o", "other.nc")
        begun = time.monotonic()
        self._call("run", "case.toml", "-o", "whole.nc")
        self.seconds = time.monotonic() - begun
        self.whole = cm.open_result(folder / "whole.nc")
        self.earlier = {file.name: file.read_bytes() for file in folder.iterdir()}

    def _command(self, *words: str) -> list[str]:
        return [sys.executable, "-m", "comminute", *words]

    def _call(self, *words: str) -> None:
        done = subprocess.run(self._command(*words), cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    def _kill(self, words: Sequence[str], seconds: float) -> Remains:
        """Start a command, kill it after a time, and look at what it left."""
        before = self.target.read_bytes() if self.target.exists() else None
        command, nothing = self._command(*words), subprocess.DEVNULL
        process = subprocess.Popen(command, cwd=self.folder, stdout=nothing, stderr=nothing)
        time.sleep(seconds)
        process.kill()
        process.wait()
        writing = any(self.folder.glob(".run*.tmp"))
        for name, content in self.earlier.items():
            assert (self.folder / name).read_bytes() == content, f"{name} is not as it was"
        if self.target.exists() and self.target.read_bytes() != before:
            assert cm.open_result(self.target) == self.whole, "run.nc is neither the earlier result nor the whole one"
            return Remains(self.whole.stress_ratio.size, writing)
        assert before is None or self.target.exists(), "the earlier run.nc is gone"
        return Remains(self._finished(), writing)

    def _finished(self) -> int:
        """Count the loads in the part file, each of which must be as in the whole run."""
        if not self.part.exists():
            return 0
        part = cm.open_result(self.part)
        loads = part.stress_ratio.size
        for name in ("stress_ratio", "pmf", "crushes", "mass_error"):
            assert np.array_equal(getattr(part, name), getattr(self.whole, name)[:loads]), f"{name} differs"
        return loads

    def one(self, moments: Sequence[float], *, forced: bool) -> list[Remains]:
        """Kill a run and the runs that go on after it, each after its time, then let one come to its end.

        `forced`: over an earlier result of the same name, with --force.
        """
        force = ["--force"] if forced else []
        for file in (self.target, self.part):
            file.unlink(missing_ok=True)
        if forced:
            self.target.write_bytes(self.earlier["other.nc"])
        found = []
        for number, seconds in enumerate(moments):
            go_on = ["--resume"] if number else []
            found.append(self._kill(["run", "case.toml", *go_on, *force], seconds))
        self._call("run", "case.toml", "--resume", *force)
        assert cm.open_result(self.target) == self.whole, "the resumed run differs from the whole one"
        left = {file.name for file in self.folder.iterdir()}
        assert left == {*self.earlier, "run.nc"}, f"left behind: {sorted(left)}"
        return found


def main(kills: int) -> int:
    """Kill so many runs, report, and return the number of failures."""
    chance = np.random.default_rng(7)
    found, failures = list[Remains](), list[str]()
    with tempfile.TemporaryDirectory() as name:
        trials = Trials(Path(name), LOADS)
        for number in range(kills // KILLS_A_TRIAL):
            moments = chance.uniform(0.0, 1.05, KILLS_A_TRIAL) * trials.seconds
            try:
                found += trials.one([float(moment) for moment in moments], forced=number % 2 == 1)
            except AssertionError as error:
                failures.append(f"* trial {number}: {error}")
                print(failures[-1])
    text = page(found, failures)
    print(text)
    if kills >= LONG:
        REPORT.write_text(text, encoding="utf-8")
    return len(failures)


def page(found: Sequence[Remains], failures: Sequence[str]) -> str:
    """Page for the documentation."""
    loads = [remains.loads for remains in found]
    lines = [
        "# Killed runs",
        "",
        f"comminute {cm.__version__}; written by `tests/python/kills.py`, which `make check-long` runs.",
        f"`comminute run` of {LOADS} loads and the `--resume` after it, each killed (SIGKILL) at a random moment from",
        "its start to past its end; every other time with `--force` over an earlier result. After each kill every",
        "earlier file is as it was, byte for byte, and the loads that are kept are those of an uninterrupted run, bit",
        "for bit; so is the whole result when the last resumption has come to its end, and nothing is left behind.",
        "",
        "| kills | number |",
        "|---|---|",
        f"| before a load was kept | {loads.count(0)} |",
        f"| between the loads | {sum(0 < count < LOADS for count in loads)} |",
        f"| after the result was written | {loads.count(LOADS)} |",
        f"| in all | {len(found)} |",
        f"| of these during the writing of a file | {sum(remains.writing for remains in found)} |",
        "",
        f"Finished loads after each kill: {', '.join(map(str, loads))}.",
        "",
        *failures,
        *([""] if failures else []),
        f"Failures: {len(failures)}.",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1])))

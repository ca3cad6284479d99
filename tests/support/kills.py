"""Runs killed, or stopped by Ctrl-C, at random moments, and what must be left of them.

As a script: `python tests/support/kills.py KILLS`; from 50 kills on it writes a page of docs/validation.
"""

from __future__ import annotations

import itertools
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import comminute as cm

LONG = 50  # kills, from which on the run writes its report
LOADS = 100
STOPPED = 130  # exit code after Ctrl-C
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
    """Outcome of a stop: loads that can be gone on from, and whether it fell into the writing of a file."""

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

    def _stop(self, words: Sequence[str], seconds: float, how: signal.Signals) -> Remains:
        """Start a command, stop it after a time, and look at what it left."""
        before = self.target.read_bytes() if self.target.exists() else None
        command, nothing = self._command(*words), subprocess.DEVNULL
        process = subprocess.Popen(
            command,
            cwd=self.folder,
            stdout=nothing,
            stderr=nothing,
            # background jobs of a shell ignore Ctrl-C, and so would what they start
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509  (no threads here)
        )
        time.sleep(seconds)
        over = process.poll() is not None or (self.target.exists() and self.target.read_bytes() != before)
        process.send_signal(how)
        code = process.wait()
        if how == signal.SIGINT and not over:
            # The signal itself: before Python began. Or too late: while it ended, the result written.
            late = code == 0 and self.target.exists() and self.target.read_bytes() != before
            assert late or code in (STOPPED, -how), f"exit code {code} after Ctrl-C"
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

    def one(self, moments: Sequence[float], *, forced: bool, how: signal.Signals = signal.SIGKILL) -> list[Remains]:
        """Stop a run and the runs that go on after it, each after its time, then let one come to its end.

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
            found.append(self._stop(["run", "case.toml", *go_on, *force], seconds, how))
        self._call("run", "case.toml", "--resume", *force)
        assert cm.open_result(self.target) == self.whole, "the resumed run differs from the whole one"
        left = {file.name for file in self.folder.iterdir()}
        assert left == {*self.earlier, "run.nc"}, f"left behind: {sorted(left)}"
        return found


WAYS = {"kill -9": signal.SIGKILL, "Ctrl-C": signal.SIGINT}


def main(kills: int) -> int:
    """Stop so many runs in each way, report, and return the number of failures."""
    chance = np.random.default_rng(7)
    found, failures = {way: list[Remains]() for way in WAYS}, list[str]()
    with tempfile.TemporaryDirectory() as name:
        trials = Trials(Path(name), LOADS)
        for way, number in itertools.product(WAYS, range(kills // KILLS_A_TRIAL)):
            moments = [float(share) * trials.seconds for share in chance.uniform(0.0, 1.05, KILLS_A_TRIAL)]
            try:
                found[way] += trials.one(moments, forced=number % 2 == 1, how=WAYS[way])
            except AssertionError as error:
                failures.append(f"* {way}, trial {number}: {error}")
                print(failures[-1])
    text = page(found, failures)
    print(text)
    if kills >= LONG:
        REPORT.write_text(text, encoding="utf-8")
    return len(failures)


def page(found: Mapping[str, Sequence[Remains]], failures: Sequence[str]) -> str:
    """Page for the documentation."""
    loads = {way: [remains.loads for remains in stops] for way, stops in found.items()}
    counts = {
        "before a load was kept": [counted.count(0) for counted in loads.values()],
        "between the loads": [sum(0 < count < LOADS for count in counted) for counted in loads.values()],
        "after the result was written": [counted.count(LOADS) for counted in loads.values()],
        "in all": [len(counted) for counted in loads.values()],
        "of these, with a file half written": [sum(left.writing for left in stops) for stops in found.values()],
    }
    lines = [
        "# Killed runs",
        "",
        f"comminute {cm.__version__}; written by `tests/support/kills.py`, which `make check-long` runs.",
        f"`comminute run` of {LOADS} loads and the `--resume` after it, each stopped at a random moment from its start",
        "to past its end, by SIGKILL or by Ctrl-C; every other time with `--force` over an earlier result. After each",
        "stop every earlier file is as it was, byte for byte, and the loads that are kept are those of an",
        "uninterrupted run, bit for bit; so is the whole result when the last resumption has come to its end, and",
        f"nothing is left behind. Ctrl-C, wherever it falls, ends the run with exit code {STOPPED}, before its result",
        "is written.",
        "",
        f"| stops | {' | '.join(loads)} |",
        f"|---|{'---|' * len(loads)}",
        *(f"| {name} | {' | '.join(map(str, row))} |" for name, row in counts.items()),
        "",
        *(f"Finished loads after each {way}: {', '.join(map(str, counted))}.\n" for way, counted in loads.items()),
        *failures,
        *([""] if failures else []),
        f"Failures: {len(failures)}.",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1])))

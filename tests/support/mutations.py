"""Inputs gone wrong: mutated sieve tables, case files and result files, and the one rule for what may come of them.

As a script: `python tests/support/mutations.py CSV TOML NETCDF [LAB]`, the numbers of inputs of each kind; every input
is read in a child process, so that a crash or a hang of a library below is found as one. The kind `lab` is not
mutated: its tables are written in the styles of laboratories, and rows given must be rows read, or the table refused.
"""

from __future__ import annotations

import math
import random
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from lab_tables import table

import comminute as cm

SANDS = Path(__file__).parents[2] / "examples" / "sands"
SECONDS = 20  # more than any reading takes; what takes longer hangs
BATCH = 2000
LAB_SEEDS = 60  # tables in the styles of laboratories among the good ones
LONG = 100_000  # inputs in all, from which on the run writes its report
REPORT = Path(__file__).parents[2] / "docs" / "validation" / "mutated-inputs.md"
TOKENS = [b"", b"nan", b"inf", b"-1", b"0", b"1e999", b"1e-999", b"1e300", b"pan", b"\x00", b"\xff", b"\n", b"\r", b'"']
TOKENS += [b",", b";", b"\t", b"#", b"=", b"[", b"]", b"{", b"}", b"'", b"true", b"[1, 2]", b"9" * 400, "µ".encode()]
TOKENS += [
    b"weibull_modulus",
    b"size_mm",
    b"percent_retained",
    b"1979-05-27",
    b"0x10",
    b"1_000",
    b"[[material]]",
    b"100",
]
EXTRA_CASE = b"""
[units]
size = "mm"
[material]
weibull_modulus = 3.0
fabric_width = 0.05
reference_size = 2.0
first_crush_stress = 1.2
fragments = { law = "lognormal", mean_log = -1.0, sd_log = 0.5 }
[grading]
kind = "lognormal"
median = 0.5
sd_log = 0.4
[grid]
bins = 100
psi_min = -7.0
[load]
stress = { from = 1.2, to = 120.0, steps = 5, spacing = "log" }
loading_rate = [0.0, 0.0, 0.1, 0.2, 0.3]
remix_after = [1]
[engine]
scheme = "paper"
steps_per_load = 3
[output]
file = "run.nc"
fabrics = [0, 4]
"""


def seeds(kind: str) -> list[bytes]:
    """Good inputs of a kind."""
    if kind == "csv":
        plain = [path.read_bytes() for path in sorted(SANDS.glob("*.csv"))]
        return [
            *plain,
            *(table(random.Random(number)).text.encode() for number in range(LAB_SEEDS)),
            b"size_um;mass_retained_g\n2000;0\n1000;30,5\n500;50\npan;19,5\n",
            b"phi,percent_retained\n-1,0\n0,99\npan,1\n",
        ]
    if kind == "toml":
        return [*(path.read_bytes() for path in sorted(SANDS.glob("*.toml"))), EXTRA_CASE]
    with tempfile.TemporaryDirectory() as folder:
        result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1), grid=cm.LogGrid(-4.0, 0.0, 60)).run(
            stress_ratio=[1, 8]
        )
        return [result.save(Path(folder, "run.nc")).read_bytes()]


def mutated(data: bytes, chance: random.Random, *, binary: bool = False) -> bytes:
    """Change data in one to four places."""
    for _ in range(chance.choice((1, 1, 2, 4))):
        at = chance.randrange(len(data) + 1)
        way = chance.randrange(7)
        if way == 0 or (binary and way < 4):
            data = data[:at] + bytes([chance.randrange(256)]) + data[at + 1 :]
        elif way == 1:
            data = data[:at] + chance.choice(TOKENS) + data[at:]
        elif way == 2:
            data = data[:at] + chance.choice(TOKENS) + data[at + chance.randrange(8) :]
        elif way == 3:
            data = data[:at] + data[at + 1 + chance.randrange(12) :]
        elif way == 4:
            data = data[:at]
        elif way == 5:
            lines = data.split(b"\n")
            chance.shuffle(lines)
            data = b"\n".join(lines)
        else:
            end = at + chance.randrange(40)
            data = data[:end] + data[at:]
    return data


def read_csv(path: Path) -> None:
    """Read a sieve table; what is read must be a grading."""
    grading = cm.Grading.read(path)
    sizes = np.geomspace(max(grading.largest * 1e-3, 1e-300), grading.largest, 20)
    finer = grading.finer(sizes)
    assert np.all(np.isfinite(finer)), "finer is not finite"
    assert np.all(np.diff(finer) >= -1e-12), "finer falls"
    assert finer[-1] == 1.0, "the largest grain is not the largest"
    table = grading.to_sieves(cm.SizeCurve.of(grading).size)
    assert math.isclose(table.percent_retained.sum() + table.pan, 100.0, abs_tol=1e-9), "mass is lost"


def read_lab(number: int, path: Path) -> bool:
    """Tell whether a table in a laboratory's style is read; what is read must have its rows, each with its values."""
    from comminute.gradings.reading import read_sieves  # noqa: PLC0415
    from comminute.gradings.sieves import convert  # noqa: PLC0415
    from comminute.gradings.values import as_per_cent  # noqa: PLC0415

    made = table(random.Random(number))
    path.write_text(made.text, encoding="utf-8")
    try:
        data = read_sieves(path)
    except cm.ParameterError as error:
        return words_of_refusal(error)
    sizes = [convert(size, data.unit, "mm") for size in data.size]
    found = sorted(zip(sizes, as_per_cent(list(data.percent_finer)), strict=True))
    wanted = sorted(zip(made.size, made.finer, strict=True))
    for (size, finer), (size_there, finer_there) in zip(found, wanted, strict=True):
        assert math.isclose(size, size_there, rel_tol=1e-9), "a sieve has another size"
        assert math.isclose(finer, finer_there, abs_tol=1e-6), "a sieve has another share"
    return True


def read_toml(path: Path) -> None:
    """Read a case; what is read must survive its own text."""
    from comminute.cases.reading import case_of_text, read_case  # noqa: PLC0415  (pydantic is optional)

    for ready in read_case(path)[:3]:
        again = case_of_text(ready.text(), ready.target)
        assert again.grading == ready.grading, "the resolved case has another grading"
        assert again.grid == ready.grid, "the resolved case has another grid"


def read_nc(path: Path) -> None:
    """Read a result; what is read without a warning must be the one that was saved."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", cm.EditedFileWarning)
        found = cm.open_result(path)
    if any(issubclass(warning.category, cm.EditedFileWarning) for warning in told):
        return
    global _saved  # noqa: PLW0603  (made once a process)
    if _saved is None:
        _saved = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1), grid=cm.LogGrid(-4.0, 0.0, 60)).run(
            stress_ratio=[1, 8]
        )
    assert found == _saved, "a damaged file was read as another result"


_saved: cm.Result | None = None
READERS: dict[str, Callable[[Path], None]] = {"csv": read_csv, "toml": read_toml, "nc": read_nc}


def try_one(kind: str, data: bytes, folder: Path) -> bool:
    """Tell whether an input was read; anything but a good result or an error in one line of words raises."""
    path = folder / f"case.{kind}"
    path.write_bytes(data)
    try:
        READERS[kind](path)
    except cm.ParameterError as error:
        return words_of_refusal(error)
    return True


def words_of_refusal(error: cm.ParameterError) -> bool:
    """Give False, for an input that is not read, after a look at the message: one line of words."""
    message = str(error)
    assert message.isprintable(), f"the message is not one line of text: {message!r}"
    assert len(message) < 600, f"the message has {len(message)} characters"
    return False


def batch(kind: str, first: int, count: int) -> None:
    """Try inputs number `first` and on; the number is the seed of the mutation."""
    good = [] if kind == "lab" else seeds(kind)
    read = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in SANDS.glob("*.csv"):
            (folder / path.name).write_bytes(path.read_bytes())
        for number in range(first, first + count):
            print(number, file=sys.stderr)
            signal.alarm(SECONDS)
            if kind == "lab":
                read += read_lab(number, folder / "lab.csv")
            else:
                chance = random.Random(number)
                read += try_one(kind, mutated(chance.choice(good), chance, binary=kind == "nc"), folder)
            signal.alarm(0)
    print(read)


def main(counts: dict[str, int]) -> int:
    """Try so many inputs of each kind, in child processes; report and return the number of failures."""
    failures, lines = 0, list[str]()
    for kind, count in counts.items():
        read = 0
        for first in range(0, count, BATCH):
            call = [sys.executable, __file__, "--batch", kind, str(first), str(min(BATCH, count - first))]
            done = subprocess.run(call, capture_output=True, text=True, check=False)
            if done.returncode == 0:
                read += int(done.stdout)
                continue
            failures += 1
            number = next((line for line in reversed(done.stderr.splitlines()) if line.isdecimal()), "?")
            reason = done.stderr.splitlines()[-1] if done.stderr else ""
            lines.append(f"{kind} input {number}: exit code {done.returncode}, {reason}")
            print(lines[-1])
        made = "tables in styles of laboratories" if kind == "lab" else "mutated inputs"
        lines.append(f"{kind}: {count} {made}, {read} read, the others refused in words")
        print(lines[-1])
    if sum(counts.values()) >= LONG:
        REPORT.write_text(page(lines, failures), encoding="utf-8")
    return failures


def page(lines: list[str], failures: int) -> str:
    """Page for the documentation."""
    head = [
        "# Mutated inputs",
        "",
        f"comminute {cm.__version__}; written by `tests/support/mutations.py`, which `make check-long` runs. Sieve",
        "tables, case files and result files with bytes, tokens or lines changed: each is read right or refused in",
        "words, never with a crash, a hang or another exception.",
        "",
    ]
    return "\n".join([*head, *(f"* {line}" for line in lines), "", f"Failures: {failures}."]) + "\n"


if __name__ == "__main__":
    warnings.simplefilter("error")
    warnings.filterwarnings("ignore", category=DeprecationWarning)
    if sys.argv[1] == "--batch":
        batch(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
    else:
        sys.exit(main(dict(zip(("csv", "toml", "nc", "lab"), (int(word) for word in sys.argv[1:5]), strict=False))))

"""The C++ hot loops with their flops and bytes, where Google Benchmark is installed."""

from __future__ import annotations

import json
import subprocess
from typing import Any

from contestants.bare_fftw import BUILT
from report import in_words

SECONDS_OF = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
PROGRAM = BUILT.with_name("hot_loops")


def measured() -> list[dict[str, Any]]:
    """Run them all; empty where they were not built. Rates are per second of processor time."""
    if not PROGRAM.exists():
        return []
    done = subprocess.run(
        [str(PROGRAM), "--benchmark_format=json", "--benchmark_min_time=0.3"],
        check=True,
        capture_output=True,
        text=True,
    )
    rows: list[dict[str, Any]] = json.loads(done.stdout)["benchmarks"]
    wrong = [row["name"] for row in rows if row.get("error_occurred")]
    if wrong:
        raise SystemExit(f"wrong answers in {', '.join(wrong)}")
    return rows


def table(rows: list[dict[str, Any]]) -> list[str]:
    """Lines of Markdown."""
    lines = [
        "## Flops and bytes",
        "",
        "Flops are the additions and multiplications of the algorithm, bytes what must be read or written at least,",
        "both derived in `bench/cpp/hot_loops.cpp`. `copy_state` is the rate at which memory, or the cache that holds",
        "the state, gives and takes. Per second of processor time. `slow_update` is counted as pushes, which its",
        "running sums undercut; the two solves find their zone as they left it.",
        "",
        "| loop / N or M | processor time | Gflop/s | GB/s | flops a byte |",
        "|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row['name']} | {in_words(row['cpu_time'] * SECONDS_OF[row['time_unit']])} | {row['flops'] / 1e9:.2f} "
            f"| {row['bytes'] / 1e9:.2f} | {row['flops/byte']:.2f} |"
        )
    return [*lines, ""]

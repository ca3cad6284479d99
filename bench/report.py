"""Outcomes as JSON, as a Markdown page and as plots of cost against N."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

from harness import OURS, PER_SECOND, SECONDS, Figure, Outcome, Times, exponent

HOW = """\
Every figure comes from one run of `make bench` on one machine. Before a trial is timed, the answer of every contestant
is held against comminute's; the largest difference found and the one allowed are listed with it, and one wrong answer
stops the run. Then the contestants take turns (A B C A B C …), at least 7 rounds, or one where a round takes over 10 s;
the first round of the quick ones warms up and is not counted. Times are medians with quartiles; ratios are medians of
the ratios round by round. One thread each, unless the trial is about threads, and the portable build that `pip install`
makes.

| contestant | what it is |
|---|---|
| O(N^4) sum | the paper's Eq. 61 as it stands, the kernel assembled in NumPy for each load and applied by BLAS |
| SciPy | separable convolutions by SciPy's FFT, the filter's spectrum kept, block by block for the cache's sake |
| Numba push | each active cell hands its mass down its row or column in compiled loops along memory |
| bare FFTW | each of the step's 3 N lines transformed there and back at length 2 N, and nothing else, in the cache |
| copy | memcpy of the state, what anything out of place must do at the least |
| Numba heap, Python heap | the lattice event by event, weakest cell first, from a binary heap |
| Python passes | the lattice by passes over all cells at rising loads |

Where a choice was open it fell in the peer's favour: zones, fragments or the start ready made, random numbers of its
own language, the smaller ring. What is timed of comminute is what a user calls, checks of the input included. Goals
were set before the first run; those missed are listed with the others."""

LIMITS = """\
## What stands in the way of the rest

* **Slow update.** A crushed cell's fragments reach every finer cell of its line, so after a step of many active
  cells all N² numbers are new: no step takes less than a pass over the state, and at N = 1000 a copy of it already
  costs more than 1/20 of our FFTW step, which skips lines without mass and takes the shortest transform for each of
  the others. What is left above the copy are the K terms of every cell.
* **Grading at N = 1000.** An arm of the zone has some 26 cells here, each with K = 11 terms along either line, 6
  flops a term: 3.7 Mflop, half of the time. The shares of the cells that the zone cuts take a tenth; what is left
  are a thousand diagonal cells and the ends of loops, since an arm is three or four registers long.
  The yardstick is at its best there: both copies of an 8 MB state fit into the cache of this machine. At N = 4000,
  where the copy comes from memory, the goal is met.
* **State at N = 1000.** It is read, copied, and given K falling terms a cell; with N the copy grows as fast and the
  terms that still count become fewer.
* **Whole path.** A load costs a zone, a sweep and the bookkeeping of a result, tens of microseconds; 10⁴ × would
  leave three to four for all of it.
* **Plain Python lattice.** Passes at loads that rise by half are a generous peer, and right only to the error
  listed; each crush of ours draws a fragment (three transcendental functions) and takes three critical loads anew,
  from a state that does not fit into the cache."""

PENDING = "No run is recorded here yet: `make bench` on a quiet machine, then `--page docs/benchmarks.md`, writes it."


def in_words(seconds: float) -> str:
    """Three digits and a unit."""
    for unit, factor in (("s", 1.0), ("ms", 1e3), ("µs", 1e6)):
        if seconds * factor >= 1.0:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def _value(value: float) -> str:
    return f"{value:.3g}" if value < 1e4 else f"{value:.2e}"


def _hoped_for(figure: Figure) -> str:
    goal = figure.goal
    measured = f"{_value(figure.value)} ({_value(figure.lower)} … {_value(figure.upper)})"
    what = f"{goal.over}, {goal.under}" if goal.under in {PER_SECOND, SECONDS} else f"{goal.over} / {goal.under}"
    return f"| {goal.text} | {what} | {measured} | {'yes' if figure.met else 'no'} |"


def _goals(outcomes: list[Outcome]) -> list[str]:
    lines = ["| trial | goal | what | median (quartiles) | met |", "|---|---|---|---|---|"]
    for outcome in outcomes:
        lines += [f"| {outcome.trial.title} {_hoped_for(figure)}" for figure in outcome.figures]
    return lines


def _trial(outcome: Outcome) -> list[str]:
    trial = outcome.trial
    per = f" a {trial.unit}" if trial.unit else ""
    lines = [f"### {trial.title}", ""]
    if trial.note:
        lines += [f"{trial.note[0].upper()}{trial.note[1:]}.", ""]
    if outcome.times:
        first = next(iter(outcome.times.values())).median
        lines += [f"| contestant | median{per} | quartiles | × comminute | rounds |", "|---|---|---|---|---|"]
        for name, times in outcome.times.items():
            lines.append(
                f"| {name} | {in_words(times.median)} | {in_words(times.lower)} … {in_words(times.upper)} "
                f"| {_value(times.median / first)} | {times.rounds} |"
            )
        lines.append("")
    answers = "; ".join(f"{check.what} {check.error:.1e} (≤ {check.limit:.0e})" for check in trial.checks)
    return [*lines, f"Answers: {answers}.", ""]


def curves(outcomes: list[Outcome]) -> dict[str, dict[str, tuple[list[int], list[Times]]]]:
    """Cost against N, by case and contestant, where there are three sizes or more."""
    found: dict[str, dict[str, tuple[list[int], list[Times]]]] = defaultdict(lambda: defaultdict(lambda: ([], [])))
    for outcome in outcomes:
        if outcome.trial.size is None:
            continue
        for name, times in outcome.times.items():
            sizes, costs = found[outcome.trial.case][name]
            sizes.append(outcome.trial.size)
            costs.append(times)
    kept = {case: {n: c for n, c in by_name.items() if len(set(c[0])) >= 3} for case, by_name in found.items()}
    return {case: by_name for case, by_name in kept.items() if by_name}


def power_of_two(size: int) -> bool:
    """Sizes that are left out of fits, since their strides may be unlucky."""
    return size & (size - 1) == 0


def growth(outcomes: list[Outcome]) -> list[dict[str, object]]:
    """Fitted exponents; powers of two are left out of the fit and compared with it."""
    rows: list[dict[str, object]] = []
    steepest = {(outcome.trial.case, OURS): outcome.trial.steepest for outcome in outcomes}
    for case, by_name in curves(outcomes).items():
        for name, (sizes, times) in by_name.items():
            plain = [(n, t.median) for n, t in zip(sizes, times, strict=True) if not power_of_two(n)]
            if len(plain) < 3:
                continue
            slope = exponent([n for n, _ in plain], [t for _, t in plain])
            nearest = {n: min(plain, key=lambda p, n=n: abs(p[0] - n)) for n in sizes if power_of_two(n)}  # type: ignore[misc]
            bumps = [
                t.median / (nearest[n][1] * (n / nearest[n][0]) ** slope)
                for n, t in zip(sizes, times, strict=True)
                if power_of_two(n)
            ]
            rows.append(
                {
                    "case": case,
                    "contestant": name,
                    "from": plain[0][0],
                    "to": plain[-1][0],
                    "exponent": slope,
                    "steepest": steepest.get((case, name)),
                    "bump": max(bumps) if bumps else None,
                }
            )
    return rows


def markdown(outcomes: list[Outcome], machine: dict[str, str], plots: list[str], more: list[str]) -> str:
    """Write the whole page; `plots` as they are to be linked, `more` between them and the trials."""
    lines = ["# Benchmarks", "", HOW, ""]
    if not outcomes:
        return "\n".join([*lines, PENDING, ""])
    lines += ["## Machine", ""]
    lines += ["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in machine.items()), ""]
    lines += ["## Goals", "", *_goals(outcomes), "", LIMITS, ""]
    rows = growth(outcomes)
    if rows:
        lines += [
            "## Growth",
            "",
            "Exponent of cost against N by least squares in logs. The bump is the largest cost at a power of two over",
            "that at the next size, scaled to it by the fit.",
            "",
            "| case | contestant | N | exponent | hoped for | bump |",
            "|---|---|---|---|---|---|",
        ]
        for row in rows:
            bump = "" if row["bump"] is None else f"{row['bump']:.2f}"
            hoped_for = "" if row["steepest"] is None else f"≤ {row['steepest']}"
            lines.append(
                f"| {row['case']} | {row['contestant']} | {row['from']} … {row['to']} "
                f"| {row['exponent']:.2f} | {hoped_for} | {bump} |"
            )
        lines.append("")
    lines += [f"![Cost against N: {Path(plot).stem.replace('-', ' ')}]({plot})" for plot in plots]
    lines += ["", *more, "## Trials", ""]
    for outcome in outcomes:
        lines += _trial(outcome)
    return "\n".join(lines).rstrip() + "\n"


def write_json(path: Path, outcomes: list[Outcome], machine: dict[str, str], loops: list[dict[str, Any]]) -> None:
    """Everything that was measured."""
    content = {
        "machine": machine,
        "growth": growth(outcomes),
        "hot loops": loops,
        "trials": [outcome.as_json() for outcome in outcomes],
    }
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")

"""Trials: how answers are held against each other, and how contestants are timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

LEAST_ROUNDS = 7
MOST_ROUNDS = 51
LONG_ROUND = 10.0  # seconds; a round that takes longer is run once
BUDGET = 6.0  # seconds of rounds beyond the least number of them

OURS = "comminute"
PER_SECOND, SECONDS = "per second", "seconds"


class WrongAnswerError(SystemExit):
    """A contestant's answer is further from comminute's than stated; nothing of its trial is timed."""


@dataclass(frozen=True)
class Check:
    """Distance of two answers, and the most it may be."""

    what: str
    error: float
    limit: float

    @property
    def passed(self) -> bool:
        """Tell whether the answers are the same to the stated error; NaN is not."""
        return self.error <= self.limit


@dataclass(frozen=True)
class Contestant:
    """Something that solves a trial's problem."""

    name: str
    run: Callable[[], object]
    before: Callable[[], object] | None = None  # ahead of every run, not timed
    work: float = 1.0  # units of work in one run; figures are given per unit
    seconds: Callable[[], float] | None = None  # times itself, in place of `run`'s wall time (other processes)


@dataclass(frozen=True)
class Goal:
    """A ratio of two contestants' times, or the speed or time of one, and what was hoped for."""

    text: str
    over: str
    under: str  # another contestant, or PER_SECOND or SECONDS for `over` alone, a unit of work
    least: float | None = None
    most: float | None = None

    def met(self, value: float) -> bool:
        """Tell whether a figure reaches the goal."""
        return (self.least is None or value >= self.least) and (self.most is None or value <= self.most)


@dataclass
class Trial:
    """One problem at one size, its contestants, and the checks of their answers, made before anything is timed."""

    case: str
    title: str
    contestants: list[Contestant]
    checks: list[Check]
    goals: list[Goal] = field(default_factory=list)
    size: int | None = None  # for the plots of cost against N
    steepest: float | None = None  # exponent hoped for of comminute's cost against N
    unit: str = ""  # what one unit of work is, where a run does many
    note: str = ""
    between_rounds: Callable[[int], object] | None = None  # given the number of the round, not timed


@dataclass(frozen=True)
class Times:
    """Seconds a unit of work, over the rounds."""

    rounds: int
    median: float
    lower: float
    upper: float

    @classmethod
    def of(cls, values: list[float]) -> Times:
        """Median and quartiles."""
        lower, median, upper = np.quantile(values, [0.25, 0.5, 0.75])
        return cls(len(values), float(median), float(lower), float(upper))


@dataclass(frozen=True)
class Figure:
    """A goal with what came of it; quartiles are of the ratios round by round, which a drift of the clock spares."""

    goal: Goal
    value: float
    lower: float
    upper: float

    @property
    def met(self) -> bool:
        """Tell whether the median reaches the goal."""
        return self.goal.met(self.value)


@dataclass
class Outcome:
    """A trial after its run; `times` is empty in the short form."""

    trial: Trial
    times: dict[str, Times]
    figures: list[Figure]

    def as_json(self) -> dict[str, Any]:
        """Plain numbers and words."""
        trial = self.trial
        return {
            "case": trial.case,
            "title": trial.title,
            "size": trial.size,
            "unit": trial.unit,
            "note": trial.note,
            "checks": [{"what": c.what, "error": c.error, "limit": c.limit} for c in trial.checks],
            "seconds": {name: vars(times) for name, times in self.times.items()},
            "goals": [
                {"goal": vars(f.goal), "value": f.value, "lower": f.lower, "upper": f.upper, "met": f.met}
                for f in self.figures
            ],
        }


def largest_difference(a: object, b: object) -> float:
    """Largest difference of two arrays, entry by entry."""
    return float(np.abs(np.asarray(a) - np.asarray(b)).max())


def verify(trial: Trial) -> None:
    """Stop everything if an answer is wrong."""
    if not trial.checks:
        raise WrongAnswerError(f"{trial.title}: nothing is checked")
    for check in trial.checks:
        if not check.passed:
            raise WrongAnswerError(
                f"{trial.title}: {check.what} is off by {check.error:.2e}; {check.limit:.0e} is allowed"
            )


def _seconds(contestant: Contestant) -> float:
    if contestant.before is not None:
        contestant.before()
    if contestant.seconds is not None:
        return contestant.seconds()
    begin = time.perf_counter()
    contestant.run()
    return time.perf_counter() - begin


def _round(trial: Trial, number: int) -> list[float]:
    if trial.between_rounds is not None:
        trial.between_rounds(number)
    return [_seconds(contestant) / contestant.work for contestant in trial.contestants]


def _figure(goal: Goal, columns: dict[str, list[float]]) -> Figure:
    values = columns[goal.over]
    if goal.under == PER_SECOND:
        values = [1.0 / seconds for seconds in values]
    elif goal.under != SECONDS:
        values = [a / b for a, b in zip(values, columns[goal.under], strict=True)]
    lower, median, upper = np.quantile(values, [0.25, 0.5, 0.75])
    return Figure(goal, float(median), float(lower), float(upper))


def timed(trial: Trial) -> Outcome:
    """Let the contestants of a checked trial take turns."""
    begin = time.perf_counter()
    rounds = [_round(trial, 0)]
    took = time.perf_counter() - begin
    if took < LONG_ROUND:
        # The first round warmed the caches and the pages, and is not counted.
        count = int(np.clip(BUDGET / took, LEAST_ROUNDS, MOST_ROUNDS))
        rounds = [_round(trial, 1 + number) for number in range(count)]
    names = [contestant.name for contestant in trial.contestants]
    columns = {name: [times[k] for times in rounds] for k, name in enumerate(names)}
    return Outcome(
        trial,
        {name: Times.of(values) for name, values in columns.items()},
        [_figure(goal, columns) for goal in trial.goals],
    )


def run(trial: Trial, mode: Literal["check", "time"]) -> Outcome:
    """Check a trial and, unless that is all, time it."""
    verify(trial)
    return Outcome(trial, {}, []) if mode == "check" else timed(trial)


def exponent(sizes: list[int], seconds: list[float]) -> float:
    """Slope of log cost against log N, by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])

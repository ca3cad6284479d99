"""Compare comminute with its peers: every answer first, then the time it takes. See README.md beside this file.

python bench/compare.py                 all cases; writes out/bench/benchmarks.{json,md} and plots
python bench/compare.py --short         small sizes, answers alone, a few seconds
python bench/compare.py lattice batch   these cases only
"""

import argparse
import importlib
import os
import shutil
import sys
import time
from pathlib import Path

# Before NumPy and Numba read them: one thread each, or the comparison is about thread pools.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

CASES = ["convolution", "increments", "quasi_static", "growth", "whole_path", "batch", "response", "lattice"]
CASES += ["resolved", "column", "sweep", "cold_start"]


def parsed(arguments: list[str]) -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description="Compare comminute with its peers.")
    parser.add_argument("cases", nargs="*", metavar="case", help=f"one of {', '.join(CASES)}; all if left out")
    parser.add_argument("--short", action="store_true", help="small sizes, check answers only")
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="directory for results")
    parser.add_argument(
        "--page", type=Path, help="write the page here too, its pictures into images/benchmarks beside it"
    )
    options = parser.parse_args(arguments)
    for case in options.cases:
        if case not in CASES:
            parser.error(f"no case is called {case}; there are {', '.join(CASES)}")
    return options


def main(arguments: list[str]) -> None:
    """Run the cases and write what came of them."""
    options = parsed(arguments)
    from harness import run
    from machine import describe
    from report import markdown, write_json

    machine = describe()
    outcomes = []
    begin = time.perf_counter()
    for name in options.cases or CASES:
        for trial in importlib.import_module(f"cases.{name}").trials(options.short):
            outcome = run(trial, "check" if options.short else "time")
            outcomes.append(outcome)
            print(f"{time.perf_counter() - begin:7.1f} s  {trial.title}: {len(trial.checks)} answers agree", flush=True)
            for figure in outcome.figures:
                print(f"{'':11}{figure.goal.text}: {figure.value:.3g}{'' if figure.met else '  (missed)'}")
            trial.contestants.clear()  # and with them the arrays they hold
    if options.short:
        return
    options.out.mkdir(parents=True, exist_ok=True)
    machine["load average"] += f" before, {os.getloadavg()[0]:.2f} after"
    from hot_loops import measured, table
    from plots import plot  # matplotlib is slow to load, and the short form draws nothing

    drawn = plot(options.out, outcomes)
    loops = [] if options.cases else measured()
    write_json(options.out / "benchmarks.json", outcomes, machine, loops)
    more = table(loops) if loops else []
    page = markdown(outcomes, machine, [picture.name for picture in drawn], more)
    (options.out / "benchmarks.md").write_text(page, encoding="utf-8")
    print(f"wrote {options.out}/benchmarks.md")
    if options.page is not None:
        images = options.page.parent / "images" / "benchmarks"
        images.mkdir(parents=True, exist_ok=True)
        for picture in drawn:
            shutil.copy(picture, images)
        links = [f"images/benchmarks/{picture.name}" for picture in drawn]
        options.page.write_text(markdown(outcomes, machine, links, more), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])

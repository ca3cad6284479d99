"""The command on sweeps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from comminute._core import ParameterError, __version__
from comminute.cli.base import STOPPED, Force, Json, Percentiles, app, plain_errors, refuse_existing, stop
from comminute.cli.tables import percents_of
from comminute.cli.texts import ProgressBar
from comminute.sweeping.layout import PERCENTS, Value, growing
from comminute.sweeping.sweep import Sweep, sweep
from comminute.util.errors import OutputExistsError, parameter_error

NAMED = 5  # members that are named of those that failed or warn


@app.command(name="sweep")
@plain_errors
def sweep_command(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml")],
    over: Annotated[
        list[str] | None,
        typer.Option("--over", help="KEY=VALUE,VALUE,... such as material.fabric_width=0.1,0.2; again for more."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Store: .zarr, or .nc when all members are there.")
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--table", help="Table of the members after the last load: .csv.")
    ] = None,
    jobs: Annotated[int, typer.Option("--jobs", "-j", help="Threads.")] = 1,
    percentiles: Percentiles = None,
    chunk: Annotated[int | None, typer.Option("--chunk", help="Members that are written together.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with a sweep that was stopped.")] = False,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Run a case with many values of some of its keys, into one store.

    Lists in the case in place of single values vary too, and all combinations are run. Members that fail are kept with
    the reason.
    """
    store = output or case.with_suffix(".zarr")
    if table is not None:
        if table.suffix != ".csv":
            raise parameter_error("--table", f"'{table}'", "it must end in .csv")
        refuse_existing(table, force or resume)
    kept = [path for path in (growing(store), store) if path.exists()]
    if kept and not (resume or force):
        raise OutputExistsError(f"{kept[0]} exists; --resume goes on with it, --force throws it away")
    percents = percents_of(percentiles) if percentiles else PERCENTS
    values = dict(_values(text) for text in over or [])
    with ProgressBar("member", quiet=as_json) as bar:
        try:
            found = sweep(
                case,
                values,
                store=store,
                jobs=jobs,
                percents=percents,
                chunk=chunk,
                resume=resume,
                force=force,
                on_chunk=bar.reach,
            )
        except KeyboardInterrupt:
            stop(f"interrupted; what is finished is kept, and --resume goes on with {store}", STOPPED)
    if table is not None:
        found.to_pandas().to_csv(table)
    if as_json:
        print(json.dumps(_record(found)))
        return
    for line in _lines(found):
        print(line)
    print(f"wrote {store}" + (f" and {table}" if table else ""))


def _values(text: str) -> tuple[str, list[Value]]:
    """Key and values of "key=value,value"."""
    key, equals, values = text.partition("=")
    if not equals or not values or "." not in key:
        raise parameter_error(
            "--over", f"'{text}'", "it must be KEY=VALUE,VALUE,... such as material.fabric_width=0.1,0.2"
        )
    return key, [_value(value) for value in values.split(",")]


def _value(text: str) -> Value:
    """Value of a word: a number, true or false, or the word."""
    if text in ("true", "false"):
        return text == "true"
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text


def _lines(found: Sweep) -> list[str]:
    """Say how many members there are, over what, and what is wrong with some."""
    failed, warned = found.failed, found.warned
    lines = [
        f"{len(found)} members over {', '.join(found.keys)}: {len(found) - len(failed)} done, {len(failed)} failed"
    ]
    for what, members in (("failed", failed), ("not to be trusted throughout", warned)):
        lines += [f"  member {k} {what}: {text}" for k, text in list(members.items())[:NAMED]]
        if len(members) > NAMED:
            lines.append(f"  and {len(members) - NAMED} more")
    for name in ("breakage", "D50"):
        try:
            last = found.values(name)[:, -1]
        except ParameterError:
            continue
        known = last[np.isfinite(last)]  # NaN where there is none
        if known.size:
            lines.append(f"{name} after the last load: {known.min():.4g} to {known.max():.4g}")
    return lines


def _record(found: Sweep) -> dict[str, object]:
    """Everything that `sweep --json` says."""
    return {
        "version": __version__,
        "store": str(found.path),
        "members": len(found),
        "keys": list(found.keys),
        "failed": {str(k): text for k, text in found.failed.items()},
        "warned": {str(k): text for k, text in found.warned.items()},
    }

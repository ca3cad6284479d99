"""The command line: cases in, tables and files out. Needs typer and pydantic."""

from __future__ import annotations

import json

from comminute.cli import on_cases, on_gradings, on_sweeps  # noqa: F401  (their commands join the application)
from comminute.cli import texts as cli_texts
from comminute.cli.base import Json, app, plain_errors

__all__ = ["app"]


@app.command()
@plain_errors
def cite() -> None:
    """Print what to cite."""
    print(cli_texts.citation())


@app.command()
@plain_errors
def doctor(as_json: Json = False) -> None:
    """Print versions and what this installation can do."""
    found = cli_texts.installation()
    print(json.dumps(found) if as_json else "\n".join(f"{name:12} {value}" for name, value in found.items()))

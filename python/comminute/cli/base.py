"""The command line's application: how commands stop, and the options that they share. Needs typer."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Annotated, NoReturn, ParamSpec

import typer

from comminute._core import ParameterError, ShapeError, UnavailableError, __version__, defaults
from comminute.cli import texts as cli_texts
from comminute.util.errors import OutputExistsError, parameter_error
from comminute.util.names import shorten

WRONG_INPUT, EXISTS, FAILED, MISSING_EXTRA, STOPPED = 2, 3, 4, 5, 130
P = ParamSpec("P")

app = typer.Typer(
    name="comminute",
    help=cli_texts.HELP,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
SIEVES = defaults["from_sieves"]
Number = Annotated[bool, typer.Option("--number", help="The shares of the sieve table count grains.")]
Top = Annotated[str, typer.Option("--top", help='"extend" closes a sieve curve short of 100 %.')]
SheetName = Annotated[str | None, typer.Option("--sheet", help="Sheet of a workbook, by name or number from 1.")]
Sample = Annotated[str | None, typer.Option("--sample", help="Sample of a table of several.")]
Mesh = Annotated[str | None, typer.Option("--mesh", help="Series of sieve numbers: astm (E11) or tyler.")]
TotalMass = Annotated[float | None, typer.Option("--total-mass-g", help="Dry mass before washing [g].")]
Edges = Annotated[str | None, typer.Option("--edges", help="Edge of its class that a size is: lower or upper.")]
Percentiles = Annotated[
    str | None, typer.Option("--percentiles", help="Sizes D_x wanted, as per cent with commas: 10,50,90.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]


def stop(message: str, code: int) -> NoReturn:
    """End the command with a message and an exit code."""
    print(f"error: {message}", file=sys.stderr)
    raise typer.Exit(code)


def plain_errors(command: Callable[P, None]) -> Callable[P, None]:
    """Turn what a command may raise into one line and an exit code."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except (ParameterError, ShapeError) as error:
            stop(str(error), WRONG_INPUT)
        except OutputExistsError as error:
            stop(str(error), EXISTS)
        except (ImportError, UnavailableError) as error:
            stop(str(error), MISSING_EXTRA)
        except MemoryError:
            stop("the memory does not suffice; take fewer bins or keep fewer fabrics", FAILED)
        except BrokenPipeError:
            sys.stderr.close()  # the reader has gone, as `| head` does; nobody is left to tell
            raise typer.Exit from None
        except OSError as error:
            stop(f"{error.filename or 'a file'}: {error.strerror or error}", FAILED)
        except KeyboardInterrupt:
            stop("interrupted", STOPPED)

    return run


def plots(what: str) -> ModuleType:
    """Import the module that draws; the error names the extra where matplotlib is missing."""
    try:
        from comminute.cli import plots  # noqa: PLC0415  (matplotlib is optional)
    except ImportError as error:
        message = f"{what} needs matplotlib; install it with: pip install 'comminute[plot]'"
        raise ImportError(message) from error
    return plots


def require_writable(output: Path, endings: Sequence[str]) -> None:
    """Refuse a file of another ending, or in a folder that does not exist."""
    if output.suffix not in endings:
        raise parameter_error("--output", f"'{output}'", f"it must end in {', '.join(endings)}")
    if not output.parent.is_dir():
        raise parameter_error("--output", f"'{output}'", "its folder does not exist")


def refuse_existing(file: Path, force: bool) -> None:
    """Refuse to overwrite a file unless that is asked for."""
    if file.exists() and not force:
        raise OutputExistsError(f"{shorten(str(file), 200)} exists; --force overwrites it")


@app.callback(invoke_without_command=True)
def _version(show: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if show:
        print(__version__)
        raise typer.Exit

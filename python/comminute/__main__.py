"""The command `comminute`; says what to install where the extra `cli` is missing."""

from __future__ import annotations

import sys

from comminute.util.whole_files import uninterrupted

NEEDED = ("typer", "pydantic", "xarray", "h5netcdf", "h5py")
ABORTED, MISSING_EXTRA, STOPPED = 1, 5, 130  # the first is click's own, for Ctrl-C before a command has begun


def main() -> None:
    """Run the command line."""
    try:
        with uninterrupted():  # libraries that are being loaded may not survive it
            from comminute.cli.app import app  # noqa: PLC0415  (its libraries are optional)
    except ImportError as error:
        if (error.name or "").split(".")[0] not in NEEDED:
            raise
        print(f"comminute needs {error.name}; install it with: pip install 'comminute[cli]'", file=sys.stderr)
        sys.exit(MISSING_EXTRA)
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        sys.exit(STOPPED)
    try:
        app(prog_name="comminute")
    except SystemExit as done:
        sys.exit(STOPPED if done.code == ABORTED else done.code)


if __name__ == "__main__":
    main()

"""The command `comminute`; says what to install where the extra `cli` is missing."""

from __future__ import annotations

import sys

NEEDED = ("typer", "pydantic", "xarray", "h5netcdf", "h5py")
MISSING_EXTRA, STOPPED = 5, 130


def main() -> None:
    """Run the command line."""
    try:
        from comminute.cli import app  # noqa: PLC0415  (its libraries are optional)
    except ImportError as error:
        if (error.name or "").split(".")[0] not in NEEDED:
            raise
        print(f"comminute needs {error.name}; install it with: pip install 'comminute[cli]'", file=sys.stderr)
        sys.exit(MISSING_EXTRA)
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        sys.exit(STOPPED)
    app(prog_name="comminute")


if __name__ == "__main__":
    main()

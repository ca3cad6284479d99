"""The command line, called inside the tests' own process."""

from typer.testing import CliRunner, Result

from comminute.cli.app import app


def call(*words: object) -> Result:
    """Call `comminute` with these words; the result has its output and exit code."""
    return CliRunner().invoke(app, [str(word) for word in words])

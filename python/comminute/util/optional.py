"""Messages about optional libraries that are missing."""

from __future__ import annotations


def needs(extra: str, library: str, wanted_for: str) -> ImportError:
    """Exception for a missing optional library: what needs it, and the command that installs it.

    Parameters
    ----------
    extra : str
        Extra of this package that brings the library.
    library : str
        Name of the library, or of several.
    wanted_for : str
        Function or task that cannot do without it.

    Returns
    -------
    ImportError

    Examples
    --------
    >>> from comminute.util.optional import needs
    >>> str(needs("plot", "matplotlib", "plot"))
    "plot needs matplotlib; install it with: pip install 'comminute[plot]'"
    """
    return ImportError(f"{wanted_for} needs {library}; install it with: pip install 'comminute[{extra}]'")

"""Texts and file names that users give, made fit for messages."""

from __future__ import annotations

from pathlib import Path


def shorten(text: str, most: int = 40) -> str:
    """Text for a message: printable, and no longer than a line can hold."""
    clean = "".join(c if c.isprintable() else "?" for c in text)
    return clean if len(clean) <= most else clean[: most - 3] + "..."


def is_file(path: Path) -> bool:
    """Tell whether a path names a file; a name that no file can have does not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False

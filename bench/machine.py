"""On what a run was made."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
from pathlib import Path

from contestants.bare_fftw import version
from contestants.copies import last_level_cache

PACKAGES = ("comminute", "numpy", "scipy", "numba")


def _first(pattern: str, file: str) -> str:
    try:
        found = re.search(pattern, Path(file).read_text(), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1).strip() if found else "unknown"


def describe() -> dict[str, str]:
    """CPU, cores, memory, caches, versions, and how busy the machine was."""
    memory = _first(r"^MemTotal:\s+(\d+) kB", "/proc/meminfo")
    described = {
        "processor": _first(r"^model name\s*:\s*(.+)$", "/proc/cpuinfo"),
        "architecture": platform.machine(),
        "cores": str(len(os.sched_getaffinity(0))),
        "last-level cache": f"{last_level_cache() / 2**20:.0f} MiB",
        "memory": f"{int(memory) / 2**20:.1f} GiB" if memory.isdigit() else memory,
        "system": f"{platform.system()} {platform.release()}",
        "load average": f"{os.getloadavg()[0]:.2f}",
        "python": platform.python_version(),
    }
    described |= {name: importlib.metadata.version(name) for name in PACKAGES}
    described["fftw"] = version()
    return described

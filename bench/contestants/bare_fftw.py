"""The FFTW transforms of a full step as Eq. 61 reads, and nothing else: no masks, products or state, all in the cache.

The lines of `bench/cpp/bare_transforms.cpp`, built by `make bench`, in which the same batch is transformed as often as
the step has lines. The FFTW that it calls and the planner's effort are the library's. The library itself needs less:
two lines share a complex transform, and a line takes the shortest that keeps it linear.
"""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np

from contestants.model import Floats

BUILT = Path(__file__).parents[2] / "build" / "bench" / "bench" / "cpp" / "libbare_transforms.so"


def _library() -> ctypes.CDLL:
    if not BUILT.exists():
        raise SystemExit(f"{BUILT} is missing; call `make bench` or `make bench-short`, which build it")
    library = ctypes.CDLL(str(BUILT))
    library.bare_new.restype = ctypes.c_void_p
    library.bare_new.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_int]
    library.bare_run.argtypes = [ctypes.c_void_p, ctypes.c_long]
    library.bare_round_trip.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.bare_free.argtypes = [ctypes.c_void_p]
    library.bare_length.restype = ctypes.c_long
    library.bare_length.argtypes = [ctypes.c_void_p]
    return library


def version() -> str:
    """FFTW's own words."""
    library = _library()
    library.bare_version.restype = ctypes.c_char_p
    found: bytes = library.bare_version()
    return found.decode()


class BareTransforms:
    """Forward and backward transforms of `lines` zero-padded lines of `bins` numbers, eight at a time."""

    BATCH = 8

    def __init__(self, bins: int, lines: int, *, measure: bool) -> None:
        self._library = _library()
        self._plan = self._library.bare_new(bins, self.BATCH, int(measure))
        self._bins = bins
        self._batches = -(-lines // self.BATCH)

    def __del__(self) -> None:
        self._library.bare_free(self._plan)

    @property
    def length(self) -> int:
        """Padded length of a line."""
        return int(self._library.bare_length(self._plan))

    def run(self) -> None:
        """All transforms of one step."""
        self._library.bare_run(self._plan, self._batches)

    def round_trip(self, lines: Floats) -> Floats:
        """One batch, (8, N), there and back: the input again, if these are the transforms they should be."""
        out = np.array(lines, dtype=np.float64, order="C")
        self._library.bare_round_trip(self._plan, out.ctypes.data)
        return out

"""The model as the NumPy contestants see it: a grid, the crush test at bin centres, the shares of the kernels."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Kind = Literal["slow", "exact"]


@dataclass(frozen=True)
class Problem:
    """Grid, material and fragments. Loads that put a cell centre on a zone's boundary to the last bit are avoided."""

    psi_min: float
    psi_max: float
    fragments: Floats  # (N) share that one crush moves down by m bins
    k: float = 0.005
    fabric_width: float = 0.05

    @property
    def bins(self) -> int:
        """N."""
        return len(self.fragments)

    @property
    def spacing(self) -> float:
        """Bin width."""
        return (self.psi_max - self.psi_min) / (self.bins - 1)

    @cached_property
    def centres(self) -> Floats:
        """(N) log sizes."""
        return np.linspace(self.psi_min, self.psi_max, self.bins)

    @cached_property
    def contrast(self) -> Floats:
        """(N, N) squared difference of the two log sizes; the same for every load."""
        return np.square(self.centres[:, None] - self.centres[None, :])

    @cached_property
    def below(self) -> Floats:
        """(N) share that one crush moves by m bins or more, off the grid too."""
        return np.concatenate([[1.0], 1.0 - np.cumsum(self.fragments[:-1])])

    @cached_property
    def grain_share(self) -> Floats:
        """(N, N) share of the slow kernel by which psi crushes: the larger of two, half of equals."""
        return np.tri(self.bins) - 0.5 * np.eye(self.bins)

    def log_load(self, stress_ratio: float) -> float:
        """g* of Eq. 15."""
        return 2.0 * self.fabric_width**2 * math.log(stress_ratio)

    def band(self, stress_ratio: float) -> npt.NDArray[np.int64]:
        """(N) how many bins below the larger grain the other may lie and the cell still be active; -1: never."""
        squared = self.log_load(stress_ratio) + self.k * self.centres
        band = np.where(squared >= 0.0, np.floor(np.sqrt(np.maximum(squared, 0.0)) / self.spacing), -1.0)
        band[0] = -1.0
        return band.astype(np.int64)

    def grain_crushes(self, stress_ratio: float) -> npt.NDArray[np.bool_]:
        """(N, N) whether psi crushes: g(psi, psibar) <= g*."""
        crushes = self.contrast <= (self.log_load(stress_ratio) + self.k * self.centres)[:, None]
        crushes[0, 0] = False
        return crushes

    def parts(self, p: Floats, stress_ratio: float, kind: Kind) -> tuple[Floats, Floats, Floats, Floats | None]:
        """State divided into what rests and what crushes in psi, in psibar, and in both."""
        grain = self.grain_crushes(stress_ratio)
        if kind == "slow":
            active = np.where(np.logical_or(grain, grain.T), p, 0.0)
            crushing = self.grain_share * active
            return p - active, crushing, active - crushing, None
        both = np.where(grain & grain.T, p, 0.0)
        only_grain = np.where(grain & ~grain.T, p, 0.0)
        only_neighbour = np.where(~grain & grain.T, p, 0.0)
        return p - both - only_grain - only_neighbour, only_grain, only_neighbour, both

"""The paper's case, which most trials share: psi from -6 to 1, default material, power-law start, loads to 10^4."""

from __future__ import annotations

from typing import Literal

import numpy as np

import comminute as cm
from contestants.model import Floats, Problem

PSI_MIN, PSI_MAX = -6.0, 1.0
LOAD = 1e4


def grid_of(bins: int) -> cm.LogGrid:
    """N bins over the paper's range."""
    return cm.LogGrid(PSI_MIN, PSI_MAX, bins)


def start_on(grid: cm.LogGrid) -> cm.Fabric:
    """Power-law packing, mass in every bin that the range of sizes reaches."""
    return cm.mixed_fabric(cm.power_law(2.5, 2.5e-3, 1.0), grid)


def problem_on(grid: cm.LogGrid, rule: Literal["paper", "conservative"] = "paper") -> Problem:
    """Hand the same grid, material and fragments to the contestants."""
    material = cm.Material()
    fragments: Floats = np.array(cm.fragment_pmf(material.fragments, grid.spacing, grid.bins, rule))
    return Problem(grid.psi_min, grid.psi_max, fragments, material.k, material.fabric_width)

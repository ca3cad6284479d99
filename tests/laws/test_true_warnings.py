"""Warnings of the fines bin are true: where one names a size, curves above it are good; where none is given, all are.

The witness is the same run on a grid that goes on 12 in ln(size) below the first, and below all grains that crush.
"""

import math
import re
import warnings

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import comminute as cm

GOOD = 1e-3  # error of a curve above the size that a warning names
PRINTED = 1.005  # sizes in a message have three digits


def errors(sim: cm.Simulation, loads: list[float], remix: list[int]) -> tuple[cm.Result, npt.NDArray[np.float64]]:
    """Give the run, and the error at the upper edge of each bin."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cm.ResolutionWarning)
        run = sim.run(stress_ratio=loads, remix_after=remix)
        grid = run.grid
        tip = -sim.material.weibull_modulus / 3.0 * math.log(max(loads))
        below = int((12.0 + max(grid.psi_min - tip, 0.0)) / grid.spacing)
        deep = cm.LogGrid(grid.psi_min - below * grid.spacing, grid.psi_max, grid.bins + below)
        assert isinstance(sim.start, cm.Grading)
        witness = cm.Simulation(sim.material, sim.start, grid=deep).run(stress_ratio=loads, remix_after=remix)
    return run, np.abs(run.cdf - witness.cdf[:, below:]).max(axis=0)


def named(run: cm.Result) -> float:
    """Size that the warning about neighbours in the fines bin names; 0 without one."""
    found = (re.search(r"neighbours in the fines bin .* below a size of (\S+)", warning) for warning in run.warnings)
    return max((float(match.group(1)) for match in found if match), default=0.0)


MATERIALS = [
    (width, law)
    for width in (0.05, 0.3, 1.0, 5.0, 20.0, math.inf)
    for law in (cm.WeibullFragments(), cm.PowerLawFragments(0.5), cm.PowerLawFragments(2.0))
]


@pytest.mark.parametrize(("width", "law"), MATERIALS)
@pytest.mark.parametrize("remix", [[], [0]])
def test_default_grids_are_good_and_say_nothing(width: float, law: cm.WeibullFragments, remix: list[int]) -> None:
    material = cm.Material(fabric_width=width, fragments=law)
    run, error = errors(cm.Simulation(material, cm.gap_graded(1.0, 0.1)), [10.0, 1e3], remix)
    assert error.max() < 5e-4
    assert run.warnings == ()


@pytest.mark.parametrize(("width", "law"), MATERIALS)
@pytest.mark.parametrize("psi_min", [-3.0, -6.0])
@pytest.mark.parametrize("remix", [[], [0]])
def test_curves_above_the_named_size_are_good(
    width: float, law: cm.WeibullFragments, psi_min: float, remix: list[int]
) -> None:
    sim = cm.Simulation(
        cm.Material(fabric_width=width, fragments=law), cm.monodisperse(1.0), grid=cm.LogGrid(psi_min, 0.01, 300)
    )
    run, error = errors(sim, [10.0, 1e3], remix)
    above = run.edge_size > PRINTED * named(run)
    assert error[above].max(initial=0.0) < GOOD
    if named(run):
        assert error.max() > 2e-4


@settings(deadline=None)
@given(
    width=st.floats(0.03, 30.0),
    modulus=st.floats(1.0, 10.0),
    exponent=st.floats(0.4, 3.0),
    finer=st.floats(0.05, 0.9),
    depth=st.floats(2.0, 9.0),
    top=st.floats(3.0, 1e4),
    remix=st.sampled_from([[], [0], [0, 1]]),
)
def test_warnings_are_true_of_any_run(
    width: float, modulus: float, exponent: float, finer: float, depth: float, top: float, remix: list[int]
) -> None:
    material = cm.Material(fabric_width=width, weibull_modulus=modulus, fragments=cm.WeibullFragments(shape=exponent))
    sim = cm.Simulation(material, cm.gap_graded(1.0, finer), grid=cm.LogGrid(-depth, 0.01, 200))
    run, error = errors(sim, [1.5, math.sqrt(1.5 * top), top], remix)
    above = run.edge_size > PRINTED * named(run)
    assert error[above].max(initial=0.0) < 1.2 * GOOD  # the comparison that the warning rests on ends somewhere too
    if named(run):
        assert error.max() > 2e-4

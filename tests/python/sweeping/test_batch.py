"""Many states at once against one solve after another, bit for bit; what is refused, Ctrl-C, and the GIL."""

import math
import os
import re
import signal
import threading
from typing import Any

import numpy as np
import pytest

import comminute as cm
from gil import counts_on_during
from reference import Array

GRID = cm.LogGrid(-3.0, 0.2, 24)
MATERIAL = cm.Material(fabric_width=0.3)
COUNT = 50


def material_points(seed: int) -> tuple[Array, Array, Array]:
    """Return states, the next load of each, and the load that each is at rest under (0: never loaded)."""
    rng = np.random.default_rng(seed)
    states = rng.exponential(1.0, (COUNT, GRID.bins, GRID.bins)) * (rng.random((COUNT, 1, 1)) < 0.9)
    loads = 500.0 ** rng.random(COUNT)
    settled = np.where(rng.random(COUNT) < 0.3, 0.0, 100.0 ** rng.random(COUNT))
    return states / 1000.0, loads, settled


@pytest.mark.parametrize("scheme", ["conservative", "paper"])
@pytest.mark.parametrize("rate", [0.0, 0.4])
@pytest.mark.parametrize("path", ["automatic", "direct", "sums"])
def test_a_batch_gives_the_bits_of_a_loop(scheme: Any, rate: float, path: Any) -> None:
    states, loads, settled = material_points(1)
    single = cm.QuasiStatic(GRID, MATERIAL, scheme, rate, path=path)
    expected, gradings, reports = np.empty_like(states), np.empty((COUNT, GRID.bins)), []
    for b in range(COUNT):
        single.solve(states[b], loads[b], settled[b], expected[b])
        reports.append(single.report)
        gradings[b] = single.marginal(states[b], loads[b], settled[b])
    solver = cm.QuasiStatic(GRID, MATERIAL, scheme, rate, path=path)
    for threads in (1, 2, 7):
        np.testing.assert_array_equal(solver.solve_batch(states, loads, settled, threads=threads), expected)
        assert solver.reports == reports
        np.testing.assert_array_equal(solver.marginal_batch(states, loads, settled, threads=threads), gradings)
    out = states.copy()
    assert solver.solve_batch(out, loads, settled, out, 2) is out
    np.testing.assert_array_equal(out, expected)


def test_numbers_stand_for_all_states_and_none_for_no_load_yet() -> None:
    states = material_points(2)[0]
    solver = cm.QuasiStatic(GRID, MATERIAL)
    expected = np.array([solver.solve(p, 9.0) for p in states])
    np.testing.assert_array_equal(solver.solve_batch(states, 9.0), expected)
    np.testing.assert_array_equal(solver.solve_batch(states, 9, 0), expected)
    np.testing.assert_array_equal(
        solver.solve_batch(expected, np.full(COUNT, 50.0), 9.0), [solver.solve(p, 50.0, 9.0) for p in expected]
    )
    assert solver.solve_batch(states[:0], 9.0).shape == (0, GRID.bins, GRID.bins)
    assert solver.reports == []


def _refused(message: str, call: Any, error: type[Exception] = cm.ParameterError) -> None:
    with pytest.raises(error, match=re.escape(message)):
        call()


@pytest.mark.parametrize("threads", [1, 3])
def test_the_first_bad_input_is_named_and_nothing_is_written(threads: int) -> None:
    states, loads, settled = material_points(3)
    solver = cm.QuasiStatic(GRID, MATERIAL)
    out = np.full_like(states, 7.0)

    def solve(**changed: Any) -> None:
        given: dict[str, Any] = {
            "states": states,
            "stress_ratio": loads,
            "settled_at": settled,
            "out": out,
            "threads": threads,
        }
        solver.solve_batch(**(given | changed))

    wrong = loads.copy()
    wrong[[20, 30]] = math.nan, -1.0
    _refused("stress_ratio[20] is nan; it must be a number of at least 0", lambda: solve(stress_ratio=wrong))
    _refused("settled_at[20] is nan; it must be a number of at least 0", lambda: solve(settled_at=wrong))
    _refused("stress_ratio[0] is -1; it must be", lambda: solve(stress_ratio=-1.0))
    bad = states.copy()
    bad[[31, 41], 12, 12] = math.nan
    _refused(
        "states[31, 12, 12] is nan; every entry inside the crush zone", lambda: solve(states=bad, stress_ratio=600.0)
    )
    _refused("threads is 0; it must be at least 1", lambda: solve(threads=0))
    assert np.all(out == 7.0)


def test_the_solver_returns_what_a_point_has_to_remember() -> None:
    # Three cycles of loading and unloading end where the largest load alone does.
    grid, material = cm.LogGrid(-6.0, 0.0, 58), cm.Material(fabric_width=0.3)
    start = cm.mixed_fabric(cm.power_law(2.5, 0.01, 1.0), grid).probability
    solver = cm.QuasiStatic(grid, material)
    states, settled = start[None].copy(), np.zeros(1)
    for load in (100.0, 5.0) * 3:
        states = solver.solve_batch(states, load, settled)
        settled = solver.settled_at
        assert settled.tolist() == [100.0]
    np.testing.assert_array_equal(states[0], solver.solve(start, 100.0))


def test_a_bad_state_is_kept_with_its_fault_and_the_others_are_solved() -> None:
    states, loads, settled = material_points(6)
    solver = cm.QuasiStatic(GRID, MATERIAL)
    right = solver.solve_batch(states, loads, settled)
    remembered = solver.settled_at
    assert solver.faults == {}
    states[7, 12, 12], states[9, 3, 4] = -0.1, math.nan
    found = solver.solve_batch(states, loads, settled, threads=2, bad_states="keep")
    others = np.delete(np.arange(COUNT), [7, 9])
    np.testing.assert_array_equal(found[others], right[others])
    np.testing.assert_array_equal(found[[7, 9]], states[[7, 9]])
    np.testing.assert_array_equal(solver.settled_at[others], remembered[others])
    np.testing.assert_array_equal(solver.settled_at[[7, 9]], settled[[7, 9]])
    assert {b: str(fault) for b, fault in solver.faults.items()} == {
        7: "states[7, 12, 12] is -0.1; every entry must be a mass of at least 0",
        9: "states[9, 3, 4] is nan; every entry must be finite",
    }
    assert solver.faults[7].parameter == "states"
    gradings = solver.marginal_batch(states, loads, settled, bad_states="keep")
    assert np.flatnonzero(np.isnan(gradings).any(axis=1)).tolist() == [7, 9]
    wrong: Any = "skip"
    _refused("'skip'; it must be one of 'raise', 'keep'", lambda: solver.solve_batch(states, 1.0, bad_states=wrong))


@pytest.mark.parametrize("mass", [-0.1, math.nan, math.inf])
def test_an_array_with_an_entry_that_is_no_mass_is_refused(mass: float) -> None:
    states, *_ = material_points(7)
    states[0, 20, 20] = mass
    solver = cm.QuasiStatic(GRID, MATERIAL)
    _refused(f"state[20, 20] is {mass}; every entry inside the crush zone", lambda: solver.solve(states[0], 1e3))
    _refused(f"state[20, 20] is {mass}; every entry inside the crush zone", lambda: solver.marginal(states[0], 1e3))


def test_arrays_are_taken_as_they_are_or_not_at_all() -> None:
    states, loads, settled = material_points(4)
    solver = cm.QuasiStatic(GRID, MATERIAL)
    shape = cm.ShapeError
    _refused("states has shape (24, 24); the grid needs (1, 24, 24)", lambda: solver.solve_batch(states[0], 1.0), shape)
    _refused("the grid needs (50, 24, 24)", lambda: solver.solve_batch(states[:, :20].copy(), 1.0), shape)
    _refused("states is not a C-ordered", lambda: solver.solve_batch(states.transpose(0, 2, 1), 1.0), shape)
    _refused("states has dtype float32", lambda: solver.solve_batch(states.astype(np.float32), 1.0), TypeError)
    _refused(
        "stress_ratio has shape (49,); the batch needs (50,)", lambda: solver.solve_batch(states, loads[1:]), shape
    )
    _refused("stress_ratio is a list", lambda: solver.solve_batch(states, loads.tolist()), TypeError)
    _refused(
        "settled_at has shape (3,); the batch needs (50,)",
        lambda: solver.solve_batch(states, loads, settled[:3].copy()),
        shape,
    )
    _refused("out has shape (50, 24)", lambda: solver.solve_batch(states, loads, out=np.empty((50, 24))), shape)
    _refused("out has shape (50, 23)", lambda: solver.marginal_batch(states, loads, out=np.empty((50, 23))), shape)
    memory = np.zeros(51 * 24 * 24)
    first, second = (memory[k : k + 50 * 24 * 24].reshape(50, 24, 24) for k in (0, 24 * 24))
    _refused("overlaps", lambda: solver.solve_batch(first, 2.0, out=second), shape)
    _refused("overlaps", lambda: solver.marginal_batch(first, 2.0, out=memory[: 50 * 24].reshape(50, 24)), shape)


def _long_batch() -> tuple[cm.QuasiStatic, Array]:
    """Return blends on wide zones, some seconds of them."""
    grid = cm.LogGrid(-3.0, 0.2, 100)
    states = np.full((1000, 100, 100), 1e-4)
    return cm.QuasiStatic(grid, cm.Material(fabric_width=3.0), loading_rate=0.5), states


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_batch(threads: int) -> None:
    solver, states = _long_batch()
    out = np.full_like(states, -1.0)
    alarm = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    alarm.start()
    with pytest.raises(KeyboardInterrupt):
        solver.solve_batch(states, 1e3, out=out, threads=threads)
    assert np.any(out == -1.0)
    assert solver.reports == []
    np.testing.assert_array_equal(solver.solve_batch(states[:2], 5.0)[1], solver.solve(states[1], 5.0))


def test_the_gil_is_free_during_a_batch() -> None:
    """The main thread counts on while one single batch is still under way."""
    solver, states = _long_batch()
    assert counts_on_during(lambda: solver.solve_batch(states[:200], 1e3))

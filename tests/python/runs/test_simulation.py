"""Runs: loads in, results out, whatever the path and the engine."""

import math
import os
import signal
import threading

import numpy as np
import pytest

import comminute as cm
from gil import counts_on_during

MATERIAL = cm.Material(first_crush_stress=1.5)
LOADS = [1.0, 2.0, 8.0, 100.0]


@pytest.fixture(scope="module")
def start() -> cm.Fabric:
    return cm.mixed_fabric(cm.power_law(2.5, 0.02, 1.0), cm.LogGrid(-14.0, 0.0, 141))


def test_results_have_the_promised_shapes(start: cm.Fabric) -> None:
    result = cm.Simulation(MATERIAL, start).run(stress_ratio=LOADS)
    assert result.pmf.shape == result.cdf.shape == (4, 141)
    assert result.psi.shape == result.size.shape == result.edge_size.shape == (141,)
    for name in ("stress_ratio", "crushes", "fines", "mass_error"):
        assert getattr(result, name).shape == (4,)
    assert result.stress is not None
    np.testing.assert_array_equal(result.stress, 1.5 * np.array(LOADS))
    np.testing.assert_allclose(result.edge_size, result.size * np.exp(start.grid.spacing / 2))
    assert len(result.points) == len(result.reports) == 4
    assert np.abs(result.mass_error).max() < 1e-13
    assert result.percentile(50).shape == (4,)
    assert result.fabric(3).settled_at == 100.0


def test_each_load_gives_what_the_solver_gives_by_hand(start: cm.Fabric) -> None:
    result = cm.Simulation(MATERIAL, start).run(stress_ratio=LOADS)
    assert result.engine == "quasi-static"
    solver = cm.QuasiStatic(start.grid, MATERIAL)
    chained, crushed = start, 0.0
    for k, load in enumerate(LOADS):
        fabric = solver.solve(start, max(LOADS[: k + 1]))
        assert result.fabric(k) == fabric
        assert (result.reports[k], result.crushes[k]) == (solver.report, solver.report.crushed)
        np.testing.assert_array_equal(result.pmf[k], fabric.grainsize())
        chained = solver.solve(chained, load)  # the way to a load does not matter but for rounding
        crushed += solver.report.crushed
        np.testing.assert_allclose(chained.probability, fabric.probability, rtol=0.0, atol=1e-16)
        assert result.crushes[k] == pytest.approx(crushed, rel=1e-13)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"loading_rate": [0.0, 0.5, 0.5, 0.0, 0.2]},
        {"kind": "fast"},
        {"engine": "slow-update"},
        {"kind": "exact", "steps_per_load": 2},
    ],
    ids=["slow", "blend", "fast", "steps", "exact"],
)
def test_what_is_kept_changes_no_bit(start: cm.Fabric, options: dict[str, object]) -> None:
    sim = cm.Simulation(MATERIAL, start)
    loads = [1.0, 8.0, 2.0, 8.0, 100.0]
    full = sim.run(stress_ratio=loads, remix_after=[2], keep_fabrics="all", **options)  # type: ignore[arg-type]
    for keep in ([], "last", [1, 3]):
        lean = sim.run(stress_ratio=loads, remix_after=[2], keep_fabrics=keep, **options)  # type: ignore[arg-type]
        np.testing.assert_array_equal(lean.pmf, full.pmf)
        np.testing.assert_array_equal(lean.crushes, full.crushes)
        assert (lean.points, lean.reports, lean.engine) == (full.points, full.reports, full.engine)
        for k in range(-5, 5):
            assert lean.fabric(k) == full.fabric(k)
        rate = 0.3 if "loading_rate" in options else 0.0
        resumed, whole = (run.resume([50.0, 200.0], loading_rate=rate, keep_fabrics="all") for run in (lean, full))
        np.testing.assert_array_equal(resumed.pmf, whole.pmf)
        assert resumed.fabric(6) == whole.fabric(6)
    with pytest.raises(IndexError):
        full.fabric(5)


def test_at_most_256_megabytes_of_fabrics_are_kept_unasked() -> None:
    grid = cm.LogGrid(-9.0, 0.0, 1448)  # 16.8 MB a fabric, 16 of which are 268 MB
    result = cm.Simulation(MATERIAL, cm.power_law(2.5, 0.01, 1.0), grid=grid).run(
        stress_ratio=np.linspace(1.0, 2.0, 40)
    )
    kept = [k for k, fabric in enumerate(result.fabrics) if fabric is not None]
    assert len(kept) == 256_000_000 // (8 * 1448**2) == 15
    assert kept[-1] == 39
    assert max(np.diff([-1, *kept])) <= 3  # evenly over the path
    assert "15 fabrics (252 MB)" in repr(result)
    rings = cm.Lattice(100, MATERIAL, cm.monodisperse(1.0)).run(stress_ratio=[1.0, 2.0], keep_fabrics=[1])
    with pytest.raises(cm.ParameterError, match="the fabric after load 0 was not kept; add its index to keep_fabrics"):
        rings.fabric(0)


def test_a_loading_rate_of_its_own_for_each_load_starts_from_where_the_last_one_left(start: cm.Fabric) -> None:
    result = cm.Simulation(MATERIAL, start).run(stress_ratio=LOADS, loading_rate=[0.0, 0.5, 0.5, 0.2])
    fabric, crushed = start, 0.0
    for load, rate in ((1.0, 0.0), (8.0, 0.5), (100.0, 0.2)):
        solver = cm.QuasiStatic(start.grid, MATERIAL, loading_rate=rate)
        fabric = solver.solve(fabric, load)
        crushed += solver.report.crushed
    np.testing.assert_allclose(result.pmf[-1], fabric.grainsize(), rtol=0.0, atol=1e-15)
    assert result.crushes[-1] == pytest.approx(crushed, rel=1e-13)


def test_each_load_gives_what_the_stepping_engine_gives_by_hand(start: cm.Fabric) -> None:
    result = cm.Simulation(MATERIAL, start).run(stress_ratio=LOADS, engine="slow-update")
    engine = cm.SlowUpdate(start.grid, MATERIAL, scheme="conservative")
    p, crushed = start.probability.copy(), 0.0
    for k, load in enumerate(LOADS):
        engine.settle(p, load, out=p)
        crushed += engine.report.crushed
        np.testing.assert_array_equal(result.fabric(k).probability, p)
        np.testing.assert_allclose(result.pmf[k], p.sum(axis=1), rtol=1e-13)
        assert result.crushes[k] == pytest.approx(crushed, rel=1e-14)


def test_both_engines_give_the_same_result(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    update = sim.run(stress_ratio=LOADS, engine="slow-update")
    convolution = sim.run(stress_ratio=LOADS, engine="full-convolution")
    np.testing.assert_allclose(update.pmf, convolution.pmf, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(update.crushes, convolution.crushes, rtol=0.0, atol=1e-12)
    assert (update.engine, convolution.engine) == ("slow-update", "full-convolution")


def test_stresses_are_loads_by_the_first_crush_stress(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    by_stress = sim.run(stress=[1.5 * load for load in LOADS])
    assert by_stress == sim.run(stress_ratio=LOADS)


def test_unloading_changes_nothing(start: cm.Fabric) -> None:
    result = cm.Simulation(MATERIAL, start).run(stress_ratio=[8.0, 0.0, 2.0, 8.0])
    for k in (1, 2, 3):
        np.testing.assert_allclose(result.pmf[k], result.pmf[0], rtol=0.0, atol=1e-17)
    assert result.fabric(1).settled_at == 8.0


def test_remixing_lets_the_same_load_crush_again(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    kept = sim.run(stress_ratio=[8.0, 8.0])
    remixed = sim.run(stress_ratio=[8.0, 8.0], remix_after=[0])
    assert kept.crushes[1] == pytest.approx(kept.crushes[0], rel=1e-12)
    assert remixed.crushes[1] > 1.5 * remixed.crushes[0]
    np.testing.assert_array_equal(remixed.fabric(0).probability, kept.fabric(0).probability)


def test_a_loading_rate_blends_in_the_fast_kernel(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    rates = [0.0, 0.0, 0.3, 0.3]
    result = sim.run(stress_ratio=LOADS, loading_rate=rates)
    slow = sim.run(stress_ratio=LOADS)
    np.testing.assert_array_equal(result.pmf[:2], slow.pmf[:2])
    assert result.crushes[3] > slow.crushes[3]
    assert result.engine == "quasi-static"
    assert [report.path for report in result.reports[2:]] == ["blend", "blend"]  # type: ignore[union-attr]
    fast = sim.run(stress_ratio=LOADS, loading_rate=1.0)
    np.testing.assert_array_equal(fast.pmf, sim.run(stress_ratio=LOADS, kind="fast").pmf)


def test_auto_never_solves_for_the_exact_kernel(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    assert sim.run(stress_ratio=LOADS, kind="exact").engine == "full-convolution"
    assert sim.run(stress_ratio=LOADS, kind="fast").engine == "quasi-static"
    assert sim.run(stress_ratio=LOADS, steps_per_load=3).engine == "slow-update"
    with pytest.raises(cm.ParameterError, match='engine "quasi-static" has no solve for kind "exact"'):
        sim.run(stress_ratio=LOADS, kind="exact", engine="quasi-static")
    with pytest.raises(cm.ParameterError, match='steps_per_load is 3 but engine "quasi-static" takes no steps'):
        sim.run(stress_ratio=LOADS, steps_per_load=3, engine="quasi-static")


def test_a_number_of_steps_stops_before_rest(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    few = sim.run(stress_ratio=LOADS, steps_per_load=1)
    rest = sim.run(stress_ratio=LOADS, engine="slow-update")
    assert np.all(few.crushes[1:] < rest.crushes[1:])
    assert few.fabric(0).settled_at is None


def test_a_grid_is_sized_when_none_is_given() -> None:
    sim = cm.Simulation(MATERIAL, cm.gap_graded(1.0, 0.1))
    result = sim.run(stress_ratio=[1.0, 1e4])
    assert result.warnings == ()
    assert result.fines.max() < 1e-4
    assert result.grid.psi_max == 0.0
    assert np.abs(result.grid.centres - math.log(0.1)).min() < 1e-12
    assert result.edge_size[0] < 1e-4  # below the smallest size that 10^4 crushes among equals


def test_kept_fabrics(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)
    assert [f is not None for f in sim.run(stress_ratio=LOADS, keep_fabrics=[1]).fabrics] == [0, 1, 0, 0]
    assert sim.run(stress_ratio=LOADS, keep_fabrics="last").fabric(-1).settled_at == 100.0


def test_progress_is_reported_load_by_load(start: cm.Fabric) -> None:
    seen: list[int] = []
    cm.Simulation(MATERIAL, start).run(stress_ratio=LOADS, on_load=seen.append)
    assert seen == [0, 1, 2, 3]


def test_ctrl_c_keeps_the_finished_loads(start: cm.Fabric) -> None:
    sim = cm.Simulation(MATERIAL, start)

    def interrupt(k: int) -> None:
        if k == 1:
            raise KeyboardInterrupt

    with pytest.raises(cm.Interrupted, match="interrupted after 2 finished loads") as raised:
        sim.run(stress_ratio=LOADS, on_load=interrupt)
    partial = raised.value.result
    assert partial is not None
    np.testing.assert_array_equal(partial.pmf, sim.run(stress_ratio=LOADS[:2]).pmf)


def test_ctrl_c_gets_through_to_a_long_settle() -> None:
    grid = cm.LogGrid(-14.0, 0.0, 701)
    # Nearly all fragments are nearly as large as the grain: hundreds of thousands of steps to rest.
    material = cm.Material(fragments=cm.PowerLawFragments(1e5))
    start = cm.mixed_fabric(cm.power_law(2.5, 0.02, 1.0), grid)
    alarm = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    alarm.start()
    with pytest.raises(KeyboardInterrupt):
        cm.SlowUpdate(grid, material, scheme="conservative").settle(start.probability, 1e4)


def test_the_gil_is_free_during_a_step() -> None:
    """The main thread finishes a long handshake with itself while one single step is still under way."""
    grid = cm.LogGrid(-14.0, 0.0, 2000)
    p = np.full((2000, 2000), 1.0 / 2000**2)
    engine = cm.FullConvolution(grid, cm.Material(fabric_width=5.0), "exact", scheme="paper")
    assert counts_on_during(lambda: engine.step(p, 1e4, out=p))


def test_one_engine_serves_two_threads_in_turn(start: cm.Fabric) -> None:
    engine = cm.SlowUpdate(start.grid, MATERIAL, scheme="paper")
    expected = engine.settle(start.probability, 100.0)
    results: list[np.ndarray] = []
    threads = [
        threading.Thread(target=lambda: results.append(engine.settle(start.probability, 100.0))) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8
    for found in results:
        np.testing.assert_array_equal(found, expected)

"""The one way along a load path: stopped and continued anywhere it gives the bits of an uninterrupted run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import comminute as cm
from comminute.runs.load_path import Load, LoadPath
from comminute.runs.outcomes import Outcome, outcomes_of
from comminute.runs.path_run import PathRun
from comminute.util.choices import Scheme

MATERIAL = cm.Material(reference_size=2.0, first_crush_stress=1.2, fabric_width=0.2)
GRID = cm.LogGrid(-5.0, 0.7, 58)
SAND = cm.Grading.from_sieves([2.0, 1.0, 0.5, 0.2], [100, 60, 20, 3], unit="mm", notes=["as weighed"])
STARTS: tuple[cm.Grading | cm.Fabric, ...] = (
    SAND,
    cm.gap_graded(2.0, 0.2),
    cm.mixed_fabric(cm.monodisperse(2.0), GRID, mean="geometric"),
)


@dataclass(frozen=True)
class Asked:
    """A start, a load path, and the options of its run."""

    simulation: cm.Simulation
    loads: list[float]
    rates: list[float]
    remixed: list[int]
    options: dict[str, Any]

    def run(self, first: int | None = None, **options: Any) -> cm.Result:
        """Run the first loads, or all of them."""
        count = len(self.loads) if first is None else first
        return self.simulation.run(
            stress=[1.2 * load for load in self.loads[:count]],
            loading_rate=self.rates[:count],
            remix_after=[k for k in self.remixed if k < count],
            **self.options,
            **options,
        )

    def resume(self, result: cm.Result, **options: Any) -> cm.Result:
        """Go on from a result of the first loads to the end."""
        done = result.stress_ratio.size
        return result.resume(
            stress=[1.2 * load for load in self.loads[done:]],
            loading_rate=self.rates[done:],
            remix_after=[k - done for k in self.remixed if k >= done],
            **options,
        )


@st.composite
def asked(draw: st.DrawFn) -> Asked:
    """Paths of two to six loads with unloading, repetition, remixing and rates, over every engine."""
    start = draw(st.sampled_from(STARTS))
    loads = draw(st.lists(st.sampled_from([0.0, 0.5, 1.0, 2.0, 8.0, 8.0, 30.0, 100.0]), min_size=2, max_size=6))
    remixed = draw(st.lists(st.integers(0, len(loads) - 1), unique=True, max_size=3))
    options: dict[str, Any] = draw(
        st.sampled_from([{}, {}, {"kind": "fast"}, {"kind": "exact", "steps_per_load": 2}, {"steps_per_load": 3}])
    )
    rated = st.just(0.0) if "kind" in options else st.sampled_from([0.0, 0.0, 0.3, 1.0])
    rates = [draw(rated) for _ in loads]
    grid = None if isinstance(start, cm.Fabric) else GRID
    schemes: tuple[Scheme, ...] = ("conservative", "paper")
    scheme = draw(st.sampled_from(schemes))
    return Asked(cm.Simulation(MATERIAL, start, grid=grid, scheme=scheme), loads, rates, remixed, options)


class Stop:
    """Ctrl-C when so many loads are finished."""

    def __init__(self, loads: int) -> None:
        self.left = loads

    def __call__(self, load: int) -> None:
        """Count a load."""
        del load
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


@pytest.mark.filterwarnings("ignore::comminute.ResolutionWarning")
@given(path=asked(), data=st.data())
def test_stopped_and_continued_anywhere_equals_uninterrupted(path: Asked, data: st.DataObject) -> None:
    whole = path.run()
    stop = data.draw(st.integers(1, len(path.loads)), label="stop")
    with pytest.raises(cm.Interrupted) as stopped:
        path.run(on_load=Stop(stop))
    result = stopped.value.result
    assert result is not None
    assert result == path.run(stop)
    while result.stress_ratio.size < len(path.loads):
        stop = data.draw(st.integers(1, len(path.loads) - result.stress_ratio.size), label="stop again")
        with pytest.raises(cm.Interrupted) as stopped:
            path.resume(result, on_load=Stop(stop))
        assert stopped.value.result is not None
        assert stopped.value.result.stress_ratio.size == result.stress_ratio.size + stop
        result = stopped.value.result
    assert result == whole
    assert cm.run_again(result) == whole


@pytest.mark.filterwarnings("ignore::comminute.ResolutionWarning")
@given(path=asked(), data=st.data())
def test_fewer_fabrics_change_nothing_but_the_last_bits(path: Asked, data: st.DataObject) -> None:
    whole = path.run()
    kept = data.draw(st.sets(st.integers(0, len(path.loads) - 1)), label="kept")
    lean = path.run(keep_fabrics=sorted(kept))
    assert {k for k, fabric in enumerate(lean.fabrics) if fabric is not None} == kept
    np.testing.assert_allclose(lean.pmf, whole.pmf, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(lean.crushes, whole.crushes, rtol=1e-12, atol=1e-14)
    assert (lean.notes, lean.warnings, lean.engine, lean.recipe) == (
        whole.notes,
        whole.warnings,
        whole.engine,
        whole.recipe,
    )
    assert cm.run_again(lean) == lean


CASE = """
[material]
reference_size = 2.0
first_crush_stress = 1.2
fabric_width = 0.2
[grading]
kind = "sieves"
size = [2.0, 1.0, 0.5, 0.2]
percent_finer = [100.0, 60.0, 20.0, 3.0]
notes = ["as weighed"]
[grid]
bins = 58
psi_min = -5.0
psi_max = 0.7
[load]
stress = [1.2, 9.6, 2.4, 36.0]
loading_rate = [0.0, 0.0, 0.3, 0.0]
remix_after = [1]
[output]
fabrics = "all"
"""


@pytest.mark.filterwarnings("ignore::comminute.ResolutionWarning")
def test_every_entrance_gives_the_same_numbers(tmp_path: Path) -> None:
    pytest.importorskip("pydantic")
    pytest.importorskip("h5netcdf")
    from comminute.cases.reading import read_case  # noqa: PLC0415  (pydantic is optional)
    from comminute.cases.running import part_of, run_case  # noqa: PLC0415

    sim = cm.Simulation(MATERIAL, SAND, grid=GRID)
    path = Asked(sim, [1.0, 8.0, 2.0, 30.0], [0.0, 0.0, 0.3, 0.0], [1], {})
    whole = path.run()

    by_load = path.run(1)
    for k in range(1, 4):
        by_load = Asked(sim, path.loads[: k + 1], path.rates[: k + 1], [1] if k >= 1 else [], {}).resume(by_load)
    assert by_load == whole

    (tmp_path / "case.toml").write_text(CASE)
    (case,) = read_case(tmp_path / "case.toml")
    seen: list[cm.Result] = []

    def stop(result: cm.Result) -> None:
        seen.append(result)
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(cm.Interrupted):
        run_case(case, on_load=stop)
    part = cm.open_result(part_of(case.target))
    assert part == seen[-1]
    result = run_case(case, earlier=part)
    assert result == run_case(case)
    assert result.recipe is not None
    assert replace(result, recipe=replace(result.recipe, case="", stress_unit="")) == whole
    assert cm.open_result(case.target) == result
    assert cm.run_again(result) == result


def test_a_lattice_walks_as_by_hand() -> None:
    path: dict[str, Any] = {"stress_ratio": [2.0, 1.0, 8.0, 8.0], "remix_after": [2]}
    result = cm.Lattice(500, MATERIAL, SAND, replicas=3, seed=5).run(**path, grid=GRID, keep_fabrics=[1, 3])
    rings = cm.Lattice(500, MATERIAL, SAND, replicas=3, seed=5)
    assert result.start == rings.fabric(GRID)
    for k, load in enumerate(path["stress_ratio"]):
        rings.load_to(load)
        np.testing.assert_array_equal(result.pmf[k], rings.grainsizes(GRID).mean(axis=0))
        np.testing.assert_array_equal(result.cdf_error[k], rings.cdf_error(GRID))
        each = rings.crushes.mean(axis=1)
        assert result.crushes[k] == pytest.approx(each.mean(), rel=1e-14)
        assert result.crushes_error[k] == pytest.approx(each.std(ddof=1) / np.sqrt(3), rel=1e-12)
        assert result.fabrics[k] == (rings.fabric(GRID) if k in (1, 3) else None)
        if k == 2:
            rings.remix()
    assert (result.unit, result.engine, result.reports, result.recipe) == ("mm", "Lattice", (), None)


def test_a_stopped_lattice_is_remixed_and_goes_on() -> None:
    def make() -> cm.Lattice:
        return cm.Lattice(300, MATERIAL, SAND, seed=2)

    whole = make().run(stress_ratio=[2.0, 2.0, 8.0], remix_after=[0], grid=GRID)
    rings = make()
    with pytest.raises(cm.Interrupted) as stopped:
        rings.run(stress_ratio=[2.0, 2.0, 8.0], remix_after=[0], grid=GRID, on_load=Stop(1))
    first = stopped.value.result
    assert isinstance(first, cm.LatticeResult)
    then = rings.run(stress_ratio=[2.0, 8.0], grid=GRID)
    np.testing.assert_array_equal(np.concatenate([first.pmf, then.pmf]), whole.pmf)
    assert tuple(first.fabrics) + tuple(then.fabrics) == whole.fabrics


FABRIC = cm.mixed_fabric(SAND, GRID)


class Diary:
    """A walker that writes down what it is asked, and is interrupted in one of its duties."""

    def __init__(self, interrupted_in: str = "") -> None:
        self.interrupted_in = interrupted_in
        self.duties: list[str] = []

    def load(self, load: Load, *, with_fabric: bool) -> Outcome:
        """Write a load down."""
        self._do(f"load {load.place} to {load.stress_ratio:g}" + (" with fabric" if with_fabric else ""))
        return Outcome(FABRIC.grainsize(), float(load.place), 0.0, fabric=FABRIC if with_fabric else None)

    def remix(self) -> None:
        """Write a remixing down."""
        self._do("remix")

    def _do(self, duty: str) -> None:
        if duty == self.interrupted_in:
            raise KeyboardInterrupt
        self.duties.append(duty)


PATH = LoadPath(np.array([1.0, 8.0, 2.0]), None, np.zeros(3), frozenset([1]), by_stress=False)


def kept(outcomes: Sequence[Outcome]) -> list[int]:
    """Count the finished loads from 1, negatively where the fabric is not kept."""
    return [(1 if outcome.fabric is not None else -1) * (k + 1) for k, outcome in enumerate(outcomes)]


def test_the_runner_asks_for_what_is_wanted_and_keeps_that() -> None:
    diary = Diary()
    run = PathRun(diary, PATH, kept, wanted=frozenset([1]))
    assert run.result() is None
    crushed = [outcome.crushed for outcome in run]
    assert crushed == [0.0, 1.0, 2.0]
    assert diary.duties == ["load 0 to 1", "load 1 to 8 with fabric", "remix", "load 2 to 2"]
    assert run.result() == [-1, 2, -3]


def test_a_run_may_keep_the_latest_fabric() -> None:
    run = PathRun(Diary(), PATH, kept, wanted=frozenset([0]), keep_latest=True)
    assert [run.result() for _ in run] == [[1], [1, 2], [1, -2, 3]]


@pytest.mark.parametrize(("duty", "done"), [("load 0 to 1", 0), ("load 1 to 8", 1), ("remix", 2), ("load 2 to 2", 2)])
def test_an_interruption_keeps_every_load_that_was_finished(duty: str, done: int) -> None:
    run = PathRun(Diary(duty), PATH, kept, wanted=frozenset())
    with pytest.raises(KeyboardInterrupt):
        list(run)
    assert run.result() == ([-1, -2][:done] or None)


def test_a_run_goes_on_after_the_loads_that_are_finished() -> None:
    first = PathRun(Diary(), PATH, list, wanted=frozenset([0]))
    walked = iter(first)
    next(walked)
    diary = Diary()
    rest = PathRun(diary, PATH, kept, wanted=frozenset([0]), finished=first.result() or ())
    assert [outcome.crushed for outcome in rest] == [1.0, 2.0]
    assert diary.duties == ["load 1 to 8", "remix", "load 2 to 2"]
    assert rest.result() == [1, -2, -3]


def test_a_result_is_the_outcomes_of_its_loads() -> None:
    result = cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=[1.0, 8.0], keep_fabrics=[0])
    one, two = outcomes_of(result)
    assert (one.fabric, two.fabric) == (result.fabric(0), None)
    assert (one.report, two.points, two.crushed) == (result.reports[0], result.points[1], result.crushes[1])
    np.testing.assert_array_equal(two.grainsize, result.pmf[1])


def test_stresses_and_stress_ratios_may_follow_each_other() -> None:
    material = cm.Material(reference_size=2.0, first_crush_stress=1.7)
    sim = cm.Simulation(material, SAND, grid=GRID)
    stresses, ratios = [1.9, 3.1, 4.7, 6.3], [7.7, 9.1, 13.9, 21.1]
    result = sim.run(stress=stresses).resume(stress_ratio=ratios)
    assert result.stress is not None
    np.testing.assert_array_equal(result.stress[:4], stresses)
    np.testing.assert_array_equal(result.stress_ratio[4:], ratios)
    assert cm.run_again(result) == result


def test_loads_are_taken_as_they_were_given() -> None:
    loads = np.array([1.0, 8.0])
    result = cm.Simulation(MATERIAL, SAND, grid=GRID).run(stress_ratio=loads)
    loads[0] = 5.0
    np.testing.assert_array_equal(result.stress_ratio, [1.0, 8.0])

"""Every mistake a user can make, and the exact words that answer it: value, rule, remedy."""

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import comminute as cm
from comminute.runs.remarks import explained

GRID = cm.LogGrid(-6.0, 0.0, 61)
MATERIAL = cm.Material()
STATE = np.full((61, 61), 1.0 / 61**2)


def sieves(size: list[float], finer: list[float], **options: Any) -> cm.Grading:
    return cm.Grading.from_sieves(size, finer, "mm", **options)


def simulate(**options: Any) -> cm.Result:
    return cm.Simulation(MATERIAL, cm.monodisperse(1.0)).run(**options)


PARAMETERS: list[tuple[Callable[[], object], str]] = [
    (
        lambda: cm.Material(weibull_modulus=0.0),
        "weibull_modulus is 0; it must be greater than 0 and finite",
    ),
    (
        lambda: cm.Material(fabric_width=-0.05),
        "fabric_width is -0.05; it must be greater than 0 (inf switches the fabric off)",
    ),
    (lambda: cm.Material(fabric_width=math.nan), "fabric_width is nan; it must be greater than 0 (inf"),
    (
        lambda: cm.Material(reference_size=math.inf),
        "reference_size is inf; it must be greater than 0 and finite",
    ),
    (
        lambda: cm.Material(first_crush_stress=0.0),
        "first_crush_stress is 0; it must be greater than 0 and finite",
    ),
    (lambda: cm.WeibullFragments(scale=-1.0), "scale is -1; it must be greater than 0 and finite"),
    (lambda: cm.WeibullFragments(shape=0.0), "shape is 0; it must be greater than 0 and finite"),
    (lambda: cm.PowerLawFragments(exponent=0.0), "exponent is 0; it must be greater than 0 and finite"),
    (lambda: cm.LogNormalFragments(sd_log=0.0), "sd_log is 0; it must be greater than 0 and finite"),
    (lambda: cm.LogNormalFragments(40.0, 1.0), "mean_log is 40; it must be finite and at most 30 sd_log"),
    (lambda: cm.TabulatedFragments([0.5, 0.2, 1.0], [0.1, 0.2, 1.0]), "x is 0.2; it must be rising"),
    (lambda: cm.TabulatedFragments([0.2, 0.5], [0.1, 1.0]), "the last x is 0.5; it must be 1"),
    (lambda: cm.TabulatedFragments([0.2, 1.0], [0.1, 0.9]), "the last finer is 0.9; it must be 1"),
    (lambda: cm.LogGrid(-6.0, 1.0, 7), "bins is 7; it must be at least 8"),
    (lambda: cm.LogGrid(1.0, -6.0, 71), "psi_min is 1 and psi_max is -6; psi_min must be less than psi_max"),
    (lambda: cm.LogGrid(math.nan, 1.0, 71), "psi_min is nan; it must be finite"),
    (lambda: cm.crush_zones(GRID, MATERIAL, -1.0), "stress_ratio is -1; it must be a number of at least 0"),
    (
        lambda: cm.active_share(GRID, MATERIAL, math.nan),
        "stress_ratio is nan; it must be a number of at least 0",
    ),
    (lambda: cm.critical_stress_ratio(MATERIAL, 0.0, 1.0), "size is 0; it must be greater than 0"),
    (
        lambda: cm.logspace_load(cm.Material(fabric_width=math.inf), 2.0),
        "fabric_width is inf; it must be finite here",
    ),
    (
        lambda: cm.cell_kernel(GRID, MATERIAL, 2.0, 61, 0),
        "i is 61; it must be a bin of the grid, 0 to bins - 1",
    ),
    (
        lambda: cm.FullConvolution(GRID, MATERIAL, "medium"),  # type: ignore[arg-type]
        "kind is 'medium'; it must be one of 'exact', 'slow', 'fast', 'blend'",
    ),
    (
        lambda: cm.FullConvolution(GRID, MATERIAL, "slow", loading_rate=0.3),
        'loading_rate is 0.3; a rate belongs to the blend of kernels, and this one is no blend. Use kind "blend", '
        "or leave loading_rate at 0",
    ),
    (
        lambda: cm.FullConvolution(GRID, MATERIAL, "blend", loading_rate=1.5),
        "loading_rate is 1.5; it must be between 0 and 1",
    ),
    (
        lambda: cm.SlowUpdate(GRID, MATERIAL, scheme="exact"),  # type: ignore[arg-type]
        "scheme is 'exact'; it must be one of 'conservative', 'paper'",
    ),
    (
        lambda: cm.SlowUpdate(GRID, MATERIAL, scheme="paper").settle(STATE, 2.0, steps=0),
        "steps is 0; it must be at least 1",
    ),
    (lambda: cm.SlowUpdate(GRID, MATERIAL).settle(STATE, 2.0, steps=0), "steps is 0; it must be at least 1"),
    (
        lambda: MATERIAL.stress_ratio(1.0),
        "stress is 1; it needs first_crush_stress, which is not set. Set it on the Material, or give stress_ratio",
    ),
    (
        lambda: cm.Material(first_crush_stress=1.0).stress_ratio(-1.0),
        "stress is -1; it must be a number of at least 0",
    ),
]

GRADINGS: list[tuple[Callable[[], object], str]] = [
    (lambda: cm.monodisperse(0.0), "size is 0; it must be greater than 0 and finite"),
    (lambda: cm.gap_graded(1.0, 0.1, 1.2), "coarse_share is 1.2; it must be between 0 and 1"),
    (lambda: cm.gap_graded(0.1, 1.0), "fine is 1 and coarse is 0.1; fine must be less than coarse"),
    (
        lambda: cm.power_law(2.5, 1.0, 1.0),
        "smallest is 1 and largest is 1; smallest must be less than largest",
    ),
    (
        lambda: sieves([0.3, 0.6, 1.2], [50, 40, 100]),
        "row 2: 40 % finer at 0.6 mm is less than 50 % at 0.3 mm; cumulative per cent finer cannot fall with size. "
        "Retained percentages?",
    ),
    (lambda: sieves([0.3, 0.3, 1.2], [20, 40, 100]), "row 2: size 0.3 mm stands already in row 1"),
    (
        lambda: sieves([0.3, -0.6, 1.2], [20, 40, 100]),
        "row 2: size is -0.6; it must be greater than 0 and finite",
    ),
    (
        lambda: sieves([0.3, 0.6, 1.2], [20, math.nan, 100]),
        "row 2: percent_finer is nan; it must be between 0",
    ),
    (lambda: sieves([0.3, 0.6], [20, 101]), "row 2: percent_finer is 101; it must be between 0 and 100"),
    (lambda: sieves([], []), "the sieve curve has 0 points; it must have at least 2"),
    (
        lambda: sieves([0.3, 0.6], [20, 90]),
        "the coarsest sieve, 0.6 mm, has 90 % finer, not 100 %; add the size that all grains pass, "
        'or pass top="extend" to carry the last slope on to 100 %',
    ),
    (
        lambda: sieves([0.3, 0.6], [90, 90], top="extend"),
        "the curve is flat there and has no slope to carry on. Add the size that all grains pass",
    ),
    (
        lambda: sieves([0.3, 0.6, 1.2], [20, 20, 100]),
        "20 % is finer than the finest sieve, 0.3 mm, and the curve is flat above it, so no tail can be read from "
        "it; add a size with 0 % finer",
    ),
    (lambda: sieves([0.3, 0.6], [0, 100], top="cut"), "top is 'cut'; it must be one of 'error', 'extend'"),
    (
        lambda: cm.mixed_fabric(cm.monodisperse(2.0), GRID),
        "the largest grain, 2, lies above the grid's top edge, 1.0512710963760241; raise psi_max, or leave the grid "
        "out to have it sized from the grading",
    ),
    (
        lambda: cm.percentile(GRID, cm.mixed_fabric(cm.power_law(2.9, 1e-4, 1.0), GRID).cdf(), 10),
        "D10 lies in the fines bin, which holds",
    ),
    (
        lambda: cm.percentile(GRID, np.append(np.linspace(0.0, 0.5, GRID.bins - 1), 0.25), 50),
        f"cdf[{GRID.bins - 1}] is 0.25 after 0.5; a cdf is 0 or more and never falls. Pass the mass fraction finer",
    ),
    (lambda: cm.percentile(GRID, np.full(GRID.bins, np.nan), 50), "cdf[0] is nan after 0; a cdf is 0 or more"),
]

RUNS: list[tuple[Callable[[], object], str]] = [
    (lambda: simulate(), "give one kind of load: stress_ratio, stress, p with q, or vertical with k0"),
    (lambda: simulate(stress_ratio=1.0, stress=1.0), "give one kind of load: stress_ratio, stress, p with q"),
    (
        lambda: simulate(stress=[1.0]),
        "stress is 1; it needs first_crush_stress, which is not set. Set it on the Material, or give stress_ratio",
    ),
    (
        lambda: simulate(stress_ratio=[1.0, -2.0]),
        "stress_ratio[1] is -2; it must be a number of at least 0 (0 is no load)",
    ),
    (lambda: simulate(stress_ratio=[math.nan]), "stress_ratio[0] is nan; it must be a number of at least 0"),
    (
        lambda: simulate(stress_ratio=[]),
        "stress_ratio has shape (0,); it must be a list of at least one load",
    ),
    (
        lambda: simulate(stress_ratio=[1, 2], loading_rate=[0.5]),
        "it must be one number or one for each of the 2",
    ),
    (
        lambda: simulate(stress_ratio=[1, 2], loading_rate=[0, 2]),
        "loading_rate[1] is 2; it must be between 0",
    ),
    (
        lambda: simulate(stress_ratio=[1, 2], remix_after=[2]),
        "remix_after has 2; it must hold indices of loads, 0 to 1",
    ),
    (
        lambda: simulate(stress_ratio=1, engine="quasi"),
        "engine is 'quasi'; it must be one of 'auto', 'quasi-static', 'slow-update', 'full-convolution'",
    ),
    (
        lambda: simulate(stress_ratio=1, engine="slow-update", loading_rate=0.2),
        'engine "slow-update" has the slow kernel only, and this load asks for kind "blend" (loading_rate 0.2)',
    ),
    (
        lambda: simulate(stress_ratio=1, kind="exact", loading_rate=0.2),
        "loading_rate is 0.2 but kind is 'exact'",
    ),
    (
        lambda: simulate(stress_ratio=1, steps_per_load=0),
        'steps_per_load is 0; it must be "rest" or a number of at least 1',
    ),
    (
        lambda: simulate(stress_ratio=1, keep_fabrics=[1]),
        "keep_fabrics has 1; it must hold indices of loads, 0 to 0",
    ),
    (
        lambda: simulate(stress_ratio=1, keep_fabrics="some"),
        "keep_fabrics is 'some'; it must be 'auto', 'all', 'last'",
    ),
    (
        lambda: cm.Lattice(100, MATERIAL, cm.monodisperse(1.0)).run(stress_ratio=[1, 2], keep_fabrics="last").fabric(0),
        "the fabric after load 0 was not kept; add its index to keep_fabrics of run",
    ),
    (
        lambda: cm.Simulation(MATERIAL, cm.monodisperse(1.0), scheme="new"),  # type: ignore[arg-type]
        "scheme is 'new'; it must be one of 'conservative', 'paper'",
    ),
    (
        lambda: cm.Simulation(MATERIAL, cm.Fabric(GRID, STATE), grid=cm.LogGrid(-5.0, 0.0, 61)),
        "the fabric has LogGrid(psi_min=-6.0, psi_max=0.0, bins=61); leave grid out",
    ),
    (lambda: simulate(stress_ratio=math.inf), "max_stress_ratio is inf; it must be finite; with no bound"),
]

STATES: list[tuple[Callable[[], object], str]] = [
    (lambda: cm.Fabric(GRID, 2.0 * STATE), "probability adds up to 2"),
    (
        lambda: cm.Fabric(GRID, -STATE),
        "probability[0, 0] is -0.0002687449610319806; a share of the mass must be finite and at least 0",
    ),
    (
        lambda: cm.SlowUpdate(GRID, MATERIAL, scheme="paper").step(STATE * math.inf, 1e6),
        "is inf; every entry inside the crush zone",
    ),
    (
        lambda: cm.FullConvolution(GRID, MATERIAL, scheme="paper").step(STATE * math.nan, 2.0),
        "p[0, 0] is nan; every entry must be finite",
    ),
]


@pytest.mark.parametrize(("mistake", "words"), PARAMETERS + GRADINGS + RUNS + STATES)
def test_message(mistake: Callable[[], object], words: str) -> None:
    with pytest.raises(cm.ParameterError) as raised:
        mistake()
    assert words in str(raised.value)
    assert isinstance(raised.value, ValueError)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (STATE[:-1], "p has shape (60, 61); the grid needs (61, 61)"),
        (STATE[0], "p has shape (61,); the grid needs (61, 61)"),
        (
            STATE.T.copy().T,
            "p is not a C-ordered (row after row) array; np.ascontiguousarray makes one",
        ),
    ],
)
def test_wrong_shapes_and_orders_are_refused(array: np.ndarray[Any, Any], words: str) -> None:
    with pytest.raises(cm.ShapeError) as raised:
        cm.SlowUpdate(GRID, MATERIAL, scheme="paper").step(array, 2.0)
    assert words in str(raised.value)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (
            STATE.astype(np.float32),
            "p has dtype float32; it must be float64. Convert it with np.ascontiguousarray",
        ),
        (STATE.tolist(), "p is a list; it must be a NumPy float64 array"),
    ],
)
def test_wrong_types_are_refused(array: Any, words: str) -> None:
    with pytest.raises(TypeError) as raised:
        cm.SlowUpdate(GRID, MATERIAL, scheme="paper").step(array, 2.0)
    assert words in str(raised.value)


def test_out_must_be_writeable_and_apart() -> None:
    engine = cm.SlowUpdate(GRID, MATERIAL, scheme="paper")
    frozen = STATE.copy()
    frozen.flags.writeable = False
    with pytest.raises(cm.ParameterError, match="out is read-only; it must be writeable"):
        engine.step(STATE, 2.0, out=frozen)
    memory = np.zeros(61 * 62)
    with pytest.raises(cm.ShapeError, match="out overlaps p in part"):
        engine.step(memory[:-61].reshape(61, 61), 2.0, out=memory[61:].reshape(61, 61))


def test_fractions_are_read_as_such_and_said() -> None:
    curve = sieves([0.3, 0.6, 1.2], [0.0, 0.4, 1.0])
    assert curve.finer(0.6) == pytest.approx(0.4)
    assert curve.notes == ("the values end at 1: read as fractions, not per cent",)


def test_an_assumed_tail_and_an_extended_top_are_said() -> None:
    curve = sieves([0.25, 0.5, 1.0], [5, 20, 60], top="extend")
    assert curve.notes == (
        "the coarsest sieve, 1 mm, has 60 % finer, not 100 %: the curve is carried on at its last slope to 100 % "
        "at 2 mm",
        "5 % is finer than the finest sieve, 0.25 mm: it continues as a power law of slope 2, through the two "
        "finest points",
    )
    assert curve.finer(0.125) == pytest.approx(0.0125)


def test_fines_are_warned_of_with_their_share_and_size() -> None:
    sim = cm.Simulation(MATERIAL, cm.power_law(2.5, 1e-3, 1.0), grid=cm.LogGrid(-3.0, 0.1, 156))
    words = r"^[0-9.]+ % of the start lies in the fines bin: curves below a size of 0\.0503 are not"
    with pytest.warns(cm.ResolutionWarning, match=words):
        result = sim.run(stress_ratio=2.0)
    assert len(result.warnings) == 1
    wide = cm.Material(fabric_width=0.2)
    crushed = cm.Simulation(wide, cm.power_law(2.5, 0.06, 1.0), grid=cm.LogGrid(-3.0, 0.1, 156))
    words = r"^[0-9.]+ % of the mass lies in the fines bin at stress ratio 10: curves below a size of 0\.0503 are not"
    with pytest.warns(cm.ResolutionWarning, match=words):
        crushed.run(stress_ratio=10.0)


def test_neighbours_in_the_fines_bin_are_warned_of_where_they_matter() -> None:
    sim = cm.Simulation(cm.Material(fabric_width=1.0), cm.monodisperse(1.0), grid=cm.LogGrid(-6.0, 1.0, 351))
    words = (
        "neighbours in the fines bin are judged as if they had its size: curves below a size of 0.03[0-9]* "
        "are off by up to 0.2 at stress ratios up to 1000"
    )
    with pytest.warns(cm.ResolutionWarning) as warned:
        sim.run(stress_ratio=[1e3])
    assert [bool(re.match(words, str(warning.message))) for warning in warned] == [False, True]


@pytest.mark.parametrize(
    ("loads", "words"),
    [
        ([0.5, 2.0], "stress ratios below 1 crush only grains larger than the reference size"),
        ([8.0, 2.0], "unloading changes nothing"),
        ([0.0], "nothing crushed: the load path stays below what the weakest grain bears"),
    ],
)
def test_loads_that_may_surprise_are_explained_in_a_line(loads: list[float], words: str) -> None:
    notes = simulate(stress_ratio=loads).notes
    assert sum(words in note for note in notes) == 1


def test_a_lower_load_that_crushes_after_a_remixing_is_no_unloading() -> None:
    words = "after a remixing grains have new neighbours, so a load may crush that is lower than earlier ones"
    remixed = simulate(stress_ratio=[8.0, 6.0], remix_after=[0])
    assert remixed.crushes[1] > remixed.crushes[0]
    assert remixed.notes == (words,)
    both = simulate(stress_ratio=[8.0, 6.0, 2.0], remix_after=[0])
    assert both.crushes[2] == both.crushes[1]
    assert both.notes == (
        "unloading changes nothing: a load crushes only where it exceeds all earlier ones since the last remixing",
        words,
    )
    assert simulate(stress_ratio=[2.0, 8.0], remix_after=[0, 1]).notes == ()
    assert both.resume(stress_ratio=[20.0]).notes == both.notes


def test_crushes_below_rounding_are_none() -> None:
    assert explained(np.array([1.0]), np.array([2e-27]), ()) == [
        "nothing crushed: the load path stays below what the weakest grain bears"
    ]
    assert explained(np.array([1.0]), np.array([2e-9]), ()) == []

"""Surface area, work indices and compaction work."""

import csv
import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import comminute as cm
from comminute import energy

SANDS = Path(__file__).parents[3] / "examples" / "compression" / "three_sands.csv"


def test_surface_of_laws() -> None:
    log_uniform = 6.0 * (1 / 0.01 - 1.0) / math.log(100.0)
    assert energy.specific_surface(cm.log_uniform(0.01, 1.0)) == pytest.approx(log_uniform, rel=1e-6)
    power = 6.0 * 0.5 / (1.0 - 0.1) * (1.0 - 0.01**-0.5) / -0.5  # F = (sqrt(d) - .1) / .9
    assert energy.specific_surface(cm.power_law(2.5, 0.01, 1.0)) == pytest.approx(power, rel=1e-6)
    assert energy.specific_surface(cm.gap_graded(2.0, 0.5, 0.25)) == pytest.approx(
        6.0 * (0.25 / 2 + 0.75 / 0.5), rel=1e-15
    )


def test_a_cut_off_takes_the_surface_below_it_away() -> None:
    endless = cm.power_law(2.5, 0.0, 1.0)
    for smallest in (1e-3, 1e-2, 1e-8):  # the last lies below the finest point of the curve
        exact = 6.0 * 0.5 / -0.5 * (1.0 - smallest**-0.5)
        assert energy.specific_surface(endless, smallest) == pytest.approx(exact, rel=2e-3)
    sieves = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100.0, 50.0, 20.0])
    assert energy.specific_surface(sieves) < energy.specific_surface(sieves, smallest=0.01)


def test_every_crush_raises_the_bound() -> None:
    run = cm.Simulation(cm.Material(fabric_width=0.3), cm.fuller(1.0)).run(stress_ratio=[2.0, 10.0, 50.0])
    surfaces = [energy.specific_surface(run.start_curve)] + [energy.specific_surface(run.curve(k)) for k in range(3)]
    assert np.all(np.diff(surfaces) > 0.0)


@given(
    st.floats(1.0, 1e5), st.floats(1.0, 100.0), st.floats(1.0, 100.0), st.sampled_from(["kick", "bond", "rittinger"])
)
def test_works_of_two_reductions_add(product: float, one: float, two: float, law: Any) -> None:
    sizes = (product * one * two, product * one, product)
    parts = [energy.reduction_work(a, b, 11.0, law) for a, b in itertools.pairwise(sizes)]
    assert sum(parts) == pytest.approx(energy.reduction_work(sizes[0], sizes[2], 11.0, law), rel=1e-9, abs=1e-12)


def test_bonds_index_is_the_work_to_a_tenth_of_a_millimetre() -> None:
    assert energy.reduction_work(math.inf, 100.0, 13.5) == pytest.approx(13.5, rel=1e-15)
    assert energy.reduction_work(2000.0, 100.0, 13.5) == pytest.approx(135.0 * (0.1 - 2000.0**-0.5), rel=1e-14)


def test_compaction_work_of_three_sands() -> None:
    with SANDS.open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for sand in ("2QR", "OGF", "OTC"):
        points = [(float(row["stress_MPa"]), float(row["void_ratio"])) for row in rows if row["sand"] == sand]
        stress, void = [one for one, _ in points], [other for _, other in points]
        work = energy.compaction_work(stress, void, grain_density=2650.0)
        area = float(np.trapezoid(stress, [-one for one in void]))  # MPa
        assert work == pytest.approx(1e3 * area / 2650.0, rel=1e-13)
        assert 0.8 < work / 3.6 < 1.9  # kWh/t, as beds of grains take


REFUSED = [
    (lambda: energy.specific_surface(cm.fuller(1.0), 0.0), "smallest is 0"),
    (lambda: energy.specific_surface(cm.fuller(1.0), shape=0.0), "shape is 0"),
    (lambda: energy.reduction_work(1.0, 2.0, 10.0), "no smaller than the product"),
    (lambda: energy.reduction_work(2.0, 0.0, 10.0), "product is 0"),
    (lambda: energy.reduction_work(2.0, 1.0, 0.0), "index is 0"),
    (lambda: energy.reduction_work(2.0, 1.0, 1.0, "walker"), "law is 'walker'"),  # type: ignore[arg-type]
    (lambda: energy.compaction_work([1.0], [0.5], 2650.0), "one for each of two or more"),
    (lambda: energy.compaction_work([2.0, 1.0], [0.5, 0.4], 2650.0), "must not fall"),
    (lambda: energy.compaction_work([1.0, 2.0], [0.5, 0.4], 0.0), "grain_density is 0"),
]


@pytest.mark.parametrize(("call", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_is_refused(call: Any, message: str) -> None:
    with pytest.raises(cm.ParameterError, match=message):
        call()

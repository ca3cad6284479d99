"""Parameters from void ratios."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("scipy")

SANDS = Path(__file__).parents[3] / "examples" / "compression" / "three_sands.csv"
LIMITS = {"2QR": 0.035, "OGF": 0.015, "OTC": 0.025}


def points_of(sand: str) -> tuple[float, dict[float, float]]:
    """Median size and void ratio by stress of a sand."""
    with SANDS.open() as file:
        rows = [row for row in csv.DictReader(line for line in file if line[0] != "#") if row["sand"] == sand]
    return float(rows[0]["D50_mm"]), {float(row["stress_MPa"]): float(row["void_ratio"]) for row in rows}


@pytest.mark.parametrize("sand", LIMITS)
def test_three_sands(sand: str) -> None:
    median, points = points_of(sand)
    start = cm.lognormal(median, 0.2).with_unit("mm")
    stress = [10.0, 30.0, 90.0]
    measured = [points[one] for one in stress]
    found = cm.fit_compression(stress, measured, start, cm.Material(reference_size=median), initial=points[0.0])
    assert found.rms <= LIMITS[sand]
    for name, value in found.values.items():
        low, high = found.intervals[name]
        assert low < value < high
    run = cm.Simulation(found.material, start).run(stress=stress)
    assert run.void_ratio(points[0.0]) == pytest.approx(found.fitted, abs=2e-3)
    assert found.table().splitlines()[-1].startswith(f"rms {found.rms:.3f}")
    assert len(found.plot().axes[0].lines) == 2


def test_void_ratios_of_the_model_give_back_its_parameters() -> None:
    start, true = cm.lognormal(1.0, 0.2), cm.Material(fabric_width=0.3, first_crush_stress=20.0)
    stress = [15.0, 20.0, 30.0, 60.0, 120.0]
    run = cm.Simulation(true, start).run(stress=stress)
    found = cm.fit_compression(stress, run.void_ratio(0.7), start, cm.Material(), initial=0.7, error=0.01)
    assert found.rms < 1e-3
    assert found.values["fabric_width"] == pytest.approx(0.3, rel=0.03)
    assert found.values["first_crush_stress"] == pytest.approx(20.0, rel=0.01)
    for name, value in (("fabric_width", 0.3), ("first_crush_stress", 20.0)):
        assert found.intervals[name][0] < value < found.intervals[name][1]


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"stress": [10.0]}, "measured has 3 values for 1 stresses"),
    ({"stress": [0.0, 30.0, 90.0]}, "must be greater than 0 and rise"),
    ({"stress": [30.0, 10.0, 90.0]}, "must be greater than 0 and rise"),
    ({"measured": [0.6, -0.1, 0.3]}, "measured is -0.1"),
    ({"initial": 0.01}, "void_ratio is 0.01"),
    ({"error": 0.0}, "error is 0"),
    ({"free": ["loading_rate"]}, "void ratios do not tell it"),
    ({"free": ["fabric_width"]}, "first_crush_stress is neither set nor free"),
    ({"free": ["fabric_width", "first_crush_stress", "weibull_modulus", "fragment_scale"]}, "has 3 values for 4 free"),
]


@pytest.mark.parametrize(("changed", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_fitted_is_refused(changed: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"stress": [10.0, 30.0, 90.0], "measured": [0.7, 0.6, 0.4], "initial": 0.72} | changed
    start, material = cm.lognormal(1.0, 0.2), cm.Material()
    with pytest.raises(cm.ParameterError, match=message):
        cm.fit_compression(given.pop("stress"), given.pop("measured"), start, material, **given)


def test_results_of_fits_compare() -> None:
    start = cm.lognormal(1.0, 0.2)
    one, other = (
        cm.fit_compression([10.0, 30.0], [0.6, 0.4], start, cm.Material(), initial=initial) for initial in (0.7, 0.71)
    )
    assert one != other
    assert np.all(one.curve[:5] == pytest.approx(0.7, abs=0.01))

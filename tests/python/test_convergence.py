"""What docs/validation/convergence.md says of the order in the bin width."""

import runpy
from pathlib import Path
from typing import Any

import pytest

VALIDATION = Path(__file__).parents[2] / "docs" / "validation"


@pytest.fixture(scope="module")
def study() -> dict[str, Any]:
    return runpy.run_path(str(VALIDATION / "convergence.py"))


@pytest.mark.parametrize("stress_ratio", [8.0, 1e4])
@pytest.mark.parametrize("n", [0.05, 1.0])
def test_second_order_at_fixed_sizes(study: dict[str, Any], n: float, stress_ratio: float) -> None:
    of_schemes = study["errors"](n, stress_ratio)
    orders = study["orders"](of_schemes["conservative"])
    assert min(orders) > 1.97
    assert max(orders) < 2.04
    assert of_schemes["conservative"][1] < 8e-4
    assert of_schemes["paper"][2] > 5.0 * of_schemes["conservative"][2]


@pytest.mark.parametrize("stress_ratio", [8.0, 1e4])
def test_error_at_129_bins_of_the_solve_alone(study: dict[str, Any], stress_ratio: float) -> None:
    errors = study["errors"](0.05, stress_ratio, reading="cubic")["conservative"]
    assert errors[1] < 4.3e-4
    assert min(study["orders"](errors)[1:]) > 1.84


@pytest.mark.parametrize("reading", ["linear", "cubic"])
def test_a_kink_that_keeps_its_place_in_a_bin(study: dict[str, Any], reading: str) -> None:
    errors = study["errors"](100.0, 8.0, reading=reading, tip_on_centre=True)
    assert min(study["orders"](errors["conservative"])) > 1.97
    assert max(study["orders"](errors["paper"])) < 1.1


@pytest.mark.parametrize(("n", "least"), [(1.0, 1.6), (100.0, 1.9)])
@pytest.mark.parametrize("reading", ["linear", "cubic"])
def test_a_tip_that_moves_within_its_bin_leaves_the_mean_order(
    study: dict[str, Any], n: float, least: float, reading: str
) -> None:
    for on_centre in (False, True):
        errors = study["errors"](n, 8.0, reading=reading, tip_on_centre=on_centre)["conservative"]
        assert sum(study["orders"](errors)[1:]) / 3.0 > least


def test_where_all_crushes_to_fines_there_is_no_error(study: dict[str, Any]) -> None:
    assert max(study["errors"](100.0, 1e4)["conservative"]) < 1e-13


def test_the_tables_are_those_of_the_script(study: dict[str, Any]) -> None:
    page = (VALIDATION / "convergence.md").read_text(encoding="utf-8")
    for line in study["table"]([(8.0, 0.05), (1e4, 1.0)], "linear").splitlines():
        assert line in page

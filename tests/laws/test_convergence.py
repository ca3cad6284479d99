"""The order in the bin width, as docs/validation/convergence.md gives it."""

import runpy
from pathlib import Path
from typing import Any

import pytest

VALIDATION = Path(__file__).parents[2] / "docs" / "validation"


@pytest.fixture(scope="module")
def study() -> dict[str, Any]:
    return runpy.run_path(str(VALIDATION / "convergence.py"))


@pytest.mark.parametrize(("stress_ratio", "n"), [(8.0, 0.05), (8.0, 1.0), (8.0, 100.0), (1e4, 0.05), (1e4, 1.0)])
def test_second_order_at_fixed_sizes(study: dict[str, Any], n: float, stress_ratio: float) -> None:
    errors = study["errors"](n, stress_ratio, "conservative")
    assert min(study["orders"](errors)[1:]) > 1.9
    assert errors[1] < 7.8e-4


@pytest.mark.parametrize(
    ("stress_ratio", "n", "least", "error"),
    [(8.0, 0.05, 1.9, 1.2e-4), (8.0, 1.0, 1.85, 4e-4), (8.0, 100.0, 1.9, 4e-4), (1e4, 0.05, 1.9, 4.4e-4)],
)
def test_second_order_at_the_edges_next_to_the_tip_too(
    study: dict[str, Any], n: float, stress_ratio: float, least: float, error: float
) -> None:
    errors = study["errors"](n, stress_ratio, "conservative", at="edges")
    assert min(study["orders"](errors)[1:]) > least
    assert errors[1] < error


@pytest.mark.parametrize(("stress_ratio", "error"), [(8.0, 1.2e-4), (1e4, 4.4e-4)])
def test_error_at_fixed_sizes_of_the_solve_alone(study: dict[str, Any], stress_ratio: float, error: float) -> None:
    assert study["errors"](0.05, stress_ratio, "conservative", at="fixed sizes, by cubics")[1] < error


@pytest.mark.parametrize("at", ["fixed sizes", "edges"])
def test_first_order_of_the_paper_s_scheme(study: dict[str, Any], at: str) -> None:
    errors = study["errors"](100.0, 8.0, "paper", at=at)
    assert max(study["orders"](errors)) < 1.1
    for n in (0.05, 1.0):  # where the orders scatter
        of_paper, of_ours = (study["errors"](n, 8.0, scheme, at=at) for scheme in ("paper", "conservative"))
        assert of_paper[-1] > of_ours[2]


def test_where_all_crushes_to_fines_there_is_no_error(study: dict[str, Any]) -> None:
    assert max(study["errors"](100.0, 1e4, "conservative")) < 1e-13


def test_the_tables_are_those_of_the_script(study: dict[str, Any]) -> None:
    page = (VALIDATION / "convergence.md").read_text(encoding="utf-8")
    for line in study["table"]("fixed sizes", one_grid=True).splitlines():
        assert "(rounding)" in line or line in page  # digits of rounding are the machine's

"""Files and numbers of version 0.1.0: every later version opens the ones and reproduces the others."""

from pathlib import Path

import numpy as np
import pytest

import comminute as cm
import golden_runs

pytest.importorskip("typer")

HERE = Path(__file__).parent
UNMOVED = 1e-13  # largest difference of a share that a rearrangement of the same sums may make


@pytest.mark.parametrize("name", sorted(golden_runs.FIGURES))
def test_curves_of_the_papers_figures_stay(name: str) -> None:
    table = np.loadtxt(HERE / f"{name}.csv", delimiter=",")
    result = golden_runs.figure(name)
    np.testing.assert_allclose(result.edge_size, table[:, 0], rtol=1e-14)
    np.testing.assert_allclose(result.cdf.T, table[:, 1:], rtol=0.0, atol=UNMOVED)


def test_a_result_file_opens_and_resumes() -> None:
    result = cm.open_result(HERE / "sand.nc")
    assert type(result) is cm.Result
    assert result.unit == "mm"
    assert result.recipe is not None
    assert result.recipe.stress_unit == "MPa"
    np.testing.assert_array_equal(result.stress, [1.2, 12.0, 60.0, 120.0])
    np.testing.assert_allclose(result.percentile(50), [0.7071, 0.5448, 0.3439, 0.3199], rtol=2e-4)
    on = result.resume(stress=240.0)
    assert on.crushes[-1] > result.crushes[-1]


def test_a_result_file_runs_again_to_the_same_numbers() -> None:
    result = cm.open_result(HERE / "sand.nc")
    again = cm.run_again(result)
    np.testing.assert_allclose(again.cdf, result.cdf, rtol=0.0, atol=UNMOVED)
    np.testing.assert_allclose(again.crushes, result.crushes, rtol=0.0, atol=UNMOVED)


def test_a_case_and_its_sieve_table_give_the_stored_curves(tmp_path: Path) -> None:
    result, stored = golden_runs.case(tmp_path), cm.open_result(HERE / "sand.nc")
    table = np.loadtxt(HERE / "sand_curves.csv", delimiter=",")
    np.testing.assert_allclose(result.edge_size, table[:, 0], rtol=1e-14)
    np.testing.assert_allclose(result.cdf.T, table[:, 1:], rtol=0.0, atol=UNMOVED)
    assert result.stress is not None
    np.testing.assert_array_equal(result.stress, stored.stress)


def test_a_lattice_result_opens_and_is_drawn_again() -> None:
    stored = cm.open_result(HERE / "lattice.nc")
    assert isinstance(stored, cm.LatticeResult)
    again = golden_runs.lattice()
    np.testing.assert_array_equal(again.cdf, stored.cdf)
    np.testing.assert_array_equal(again.cdf_error, stored.cdf_error)


def test_no_public_name_is_lost() -> None:
    names = (HERE / "public_names.txt").read_text().split()
    assert [name for name in names if name not in cm.__all__ or not hasattr(cm, name)] == []

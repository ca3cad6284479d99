"""Mutated inputs, a few of them; `make check-long` tries more than a hundred thousand."""

import random
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import comminute as cm
import mutations


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("mutated")
    for path in mutations.SANDS.glob("*.csv"):
        (made / path.name).write_bytes(path.read_bytes())
    return made


@pytest.mark.parametrize("kind", ["csv", "toml", "nc"])
def test_mutated_files_are_read_well_or_refused_in_words(kind: str, folder: Path) -> None:
    pytest.importorskip("pydantic")
    pytest.importorskip("h5netcdf")
    good = mutations.seeds(kind)
    for data in good:
        assert mutations.try_one(kind, data, folder)
    for number in range(300):
        chance = random.Random(-number)
        mutations.try_one(kind, mutations.mutated(chance.choice(good), chance, binary=kind == "nc"), folder)


@given(data=st.binary(max_size=200) | st.text(max_size=200).map(lambda text: text.encode("utf-8", "replace")))
def test_any_bytes_are_a_table_or_refused_in_words(data: bytes, folder: Path) -> None:
    mutations.try_one("csv", data, folder)


NUMBERS = st.floats(allow_nan=True, allow_infinity=True) | st.integers(-5, 120)


@given(rows=st.lists(st.tuples(NUMBERS, NUMBERS), max_size=8))
def test_any_numbers_are_a_grading_or_refused_in_words(rows: list[tuple[float, float]], folder: Path) -> None:
    for name in ("percent_finer", "percent_retained", "percent_cumulative_retained", "mass_retained_g"):
        text = f"size_mm,{name}\n" + "".join(f"{size!r},{value!r}\n" for size, value in rows)
        mutations.try_one("csv", text.encode(), folder)


@given(retained=st.lists(st.floats(0.01, 50.0), min_size=3, max_size=10))
def test_retained_mass_is_kept_to_rounding(retained: list[float], folder: Path) -> None:
    sizes = [2.0**-k for k in range(len(retained))]
    rows = [f"{size!r},{mass!r}" for size, mass in zip(sizes, [0.0, *retained[1:-1], retained[-1]], strict=True)]
    path = folder / "mass.csv"
    path.write_text("\n".join(["size_mm,mass_retained_g", *rows, "pan,0"]))
    table = cm.Grading.read(path).to_sieves(sizes)
    total = sum(retained[1:])
    for found, mass in zip(table.percent_retained, [0.0, *retained[1:]], strict=True):
        assert found == pytest.approx(100.0 * mass / total, abs=1e-11)

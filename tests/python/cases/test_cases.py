"""Case files: what they mean, what they inherit, and what is said of mistakes in them."""

import math
from pathlib import Path

import numpy as np
import pytest

import comminute as cm

pytest.importorskip("pydantic")

from comminute.cases import schema as cases
from comminute.cases.reading import case_of_text, read_case

SANDS = Path(__file__).parents[3] / "examples" / "sands"
CASE = """
[material]
weibull_modulus = 3.0
reference_size = 2.0
first_crush_stress = 1.2
fragments = { law = "weibull", scale = 1.0 }
[grading]
kind = "gap-graded"
coarse = 2.0
fine = 0.2
[grid]
bins = 128
[load]
stress = { from = 1.2, to = 120.0, steps = 3 }
"""


def case_of(folder: Path, text: str) -> list[cases.Case]:
    path = folder / "case.toml"
    path.write_text(text)
    return [ready.resolved for ready in read_case(path)]


def changed(old: str, new: str) -> str:
    assert old in CASE
    return CASE.replace(old, new, 1)


def test_defaults_are_those_of_the_library() -> None:
    material, law = cases.MaterialTable(), cm.Material()
    for name in ("weibull_modulus", "fabric_width", "reference_size", "first_crush_stress"):
        assert getattr(material, name) == getattr(law, name)
    assert cases.Weibull().scale == cm.WeibullFragments().scale
    assert cases.GapGraded(kind="gap-graded", coarse=1.0, fine=0.1).coarse_share == 0.5
    assert cases.Fuller(kind="fuller", largest=1.0).exponent == 0.5
    assert (cases.EngineTable().name, cases.EngineTable().scheme) == ("auto", "conservative")


def test_a_case_is_resolved_in_full(tmp_path: Path) -> None:
    (case,) = case_of(tmp_path, CASE)
    np.testing.assert_allclose(case.load.stress, [1.2, 12.0, 120.0])  # type: ignore[arg-type]
    assert case.grid.bins == 128
    assert case.grid.psi_max == pytest.approx(math.log(2.0))
    spacing = (case.grid.psi_max - case.grid.psi_min) / 127  # type: ignore[operator]
    bins_between = math.log(10.0) / spacing
    assert bins_between == pytest.approx(round(bins_between))  # both point masses on centres
    (ready,) = read_case(tmp_path / "case.toml")
    again = case_of_text(ready.text(), ready.target)
    assert again.resolved == ready.resolved
    assert again.grid == ready.grid
    assert again.simulation() == ready.simulation()


def test_grids_that_are_given_in_part_still_hold_the_grading(tmp_path: Path) -> None:
    for kind in ('kind = "fuller"\nlargest = 2.0', 'kind = "gap-graded"\ncoarse = 2.0\nfine = 0.2'):
        for grid in (
            "bins = 100",
            "psi_min = -5",
            "psi_min = -5\nbins = 100",
            "psi_max = 1.0",
            "psi_max = 1.0\nbins = 99",
        ):
            text = CASE.replace('kind = "gap-graded"\ncoarse = 2.0\nfine = 0.2', kind).replace("bins = 128", grid)
            (case,) = case_of(tmp_path, text)
            assert case.grid.bins == (100 if "= 100" in grid else 99 if "= 99" in grid else case.grid.bins)
            if "psi_min" in grid:
                assert case.grid.psi_min == -5.0


def test_infinite_and_other_values_survive_the_text(tmp_path: Path) -> None:
    text = changed("reference_size", "fabric_width = inf\nreference_size")
    path = tmp_path / "case.toml"
    path.write_text(
        text.replace('law = "weibull", scale = 1.0', 'law = "tabulated", x = [0.2, 1.0], finer = [0.1, 1.0]')
    )
    (ready,) = read_case(path)
    assert ready.material.fabric_width == math.inf
    assert case_of_text(ready.text(), ready.target).material == ready.material


@pytest.mark.parametrize("name", sorted(path.name for path in SANDS.glob("*.toml")))
def test_the_shipped_cases_are_read_and_carry_their_sieves(name: str) -> None:
    for ready in read_case(SANDS / name):
        grading = ready.resolved.grading
        assert isinstance(grading, cases.Sieves)
        again = case_of_text(ready.text(), ready.target)
        assert again.grading == ready.grading
        assert again.grading.notes == ready.grading.notes


def test_sieves_of_another_unit_are_converted(tmp_path: Path) -> None:
    (tmp_path / "sand.csv").write_text("size_um;percent_finer\n2000;100\n500;0\n")
    text = CASE.replace('kind = "gap-graded"\ncoarse = 2.0\nfine = 0.2', 'file = "sand.csv"')
    (case,) = case_of(tmp_path, text)
    assert isinstance(case.grading, cases.Sieves)
    assert case.grading.size == [2000.0 / 1000.0, 0.5]
    assert case.grading.notes == ["sizes of sand.csv converted from um to mm"]


def test_lists_make_a_sweep_in_the_order_of_the_file(tmp_path: Path) -> None:
    text = changed("weibull_modulus = 3.0", "weibull_modulus = [3, 5.0]").replace(
        "scale = 1.0", "scale = [1.0, 2.0, 3.0]"
    )
    (tmp_path / "case.toml").write_text(text)
    runs = read_case(tmp_path / "case.toml")
    assert [r.target.name for r in runs] == [f"run-{k}.nc" for k in range(1, 7)]
    assert runs[1].varied == {"material.weibull_modulus": 3, "material.fragments.scale": 2.0}
    assert runs[4].material == cm.Material(
        weibull_modulus=5.0, reference_size=2.0, first_crush_stress=1.2, fragments=cm.WeibullFragments(2.0)
    )
    with pytest.raises(cm.ParameterError, match="the lists make 1002 runs; with a file for each there may be 1000"):
        case_of(tmp_path, changed("weibull_modulus = 3.0", f"weibull_modulus = {list(range(1, 1003))}"))


def test_loads_in_every_form(tmp_path: Path) -> None:
    line = "stress = { from = 1.2, to = 120.0, steps = 3 }"
    (tmp_path / "load.csv").write_text("stress_ratio\n1\n10\n")
    forms = {
        "stress_ratio = [1, 2.5]": [1.0, 2.5],
        "stress_ratio = 4": [4.0],
        'stress_ratio = { from = 0, to = 4, steps = 3, spacing = "linear" }': [0.0, 2.0, 4.0],
        'file = "load.csv"': [1.0, 10.0],
    }
    for form, expected in forms.items():
        assert case_of(tmp_path, changed(line, form))[0].load.stress_ratio == expected


MESSAGES = [
    (
        "weibull_modulus",
        "weibul_modulus",
        "case.toml [material]: weibul_modulus is an unknown key; did you mean weibull_modulus?",
    ),
    ("scale", "scal", "case.toml [material.fragments]: scal is an unknown key; did you mean scale?"),
    ("coarse =", "corse =", "case.toml [grading]: corse is an unknown key; did you mean coarse?"),
    ("[load]", "[loads]", "case.toml: loads is an unknown table; did you mean load?"),
    ("steps", "stps", "case.toml [load.stress]: stps is an unknown key; did you mean steps?"),
    ("= 3.0", "= -3.0", "case.toml [material]: weibull_modulus is -3; it must be greater than 0 and finite"),
    ("= 3.0", '= "3"', "case.toml [material]: weibull_modulus is '3'; input should be a valid number"),
    ("= 3.0", "= true", "case.toml [material]: weibull_modulus is True; input should be a valid number"),
    ("scale = 1.0", "scale = 0", "case.toml [material]: scale is 0; it must be greater than 0 and finite"),
    ("= 128", "= 7", "case.toml [grid]: bins is 7; it must be at least 8"),
    ("= 128", "= 0", "case.toml [grid]: bins is 0; it must be at least 8"),
    ("= 128", "= 20000", "case.toml [grid]: bins is 20000; input should be less than or equal to 10000"),
    ("bins", "psi_max = -1.0\nbins", "case.toml [grid]: the largest grain, 2, lies above the grid's top edge, "),
    ("bins", "psi_max = -1.0\nbins", "; raise psi_max, or leave out [grid] to have it sized from the grading"),
    (
        "fine = 0.2",
        "fine = 0.2\ncoarse_share = 1.5",
        "case.toml [grading]: coarse_share is 1.5; it must be between 0 and 1",
    ),
    ("fine = 0.2", "", "case.toml [grading]: fine is missing; it must be given"),
    (
        'kind = "gap-graded"',
        "",
        'case.toml [grading]: no grading is named; give file = "sand.csv" or kind, one of monodisperse, gap-graded',
    ),
    (
        "steps = 3 }",
        "steps = 3 }\nstress_ratio = 1.0",
        "case.toml [load]: stress and stress_ratio are both given; give one of",
    ),
    (
        "stress = {",
        "# {",
        "case.toml [load]: no load is given; give one of stress, stress_ratio, p with q, vertical with k0, file",
    ),
    (
        "from = 1.2",
        "from = -1.2",
        "case.toml [load.stress]: from or to is -1.2; it must be a finite number of at least 0",
    ),
    ("to = 120.0", "to = inf", "from or to is inf; it must be a finite number of at least 0"),
    ("from = 1.2", "from = 0", 'from or to is 0; spacing "log" needs both greater than 0'),
    (
        "{ from = 1.2, to = 120.0, steps = 3 }",
        "[1, -2]",
        "case.toml [load]: stress[1] is -2; it must be a number of at",
    ),
    ("{ from = 1.2, to = 120.0, steps = 3 }", "[1, nan]", "case.toml [load]: stress[1] is nan; it must be a number of"),
    (
        "first_crush_stress = 1.2",
        "",
        "case.toml [load]: stress is 1.2; it needs first_crush_stress, which is not set. Set it in [material], or give "
        "stress_ratio",
    ),
    (
        "steps = 3 }",
        "steps = 3 }\nremix_after = [3]",
        "case.toml [load]: remix_after has 3; it must hold indices of loads",
    ),
    (
        "[grid]",
        "[output]\nfabrics = [3]\n[grid]",
        "case.toml [output]: fabrics has 3; it must hold indices of loads, 0 to 2",
    ),
    ("[grid]", '[output]\nfile = "run.txt"\n[grid]', "case.toml [output]: file is 'run.txt'; it must end in .nc"),
    (
        "[grid]",
        '[output]\nfile = "no/run.nc"\n[grid]',
        "case.toml [output]: file is 'no/run.nc'; its folder does not exist",
    ),
    ("[grid]", '[engine]\nname = "quick"\n[grid]', "case.toml [engine]: name is 'quick'; input should be 'auto'"),
    (
        '"weibull"',
        '"weibul"',
        "[material.fragments]: law is 'weibul'; it must be one of weibull, power-law, lognormal, tab",
    ),
    ('"gap-graded"', '"gap"', "case.toml [grading]: kind is 'gap'; it must be one of file, sieves, monodisperse, gap-"),
    ("[grid]", "[grid", "case.toml is no TOML: "),
    (
        "reference_size = 2.0",
        "reference_size = []",
        "case.toml [material]: reference_size is an empty list; a sweep needs",
    ),
    ('kind = "gap-graded"', 'file = "no.csv"\n#', "no.csv is no file; give a sieve table (.csv or .xlsx)"),
]


@pytest.mark.parametrize(("old", "new", "words"), MESSAGES)
def test_message(old: str, new: str, words: str, tmp_path: Path) -> None:
    text = changed(old, new)
    if "no.csv" in new:
        text = text.replace("coarse = 2.0\nfine = 0.2", "")
    with pytest.raises(cm.ParameterError) as raised:
        case_of(tmp_path, text)
    assert words in str(raised.value)


def test_no_case_runs_code(tmp_path: Path) -> None:
    for value in (
        "\"__import__('os').system('touch owned')\"",
        '"!!python/object:os.system"',
        '"${HOME}"',
        '"`touch owned`"',
    ):
        for key in ("file", "kind"):
            with pytest.raises(cm.ParameterError):
                case_of(tmp_path, changed('kind = "gap-graded"', f"{key} = {value}"))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.toml"]

"""Errors are data: parts that every layer words for its own users, and nobody reads back from a message."""

import ast
import math
import pickle
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import comminute as cm
from comminute._core import Place, _remedies
from comminute.cases.messages import WORDS as CASES
from comminute.cases.reading import read_case
from comminute.cli.messages import WORDS as COMMAND_LINE
from comminute.util.errors import PYTHON, parameter_error, reworded

PACKAGE = Path(cm.__file__).parent
PARTS = ("parameter", "value", "number", "subject", "finding", "also", "rule", "place", "remedy")
GRID = cm.LogGrid(-6.0, 0.0, 61)
STATE = np.full((61, 61), 1.0 / 61**2)
Caught = cm.ParameterError | cm.ShapeError | cm.UnavailableError


def caught(call: Callable[[], object]) -> Caught:
    with pytest.raises((cm.ParameterError, cm.ShapeError, cm.UnavailableError)) as raised:
        call()
    error = raised.value
    assert isinstance(error, cm.ParameterError | cm.ShapeError | cm.UnavailableError)
    return error


def broken(*index: int) -> np.ndarray:
    states = np.stack([STATE] * 5)
    states[index] = np.nan
    return states


def solve_batch() -> object:
    return cm.QuasiStatic(GRID, cm.Material()).solve_batch(broken(3, 1, 2), 1e9)


# call, parameter, value, number, rule, place, remedy
PARTED: list[tuple[Callable[[], object], str, str, float | None, str, tuple[Place, ...], str]] = [
    (lambda: cm.LogGrid(-6.0, 1.0, 4), "bins", "4", 4.0, "it must be at least 8", (), ""),
    (
        lambda: cm.Fabric(cm.LogGrid(-2.0, 0.0, 8), np.full((8, 8), 1.0 / 32.0)),
        "probability",
        "2",
        2.0,
        "it holds the whole mass, 1",
        (),
        "normalise",
    ),
    (
        lambda: cm.Fabric(GRID, -STATE),
        "probability",
        str(-STATE[0, 0]),
        float(-STATE[0, 0]),
        "a share of the mass must be finite and at least 0",
        (Place("probability", [0, 0]),),
        "",
    ),
    (
        solve_batch,
        "states",
        "nan",
        math.nan,
        "every entry inside the crush zone must be finite",
        (Place("states", [3, 1, 2]),),
        "",
    ),
    (
        lambda: cm.Grading.from_sieves([0.3, 0.6], [20, 90]),
        "percent_finer",
        "90",
        90.0,
        "",
        (),
        "extend_top",
    ),
    (
        lambda: cm.Grading.from_sieves([0.3, 0.6, 1.2], [50, 40, 100]),
        "percent_finer",
        "40",
        40.0,
        "cumulative per cent finer cannot fall with size",
        (Place(row=2),),
        "cumulate_retained",
    ),
    (
        lambda: cm.Material().stress_ratio(2.0),
        "stress",
        "2",
        2.0,
        "it needs first_crush_stress, which is not set",
        (),
        "set_first_crush_stress",
    ),
    (
        lambda: cm.SlowUpdate(GRID, cm.Material()).step(STATE.T.copy().T, 2.0),
        "p",
        "",
        None,
        "",
        (),
        "order_rows",
    ),
    (
        lambda: cm.FullConvolution(GRID, cm.Material(), "medium"),  # type: ignore[arg-type]
        "kind",
        "'medium'",
        None,
        "it must be one of 'exact', 'slow', 'fast', 'blend'",
        (),
        "",
    ),
    (
        lambda: cm.SizeCurve.of(cm.Grading.from_sieves([1, 2], [20, 100])).percentile(10),
        "percent",
        "10",
        10.0,
        "",
        (),
        "extrapolate",
    ),
]


@pytest.mark.parametrize(("call", "parameter", "value", "number", "rule", "place", "remedy"), PARTED)
def test_errors_carry_their_parts(
    call: Callable[[], object],
    parameter: str,
    value: str,
    number: float | None,
    rule: str,
    place: tuple[Place, ...],
    remedy: str,
) -> None:
    error = caught(call)
    found = (error.parameter, error.value, repr(error.number), error.rule, error.place, error.remedy)
    assert found == (parameter, value, repr(number), rule, place, remedy)


@pytest.mark.parametrize("call", [parted[0] for parted in PARTED])
def test_errors_pickle_with_their_parts(call: Callable[[], object]) -> None:
    error = caught(call)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert repr([getattr(again, part) for part in PARTS]) == repr([getattr(error, part) for part in PARTS])


def test_the_classes_are_those_of_python() -> None:
    assert issubclass(cm.ParameterError, ValueError)
    assert issubclass(cm.ShapeError, ValueError)
    assert issubclass(cm.UnavailableError, RuntimeError)
    bare = cm.ParameterError("a text")
    assert str(bare) == "a text"
    assert [getattr(bare, part) for part in PARTS] == ["", "", None, "", "", None, "", (), ""]
    assert str(reworded(bare, outer="case.toml")) == "case.toml: a text"


def test_a_place_equals_by_value_pickles_and_is_written_as_users_write_it() -> None:
    entry, cell = Place("states", [3, 1, 2]), Place("sand.csv", row=5, column="size_mm")
    assert (str(entry), str(cell), str(Place(row=2))) == ("states[3, 1, 2]", "sand.csv row 5, column size_mm", "row 2")
    assert pickle.loads(pickle.dumps(cell)) == cell != entry
    assert len({cell, pickle.loads(pickle.dumps(cell)), entry}) == 2


def test_a_reader_gives_the_rows_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "sand.csv"
    path.write_text("size_mm,percent_finer\n# a comment\n1.2,100\n0.3,50\n0.6,40\n")
    error = caught(lambda: cm.Grading.read(path))
    assert (error.parameter, error.number, error.remedy) == ("percent_finer", 40.0, "name_retained_column")
    assert str(error) == (
        "sand.csv row 5: 40 % finer at 0.6 mm is less than 50 % at 0.3 mm; cumulative per cent finer cannot fall with "
        "size. Retained percentages? name the column percent_retained."
    )
    path.write_text("size_mm,percent_finer\n1.2,100\n\n0.3,50\n0.3,40\n")
    error = caught(lambda: cm.Grading.read(path))
    assert (str(error.place[0]), str(error.also)) == ("sand.csv row 5", "sand.csv row 4")
    path.write_text("size_mm,percent_finer\n1.2,100\n0.3,x\n")
    assert caught(lambda: cm.Grading.read(path)).place == (Place("sand.csv", row=3, column="percent_finer"),)


def test_a_case_words_remedies_as_its_keys(tmp_path: Path) -> None:
    (tmp_path / "sand.csv").write_text("size_mm,percent_finer\n1.2,90\n0.3,0\n")
    case = tmp_path / "case.toml"
    case.write_text('[grading]\nfile = "sand.csv"\n[load]\nstress_ratio = 2.0\n')
    error = caught(lambda: read_case(case))
    assert error.remedy == "extend_top"
    assert str(error) == (
        "sand.csv: the coarsest sieve, 1.2 mm, has 90 % finer, not 100 %; add the size that all grains pass, or write "
        'top = "extend" in [grading] to carry the last slope on to 100 %'
    )
    case.write_text('[grading]\nfile = "sand.csv"\ntop = "extend"\n[load]\nstress = 2.0\n')
    assert str(caught(lambda: read_case(case))).endswith(". Set it in [material], or give stress_ratio")


def test_every_kind_of_remedy_is_worded_in_every_layer() -> None:
    assert set(_remedies) <= set(PYTHON)
    for words in (PYTHON, CASES, COMMAND_LINE):
        assert set(words) == set(PYTHON)
        assert all(words.values())
        for kind, sentence in words.items():
            message = str(reworded(parameter_error("bins", 4, remedy=kind), words=words))
            assert message == f"bins is 4; {sentence}"


@pytest.mark.parametrize("words", [CASES, COMMAND_LINE])
def test_no_python_is_asked_of_users_who_write_none(words: dict[str, str]) -> None:
    for kind, sentence in words.items():
        assert not re.search(r"np\.|=True|with_unit|fabric\.|\(\)|top=|\bMaterial\b", sentence), (kind, sentence)


def readings_of_messages(tree: ast.AST) -> Iterator[int]:
    """Lines that look into the message of an exception: its text kept, searched, split, matched, or its args."""
    for handler in (node for node in ast.walk(tree) if isinstance(node, ast.ExceptHandler) and node.name):
        parents = {child: node for node in ast.walk(handler) for child in ast.iter_child_nodes(node)}
        for node in ast.walk(handler):
            if not (isinstance(node, ast.Name) and node.id == handler.name):
                continue
            parent = parents[node]
            if isinstance(parent, ast.Attribute) and parent.attr == "args":
                yield node.lineno
            is_text = isinstance(parent, ast.Call) and isinstance(parent.func, ast.Name) and parent.func.id == "str"
            if not (is_text or isinstance(parent, ast.FormattedValue)):
                continue
            text = parents[parent]
            of_re = (
                isinstance(text, ast.Call)
                and isinstance(text.func, ast.Attribute)
                and isinstance(text.func.value, ast.Name)
                and text.func.value.id == "re"
            )
            if of_re or isinstance(text, ast.Attribute | ast.Compare | ast.Assign | ast.Subscript):
                yield node.lineno


def test_nobody_looks_into_a_message() -> None:
    looked = []
    for path in sorted(PACKAGE.rglob("*.py")):
        lines = readings_of_messages(ast.parse(path.read_text()))
        looked += [f"{path.relative_to(PACKAGE)}:{line}" for line in lines]
    assert looked == []


@pytest.mark.parametrize(
    "line",
    [
        "message = str(error)",
        'raise ValueError(str(error).replace("a", "b"))',
        'if "below" in str(error): pass',
        'found = str(error).split(";")[0]',
        "re.match('a', str(error))",
        "raise ValueError(error.args[0])",
    ],
)
def test_that_check_finds_what_it_should(line: str) -> None:
    assert list(readings_of_messages(ast.parse(f"try:\n    pass\nexcept ValueError as error:\n    {line}")))

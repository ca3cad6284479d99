"""Comments and docstrings are sentences with a subject: none begins with Of, What, Where or Whether in its place."""

import ast
import re
import tokenize
from pathlib import Path

ROOT = Path(__file__).parents[3]
OPENINGS = re.compile(r"(Of|What|Where|Whether) [a-z]")
OF_ATTRIBUTES = re.compile(r"(Of|What|Where) [a-z]")  # a flag is well told by "Whether ..."
CPP_COMMENT = re.compile(r"//[/!]?<?\s*(.*)")
FOLDERS = ("python", "tests", "bench", "docs", "examples")


def openings_of_cpp(path: Path) -> list[tuple[int, str]]:
    """First line of each run of comment lines; one behind code stands alone."""
    found = []
    before = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        comment = CPP_COMMENT.search(line) if '"' not in line else None
        alone = comment is not None and line.lstrip().startswith("//")
        if comment is not None and not (alone and before):
            found.append((number, comment[1]))
        before = alone and "SPDX" not in line
    return found


def openings_of_python(path: Path) -> list[tuple[int, str]]:
    """First line of each docstring and of each run of comment lines."""
    text = path.read_text()
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            docstring = ast.get_docstring(node)
            if docstring:
                found.append((getattr(node, "lineno", 1), docstring))
    last = -1
    with path.open("rb") as stream:
        for token in tokenize.tokenize(stream.readline):
            if token.type == tokenize.COMMENT:
                if token.start[0] != last + 1:
                    found.append((token.start[0], token.string.lstrip("# ")))
                last = token.start[0]
    return found


CPP = sorted(path for folder in ("cpp", *FOLDERS) for path in (ROOT / folder).rglob("*.[ch]pp"))
PYTHON = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))


def test_comments_have_a_subject() -> None:
    found = []
    for path in [*CPP, *PYTHON]:
        openings = openings_of_python(path) if path.suffix == ".py" else openings_of_cpp(path)
        found += [f"{path.relative_to(ROOT)}:{number}: {text}" for number, text in openings if OPENINGS.match(text)]
    assert found == []


def test_documented_attributes_have_a_subject() -> None:
    """Texts of numpydoc sections and of bound docstrings, which stand indented below the thing that they explain."""
    found = []
    for path in [*PYTHON, *(ROOT / "python/bindings").glob("*.cpp")]:
        lines = path.read_text().splitlines()
        for number, line in enumerate(lines[1:], 2):
            named = re.fullmatch(r"\s*[a-z_, ]+ : .*", lines[number - 2])
            if named and OF_ATTRIBUTES.match(line.strip()):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert found == []

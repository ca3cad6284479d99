"""The documentation's code runs: docstring examples, and the Python of the README."""

import doctest
import importlib
import importlib.util
import inspect
import re
import shlex
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import comminute as cm

MODULES: tuple[ModuleType, ...] = tuple(
    importlib.import_module(f"comminute.{name}")
    for name in [
        "gradings.breakage",
        "gradings.curves",
        "gradings.indices",
        "gradings.reading",
        "gradings.sieves",
        "gradings.numerals",
        "gradings.openings",
        "lattice.comparison",
        "lattice.rings",
        "lattice.small_ring",
        "lattice.statistics",
        "lattice.walk",
        "lattices",
        "files.arrays",
        "files.storage",
        "opening",
        "plotting",
        "plotting.comparison",
        "plotting.everyday",
        "plotting.fabrics",
        "plotting.paper",
        "plotting.sliders",
        "result",
        "runs.continuing",
        "runs.continuum",
        "runs.load_path",
        "runs.outcomes",
        "runs.path_run",
        "runs.recipe",
        "runs.remarks",
        "runs.results",
        "runs.walk",
        "simulation",
        "util.equality",
        "util.optional",
        "util.names",
        "util.whole_files",
    ]
)
ROOT = Path(__file__).parents[3]


def documented() -> list[tuple[str, str]]:
    """Every public object and method with its docstring."""
    found = [("comminute", cm.__doc__ or "")]
    objects = {name: getattr(cm, name) for name in cm.__all__ if not name.startswith("__")}
    for module in MODULES:
        objects |= {
            name: value
            for name, value in vars(module).items()
            if inspect.isfunction(value) and value.__module__ == module.__name__ and not name.startswith("_")
        }
    for name, value in objects.items():
        found.append((name, inspect.getdoc(value) or ""))
        if inspect.isclass(value):
            found += [
                (f"{name}.{method}", inspect.getdoc(member) or "")
                for method, member in vars(value).items()
                if not method.startswith("_") and (callable(member) or isinstance(member, property | staticmethod))
            ]
    return found


@pytest.mark.parametrize(("name", "text"), documented(), ids=lambda value: value if "\n" not in value else "")
def test_every_public_thing_is_documented_and_its_examples_run(name: str, text: str) -> None:
    if name == "has_fftw":
        return  # a plain bool
    assert text.strip(), f"{name} has no docstring"
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    outcome = doctest.DocTestRunner(verbose=False).run(test)
    assert outcome.failed == 0


def test_classes_and_functions_of_the_core_show_an_example() -> None:
    exempt = {
        "Breakage",
        "Comparison",
        "FolkWard",
        "FractalFit",
        "Grading",
        "Milling",
        "Recipe",
        "SieveTable",
        "StepReport",
        "Zone",
        "stress_function",
        "stress_ratio_at",
    }
    for name, text in documented():
        core = inspect.getmodule(getattr(cm, name, None))
        if "." in name or core is None or name in exempt or name.endswith(("Error", "Warning", "Interrupted")):
            continue
        assert ">>>" in text or name.startswith("plot_"), f"{name} has no example"


def test_the_readme_runs_word_for_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```(python|console)\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert {kind for kind, _ in blocks} == {"python", "console"}
    for kind, block in blocks:
        if kind == "python":
            exec(compile(block, "README.md", "exec"), {})
            continue
        for command, expected in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
            if command.startswith("comminute "):
                call = [sys.executable, "-m", *shlex.split(command)]
                done = subprocess.run(call, capture_output=True, text=True, check=True)
                if expected:
                    assert_same_words(done.stdout, expected)
    assert (tmp_path / "sand.png").stat().st_size > 10_000


def assert_same_words(found: str, expected: str) -> None:
    """Equal word for word; numbers to two units of their fourth digit, which may differ from machine to machine."""
    assert len(found.split()) == len(expected.split()), found
    for word, wanted in zip(found.split(), expected.split(), strict=True):
        try:
            assert float(word) == pytest.approx(float(wanted), rel=2e-3, abs=1e-9)
        except ValueError:
            assert word == wanted


@pytest.mark.parametrize("page", sorted(path.name for path in (ROOT / "docs" / "guides").glob("*.md")))
def test_examples_of_the_guides_run(page: str) -> None:
    outcome = doctest.testfile(str(ROOT / "docs" / "guides" / page), module_relative=False, encoding="utf-8")
    assert outcome.attempted > 0
    assert outcome.failed == 0


def test_page_of_sieve_tables_is_up_to_date() -> None:
    script = ROOT / "docs" / "sieve_tables.py"
    spec = importlib.util.spec_from_file_location("sieve_tables", script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.PAGE.read_text(encoding="utf-8") == module.page(), "run python docs/sieve_tables.py"

"""The sources of the core name sections of docs/theory/one_sweep.md; each of these exists, and each file names one."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "theory" / "one_sweep.md"
ROOMS = ("spreading", "stepping", "sweeping", "zones")
SOURCES = sorted(path for room in ROOMS for path in (ROOT / "cpp" / "src" / room).glob("*.[ch]pp"))

# "docs/theory/one_sweep.md, section 4" or "..., sections 4 and 8", whose words may be broken over comment lines.
REFERENCE = re.compile(r"one_sweep\.md,\s+(?://+\s+)?sections?\s+(?://+\s+)?(\d+)(?:\s+and\s+(\d+))?")


def references(text: str) -> list[int]:
    return [int(number) for found in REFERENCE.findall(text) for number in found if number]


def sections() -> list[int]:
    return [int(number) for number in re.findall(r"^## (\d+)\. ", PAGE.read_text(), re.MULTILINE)]


def test_the_page_has_an_anchor_for_every_section() -> None:
    assert sections() == list(range(1, len(sections()) + 1))
    assert re.findall(r"^\(sweep-(\d+)\)=\n## \1\. ", PAGE.read_text(), re.MULTILINE) == [str(n) for n in sections()]


def test_references_are_found_in_comments() -> None:
    assert references("// The head (docs/theory/one_sweep.md,\n// sections 4 and 12).") == [4, 12]
    assert references("/// see docs/theory/one_sweep.md, section 7") == [7]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_source_begins_with_its_purpose_and_its_section(path: Path) -> None:
    licence, *lines = path.read_text().splitlines()
    assert licence == "// SPDX-License-Identifier: BSD-3-Clause"
    comment = []
    for line in lines:
        if not line.startswith("// "):
            break
        comment.append(line[3:])
    first = " ".join(comment)
    assert references(first), f"{path.name}: no section of {PAGE.name} in its first comment: {first!r}"
    assert re.fullmatch(r"[A-Z].*\(docs/theory/one_sweep\.md, sections? [\d and]+\)\.", first)


def test_every_reference_of_the_tree_exists() -> None:
    found = {
        (path.relative_to(ROOT).as_posix(), number)
        for path in sorted((ROOT / "cpp").rglob("*.[ch]pp"))
        for number in references(path.read_text())
    }
    assert found, "no reference at all"
    assert not {(path, number) for path, number in found if number not in sections()}


def test_every_term_names_a_section_that_exists() -> None:
    symbols = (PAGE.parent / "symbols.md").read_text()
    named = {int(number) for number in re.findall(r"\bsection (\d+)", symbols)}
    assert named <= set(sections())

"""The sources of the core name sections of the pages of docs/theory; each of these exists, and each file names one."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
THEORY = ROOT / "docs" / "theory"
ANCHORS = {"one_sweep": "sweep", "three_cells": "cells", "columns": "columns"}
ROOMS = {
    "spreading": "one_sweep",
    "stepping": "one_sweep",
    "sweeping": "one_sweep",
    "zones": "one_sweep",
    "resolved": "three_cells",
    "columns": "columns",
}
SOURCES = sorted(path for room in ROOMS for path in (ROOT / "cpp" / "src" / room).glob("*.[ch]pp"))

# "docs/theory/one_sweep.md, section 4" or "..., sections 4 and 8", whose words may be broken over comment lines.
REFERENCE = re.compile(r"(\w+)\.md,\s+(?://+\s+)?sections?\s+(?://+\s+)?(\d+)(?:\s+and\s+(\d+))?")


def references(text: str) -> list[tuple[str, int]]:
    return [(page, int(number)) for page, *found in REFERENCE.findall(text) for number in found if number]


def sections(page: str) -> list[int]:
    return [int(number) for number in re.findall(r"^## (\d+)\. ", (THEORY / f"{page}.md").read_text(), re.MULTILINE)]


@pytest.mark.parametrize("page", ANCHORS)
def test_the_page_has_an_anchor_for_every_section(page: str) -> None:
    numbers = sections(page)
    assert numbers == list(range(1, len(numbers) + 1))
    anchored = rf"^\({ANCHORS[page]}-(\d+)\)=\n## \1\. "
    assert re.findall(anchored, (THEORY / f"{page}.md").read_text(), re.MULTILINE) == [str(n) for n in numbers]


def test_references_are_found_in_comments() -> None:
    assert references("// The head (docs/theory/one_sweep.md,\n// sections 4 and 12).") == [
        ("one_sweep", 4),
        ("one_sweep", 12),
    ]
    assert references("/// see docs/theory/one_sweep.md, section 7") == [("one_sweep", 7)]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_source_begins_with_its_purpose_and_its_section(path: Path) -> None:
    page = ROOMS[path.parent.name]
    licence, *lines = path.read_text().splitlines()
    assert licence == "// SPDX-License-Identifier: BSD-3-Clause"
    comment = []
    for line in lines:
        if not line.startswith("// "):
            break
        comment.append(line[3:])
    first = " ".join(comment)
    assert references(first), f"{path.name}: no section of {page}.md in its first comment: {first!r}"
    assert re.fullmatch(rf"[A-Z].*\(docs/theory/{page}\.md, sections? [\d and]+\)\..*", first)


def test_every_reference_of_the_tree_exists() -> None:
    found = {
        (path.relative_to(ROOT).as_posix(), page, number)
        for path in sorted((ROOT / "cpp").rglob("*.[ch]pp"))
        for page, number in references(path.read_text())
    }
    assert found, "no reference at all"
    assert not {(path, page, number) for path, page, number in found if number not in sections(page)}


def test_every_term_names_a_section_that_exists() -> None:
    symbols = (THEORY / "symbols.md").read_text()
    named = {int(number) for number in re.findall(r"\bsection (\d+)", symbols)}
    assert named <= set(sections("one_sweep"))

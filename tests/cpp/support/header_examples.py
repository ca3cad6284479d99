"""Write one C++ test case for each @code block of the public headers: header_examples.py OUT.cpp HEADER..."""

import re
import sys
from pathlib import Path

BLOCK = re.compile(r"^ *///? ?@code\{\.cpp\}\n(.*?)^ *///? ?@endcode", re.MULTILINE | re.DOTALL)


def examples(header: Path) -> list[str]:
    """Bodies of the header's @code blocks without the comment marks."""
    return [re.sub(r"^ */// ?", "", body, flags=re.MULTILINE) for body in BLOCK.findall(header.read_text())]


def main(out: Path, headers: list[Path]) -> None:
    """Write the test source; a header without any example only declares plain data."""
    included = ("comminute/comminute.hpp", "doctest/doctest.h", "cmath", "mutex", "numeric")
    parts = ["".join(f"#include <{name}>\n" for name in included)]
    for header in headers:
        for number, body in enumerate(examples(header), 1):
            parts.append(f'TEST_CASE("{header.name}, example {number}") {{\n{body}}}\n')
    out.write_text("\n".join(parts))


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(p) for p in sys.argv[2:]])

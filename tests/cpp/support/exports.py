"""Hold what a shared library of comminute exports against the list in the tree: exports.py NM LIBRARY LIST [--write].

The list has the functions that are compiled into the library, by demangled name. Inline functions and templates may or
may not be emitted, depending on compiler and optimisation, and are not in it; no kind of symbol may come from
comminute::detail.
"""

import subprocess
import sys
from pathlib import Path


def exported(nm: str, library: Path) -> list[tuple[str, str]]:
    """Kind and demangled name of every symbol that the library defines for others, by nm's letters."""
    call = [nm, "--dynamic", "--defined-only", "--demangle", str(library)]
    lines = subprocess.run(call, capture_output=True, text=True, check=True).stdout.splitlines()
    return [(line.split()[1], line.split(maxsplit=2)[2]) for line in lines]


def main(nm: str, library: Path, listed: Path, *, write: bool) -> int:
    """Return the exit status: 0 where the two agree."""
    symbols = exported(nm, library)
    inner = sorted(name for _, name in symbols if "comminute::detail::" in name)
    if inner:
        print("exported although internal:", *inner, sep="\n  ")
    found = sorted({name for kind, name in symbols if kind == "T" and name.startswith(("comminute::", "comminute_"))})
    if write:
        listed.write_text("\n".join(found) + "\n")
    wanted = listed.read_text().splitlines()
    for verb, names in (("new", set(found) - set(wanted)), ("gone", set(wanted) - set(found))):
        if names:
            print(f"{verb} beside {listed.name}:", *sorted(names), sep="\n  ")
    return 0 if found == wanted and not inner else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), write="--write" in sys.argv))

"""Refuse includes that run against the order of the rooms: rooms.py CPP_FOLDER.

A file of cpp/src may include files of its own room and of the rooms above it, by their path from cpp/src, and public
headers whose room is one of these. A public header belongs to the room that has the .cpp file of its name.
"""

import re
import sys
from pathlib import Path

ROOMS = (
    "base",
    "simd",
    "model",
    "zones",
    "fabric",
    "gradings",
    "spreading",
    "stepping",
    "sweeping",
    "resolved",
    "columns",
    "points",
    "lattice",
    "c",
)
# The witness must not share code with what it is to witness.
SEES = {"lattice": {"base", "model", "fabric", "gradings", "lattice"}}
# Public headers that hold no more than declarations, and need no .cpp file.
WITHOUT_SOURCE = {"view": "base", "export": "base", "version": "base", "scheme": "model"}
# Libraries that are wrapped in one file, or in one room, which alone may include their headers.
WRAPPED = {"fftw3.h": "stepping/fft_plan.cpp", "Eigen/Core": "base/arrays.hpp"}
WRAPPED_FOLDERS = {"hwy": "simd"}

INCLUDE = re.compile(r'^\s*#\s*include\s+[<"]([^">]+)[">]', re.MULTILINE)


def room_of_public_headers(cpp: Path) -> dict[str, str]:
    """Room of each public header but the one that includes all."""
    found = dict(WITHOUT_SOURCE)
    for source in cpp.glob("src/*/*.cpp"):
        found[source.stem] = source.parent.name
    names = {header.stem for header in cpp.glob("include/comminute/*.hpp")} - {"comminute"}
    missing = sorted(names - set(found))
    if missing:
        raise SystemExit(f"no .cpp file, and so no room, for the public headers {missing}")
    return found


def violations(cpp: Path) -> list[str]:
    """Every include that is not allowed, with its file."""
    public = room_of_public_headers(cpp)
    sources = [(path, path.parent.name) for path in sorted(cpp.glob("src/*/*.[ch]pp"))]
    sources += [
        (path, public[path.stem]) for path in sorted(cpp.glob("include/comminute/*.hpp")) if path.stem != "comminute"
    ]
    found = [f"{path.relative_to(cpp)}: lies in no room" for path in sorted(cpp.glob("src/*.[ch]pp"))]
    for path, room in sources:
        if room not in ROOMS:
            found.append(f"{path.relative_to(cpp)}: '{room}' is not a room")
            continue
        seen = SEES.get(room, set(ROOMS[: ROOMS.index(room) + 1]))
        for included in INCLUDE.findall(path.read_text()):
            folder, _, name = included.rpartition("/")
            of = public.get(Path(name).stem) if folder == "comminute" else folder if folder in ROOMS else None
            if of is not None and of not in seen:
                found.append(f"{path.relative_to(cpp)}: room {room} must not include {included} of room {of}")
            if included == "comminute/comminute.hpp":
                found.append(f"{path.relative_to(cpp)}: includes everything; name the headers it needs")
            if folder in ROOMS and path.is_relative_to(cpp / "include"):
                found.append(f"{path.relative_to(cpp)}: a public header must not include {included}")
            if included in WRAPPED and not path.as_posix().endswith(WRAPPED[included]):
                found.append(f"{path.relative_to(cpp)}: only {WRAPPED[included]} may include {included}")
            if (only := WRAPPED_FOLDERS.get(included.split("/")[0])) not in (None, room):
                found.append(f"{path.relative_to(cpp)}: only room {only} may include {included}")
    return found


if __name__ == "__main__":
    wrong = violations(Path(sys.argv[1]))
    print(*wrong, sep="\n")
    sys.exit(1 if wrong else 0)

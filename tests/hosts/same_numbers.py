"""Hold the exact numbers that hosts print against those of the first: same_numbers.py 'COMMAND' 'COMMAND' ..."""

import shlex
import struct
import subprocess
import sys


def number(word: str) -> float:
    """Read a number in C's hexadecimal form, or the sixteen digits of its bits, as Fortran prints it."""
    if len(word) == 16 and "x" not in word:
        return float(struct.unpack(">d", bytes.fromhex(word))[0])
    return float.fromhex(word)


def printed(command: str) -> list[float]:
    """Give all numbers that a host prints; its end with an error is ours."""
    done = subprocess.run(shlex.split(command), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{command}: {done.stdout[-200:]}{done.stderr}")
    return [number(word) for word in done.stdout.split()]


wanted = printed(sys.argv[1])
for host in sys.argv[2:]:
    found = printed(host)
    differing = sum(a != b for a, b in zip(found, wanted, strict=False))
    if len(found) != len(wanted) or differing:
        raise SystemExit(f"{host}: {len(found)} numbers of {len(wanted)}, {differing} of them others")
    print(f"{host}: {len(found)} numbers, the same to the bit")

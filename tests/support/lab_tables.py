# ruff: noqa: RUF001, RUF005  (tables of words and signs)
"""Sieve tables in the many styles of laboratories, each with the sieves and the per cent finer that it holds.

`table(chance)` draws a grading and a style; what a reader makes of the text must be the grading, or an error.
"""

from __future__ import annotations

import csv
import io
import random
import re
from dataclasses import dataclass, field
from itertools import pairwise

ASTM = {"3/4 in": 19.0, "3/8 in": 9.5, "No. 4": 4.75, "No. 8": 2.36, "No. 10": 2.0, "No. 16": 1.18, "No. 20": 0.85}
ASTM |= {
    "No. 30": 0.6,
    "No. 40": 0.425,
    "No. 50": 0.3,
    "No. 60": 0.25,
    "No. 100": 0.15,
    "No. 140": 0.106,
    "No. 200": 0.075,
}
ISO = [16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.063]
SIZES = [
    "size_mm",
    "Sieve size (mm)",
    "Particle Size (mm)",
    "Opening [mm]",
    "Aperture, mm",
    "Grain size / mm",
    "d (mm)",
]
SIZES += [
    "Siebweite (mm)",
    "Korngröße in mm",
    "Maschenweite [mm]",
    "Tamis (mm)",
    "Ouverture (mm)",
    "Tamiz (mm)",
    "Abertura (mm)",
]
SIZES += [
    "Peneira (mm)",
    "Malha (mm)",
    "Setaccio (mm)",
    "Apertura (mm)",
    "ふるい目の開き (mm)",
    "粒径(mm)",
    "筛孔尺寸(mm)",
    "孔径/mm",
]
HEADERS = {
    "finer": ["percent_finer", "% passing", "Passing (%)", "Cumulative % passing", "Total % Passing", "Undersize (%)"]
    + [
        "% finer",
        "Percent finer by weight",
        "Siebdurchgang [%]",
        "Durchgang in %",
        "Passant (%)",
        "Passants cumulés (%)",
    ]
    + [
        "% que pasa",
        "Pasa (%)",
        "% passante",
        "Passante acumulada (%)",
        "Passante (%)",
        "通過質量百分率 (%)",
        "通过百分率(%)",
    ],
    "cumulative": ["percent_cumulative_retained", "Cumulative % Retained", "Cum. % ret.", "% retenido acumulado"]
    + [
        "Refus cumulé (%)",
        "Rückstand kumuliert (%)",
        "% retida acumulada",
        "加積残留率 (%)",
        "累计筛余(%)",
        "Percent coarser",
    ],
    "retained": [
        "percent_retained",
        "% Retained",
        "Individual % retained",
        "% retenido",
        "Refus partiel (%)",
        "分计筛余(%)",
    ]
    + ["% retida", "Trattenuto (%)", "残留率 (%)", "Rückstand (%)"],
    "mass": [
        "mass_retained_g",
        "Weight retained (g)",
        "Mass Retained [g]",
        "Wt. ret. (g)",
        "Rückstand (g)",
        "Masse des refus (g)",
    ]
    + [
        "Peso retenido (g)",
        "Masa retenida (g)",
        "Massa retida (g)",
        "Massa trattenuta (g)",
        "残留質量 (g)",
        "筛余质量(g)",
        "Mass (g)",
    ],
}
PANS = [
    "pan",
    "Pan",
    "PAN",
    "Bottom",
    "Receiver",
    "Schale",
    "Boden",
    "Fond",
    "Fondo",
    "Fundo",
    "受皿",
    "底盘",
    "0",
    "-",
]
FORMS = [("No. ", " in"), ("#", '"'), ("Nº ", "″"), ("US Std # ", " in"), ("ASTM No. ", " in")]
TOTALS = ["Total", "Sum", "Summe", "Suma", "Soma", "Totale", "合計", "合计"]


@dataclass
class LabTable:
    """A table as text, and what it says: sieves in mm from coarse to fine and per cent finer."""

    text: str
    size: list[float]
    finer: list[float]
    style: dict[str, object] = field(default_factory=dict)
    sample: str | None = None


def grading(chance: random.Random) -> tuple[list[str], list[float], list[int]]:
    """Names of sieves, openings in mm, and masses on each and in the pan, in tenths of a gram."""
    astm = chance.random() < 0.35
    names = list(ASTM) if astm else [f"{size:g}" for size in ISO]
    first = chance.randrange(len(names) - 4)
    count = chance.randrange(4, min(9, len(names) - first + 1))
    names = names[first : first + count]
    sizes = [ASTM[name] if astm else float(name) for name in names]
    masses = [0, *(chance.choice((0, chance.randrange(1, 900), chance.randrange(1000, 25000))) for _ in sizes[1:])]
    masses[1], masses[-1] = masses[1] or 57, masses[-1] or 41  # a curve flat at its fine end has no tail to be read
    return names, sizes, [*masses, chance.choice((chance.randrange(1, 3000), chance.randrange(1, 300)))]


def number(value: float, digits: int, decimal: str, thousands: str) -> str:
    """Write a number in a notation."""
    text = f"{value:,.{digits}f}"
    return text.replace(",", "\x00").replace(".", decimal).replace("\x00", thousands)


def table(chance: random.Random) -> LabTable:
    """One table in one style."""
    names, sizes, masses = grading(chance)
    total = sum(masses)
    below = [sum(masses[q + 1 :]) for q in range(len(sizes))]
    kind = chance.choice(list(HEADERS))
    delimiter = chance.choice([",", ",", ";", "\t", "|", "  "])
    decimal = "." if delimiter in (",", "|", "  ") else chance.choice(".,")
    thousands = chance.choice(["", "", {".": ",", ",": "."}[decimal], "'"]) if delimiter in (";", "\t") else ""
    fraction = kind != "mass" and chance.random() < 0.15
    scale = 0.01 if fraction else 1.0
    digits = 10 if fraction or chance.random() < 0.5 else 9
    exact = {
        "finer": [100.0 * b / total * scale for b in below],
        "cumulative": [100.0 * (total - b) / total * scale for b in below],
        "retained": [100.0 * m / total * scale for m in masses[:-1]],
        "mass": [m / 10.0 for m in masses[:-1]],
    }[kind]
    pan = {
        "finer": 0.0,
        "cumulative": 100.0 * scale,
        "retained": 100.0 * masses[-1] / total * scale,
        "mass": masses[-1] / 10.0,
    }[kind]
    places = 1 if kind == "mass" else digits
    values = [number(value, places, decimal, thousands) for value in exact]
    if kind != "mass" and not fraction and delimiter != "  " and chance.random() < 0.1:
        values = [value + chance.choice(["%", " %"]) for value in values]
    header, cells, way = _sizes(chance, names, sizes, decimal, kind)
    quantity = chance.choice(HEADERS[kind])
    rows = [[cell, value] for cell, value in zip(cells, values, strict=True)]
    style: dict[str, object] = {"kind": kind, "delimiter": delimiter, "sizes": way, "header": header, "value": quantity}
    retained = kind in ("retained", "mass", "cumulative")
    if retained:
        pans = [p for p in PANS if p not in ("0", "-") or way in ("plain", "unit")]
        pans += [f"<{cells[-1]}"] if way in ("plain", "unit", "names") else []
        label = "<" + re.split(r"[-–]| to ", cells[-1])[-1].strip() if way == "classes" else chance.choice(pans)
        rows.append([label, number(pan, places, decimal, thousands)])
        style["pan"] = label
    if kind == "mass" and chance.random() < 0.3:
        rows.append([chance.choice(TOTALS), number(total / 10.0, 1, decimal, thousands)])
    if chance.random() < 0.15 and not retained:
        rows.reverse()
    return LabTable(
        _written(chance, header, quantity, rows, delimiter, style), sizes, [100.0 * b / total for b in below], style
    )


def _sizes(
    chance: random.Random, names: list[str], sizes: list[float], decimal: str, kind: str
) -> tuple[str, list[str], str]:
    """Header and cells of the size column."""
    if names[0].startswith(("N", "3/")):
        number_word, inch = chance.choice(FORMS)
        shown = [name.replace("No. ", number_word).replace(" in", inch) for name in names]
        if chance.random() < 0.3:
            both = [f"{name} ({number(size, 3, decimal, '')} mm)" for name, size in zip(shown, sizes, strict=True)]
            return chance.choice(["Sieve", "Sieve size", "Sieve No."]), both, "both"
        return chance.choice(["sieve", "Sieve", "Sieve No.", "Tamiz", "Sieb"]), shown, "names"
    unit, factor, digits = chance.choice([("mm", 1.0, 3), ("mm", 1.0, 4), ("µm", 1000.0, 0), ("um", 1000.0, 0)])
    header = chance.choice(SIZES).replace("mm", unit)
    shown = [number(size * factor, digits, decimal, "") for size in sizes]
    if kind in ("retained", "mass") and chance.random() < 0.2:
        sign = chance.choice(["-", "–", " - ", " to "])
        shown = [f">{shown[0]}"] + [f"{a}{sign}{b}" for a, b in pairwise(shown)]
        return header, shown, "classes"
    if chance.random() < 0.2:
        return chance.choice(["Sieve", "Sieve size", header]), [f"{cell} {unit}" for cell in shown], "unit"
    return header, shown, "plain"


def _written(
    chance: random.Random, header: str, quantity: str, rows: list[list[str]], delimiter: str, style: dict[str, object]
) -> str:
    """Text of a table, with what may stand around it."""
    order = [0, 1] if chance.random() < 0.85 else [1, 0]
    extra = chance.random() < 0.15
    lines = [[header, quantity], *rows]
    lines = [[line[k] for k in order] for line in lines]
    if extra:
        lines = [[*line, "remarks" if k == 0 else chance.choice(["", "dry", "ok"])] for k, line in enumerate(lines)]
    above: list[list[str]] = []
    if chance.random() < 0.3:
        above = [["Sieve analysis"], ["Project", "Quarry 7"], ["Sample", "S-12"], ["Test date", "2023-04-05"]][
            : chance.randrange(1, 5)
        ]
    foot = [["Tested by", "A. B."]] if chance.random() < 0.2 else []
    style["above"], style["order"] = len(above), order
    if delimiter == "  ":
        widths = [max(len(line[k]) for line in lines) + 3 for k in range(len(lines[0]))]
        body = ["".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
        text = "\n".join([*("  ".join(line) for line in above), *body, *("  ".join(line) for line in foot)])
    else:
        out = io.StringIO()
        writer = csv.writer(out, delimiter=delimiter, lineterminator="\n")
        if chance.random() < 0.1:
            out.write(f"sep={delimiter}\n")
        writer.writerows([*above, *([[]] if above else []), *lines, *foot])
        text = out.getvalue()
    return text

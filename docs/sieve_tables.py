# ruff: noqa: E501, RUF001  (the text of a page)
"""Write docs/sieve_tables.md, the page of the sieve tables that are read, from the words that the reader knows."""

from __future__ import annotations

from pathlib import Path

from comminute.gradings.words import GRAMS, HEADER_WORDS, LENGTHS, ROW_WORDS

PAGE = Path(__file__).with_name("sieve_tables.md")
COLUMNS = {
    "size": "Size of a sieve or a grain; its unit stands in the header, in a row of units or in the cells",
    "phi": "Size on the phi scale",
    "mesh": "Sieve by its number",
    "finer": "Share or mass finer than the sieve",
    "retained": "Share or mass on each sieve",
    "coarser": "Share coarser than the sieve",
    "cumulative": "Makes what is retained a sum from the coarsest sieve down",
    "each": "Share of one class",
    "mass": "Makes the values masses",
    "count": "Number of grains of a class",
    "percent": "Makes the values per cent",
    "fraction": "Makes the values fractions",
    "sample": "Sample to which a row belongs",
    "limit": "Limit of a specification, which is not read",
    "upper": "Coarser edge of a class",
    "lower": "Finer edge of a class",
    "middle": "Middle of a class, which is refused",
    "vessel": "Mass with its vessel or sieve, which is not read",
}
ROWS = {
    "pan": "What passes the finest sieve",
    "washed": "What was washed out, added to the pan",
    "total": "Sum, which must be that of the rows",
    "initial": "Mass before sieving, which must be that of the rows to 2 %, or be given as total_mass_g",
    "loss": "What was lost in sieving, left out of the shares",
    "signature": "Who, when and how, which is not read",
    "summary": "Results such as the fineness modulus, which are not read",
}
HEAD = """# Sieve tables we read

This page is written by `docs/sieve_tables.py` from the words that the reader knows
(`python/comminute/gradings/words.py`).

`Grading.read(path)`, `comminute stats` and the table `[grading]` of a case read a sieve table as a laboratory writes it:
text with commas, semicolons, tabs, pipes or blanks between columns in UTF-8, UTF-16, Windows-1252, Shift JIS or GB 18030,
or an .xlsx workbook. Rows read are rows given, or the file is refused with the row and the remedy; notes say what was
assumed.

* **Header.** Two words decide: one for a size, one for a quantity, in any language below, in any order, with title lines,
  a `sep=` line or a row of units around it. Accents, capitals, brackets and underscores do not matter.
* **Sizes.** `4.75`, `4.75 mm`, `600 µm`, `3/8"`, `1 1/2 in`, `½"`, `No. 4`, `#4`, `Nº 10`, `US Std # 40`, `10 mesh`,
  `#10 (2.00 mm)`, phi, classes `2-1`, `−150+106`, `No. 4 to No. 8`, `>4`, `<0.063`, European `2/4`, or two columns for the
  edges of a class. Sieve numbers are those of ASTM E11, or of Tyler's series with `mesh="tyler"`.
* **Pan.** By a name below, or `<0.063`, `0`, `-`, or a blank size with the name in another column.
* **Numbers.** Decimal and thousands marks are decided once for the file; a mixture is refused, and so is a file such as
  `1,250` alone, which may be 1250 or 1.25. A curve whose top lies within 0.9 to 1.1 is one of fractions.
* **Several columns of one curve.** Masses, per cent retained, sums and per cent passing beside each other must agree to
  their rounding; so must a designation and an opening. The first row in which they do not is named.
* **Several samples.** `sample="S2"` takes one, of columns, of rows or of a long table with a column of samples; without it
  the table is refused with their names. `sheet="after"` takes one sheet of a workbook; a note names the one read.
* **What was washed out.** `total_mass_g=500` is the dry mass before washing.
* **Classes by one size.** Values belong to the class above their size, as on a sieve; `edges="upper"` says the other.
* On the command line these are `--sample`, `--sheet`, `--mesh`, `--total-mass-g` and `--edges`; in a case they are keys of
  `[grading]`. One that a table has no use for is an error.
"""


def page() -> str:
    """Text of the page."""
    parts = [HEAD, "## Words of a header", "", *_tables(HEADER_WORDS, COLUMNS)]
    parts += ["## Names of rows that are no sieves", "", *_tables(ROW_WORDS, ROWS)]
    units = ", ".join(f"`{name}`" for name in LENGTHS)
    masses = ", ".join(f"`{name}`" for name in GRAMS)
    parts += ["## Units", "", f"Lengths: {units}.", "", f"Masses: {masses}.", ""]
    return "\n".join(parts)


def _tables(words: dict[str, dict[str, str]], meanings: dict[str, str]) -> list[str]:
    lines = []
    for name, languages in words.items():
        lines += [f"**{meanings[name]}**", ""]
        lines += [f"* {language}: {text}" for language, text in languages.items()]
        lines.append("")
    return lines


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

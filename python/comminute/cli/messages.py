"""The remedies in the words of the command line. Needs pydantic."""

from __future__ import annotations

from comminute.cases import messages

# The options that a user of the command line can type, by kind of remedy; of a case file those of its keys.
WORDS: dict[str, str] = messages.WORDS | {
    "extend_top": "add the size that all grains pass, or pass --top extend to carry the last slope on to 100 %",
    "extrapolate": "--extrapolate follows the tail",
    "keep_fabric": "list it under fabrics in [output] of the case",
    "name_unit": "name it in [units] of the case",
}

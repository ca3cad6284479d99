"""What is wrong with a case file, in the words of this library. Needs pydantic."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any, get_args

from comminute.cases.schema import FRAGMENTS, GRADINGS, Case, LoadRange
from comminute.util.names import shorten

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError


def explained(error: ValidationError, raw: dict[str, Any], name: str) -> str:
    """First mistake that pydantic found, in the words of this library; unknown keys with the nearest known one."""
    found = error.errors(include_url=False)
    first = next((e for e in found if e["type"] == "extra_forbidden"), found[0])
    *tables, key = _keys_on(first["loc"], raw) or [""]
    where = f"{name} [{'.'.join(map(shorten, tables))}] {shorten(key)}" if tables else f"{name} {shorten(key)}"
    if first["type"] == "extra_forbidden":
        known = _known(tables, raw)
        near = difflib.get_close_matches(key, known, n=1, cutoff=0.0)
        meant = f"; did you mean {near[0]}?" if near else ""
        return f"{where}: unknown {'key' if tables else 'table'}{meant} (known: {', '.join(known)})"
    if first["type"] == "union_tag_invalid":
        choice, tag = first["ctx"]["discriminator"].strip("'"), str(first["ctx"]["tag"])
        known = [word.strip(" '") for word in first["ctx"]["expected_tags"].split(",")]
        near = difflib.get_close_matches(tag, known, n=1, cutoff=0.4)
        meant = f"; did you mean {near[0]}?" if near else ""
        place = f"{name} [{'.'.join(map(shorten, [*tables, key]))}]"
        return f"{place} {choice} is '{shorten(tag)}'; it must be one of {', '.join(known)}{meant}"
    if first["type"] == "missing":
        return f"{where}: is missing; it must be given"
    rule = first["msg"][0].lower() + first["msg"][1:]
    return f"{where} is {shorten(repr(first['input']))}; {rule}"


def _keys_on(loc: tuple[int | str, ...], raw: dict[str, Any]) -> list[str]:
    """Pick the keys of the file from among the parts of a place, which has tags of unions too."""
    keys: list[str] = []
    here: Any = raw
    for part in loc:
        if isinstance(here, dict) and isinstance(part, str) and (part in here or part == loc[-1]):
            keys.append(part)
            here = here.get(part)
    return keys


def _known(tables: list[str], raw: dict[str, Any]) -> list[str]:
    """Keys that a table of a case may have."""
    if not tables:
        return list(Case.model_fields)
    if tables in (["load", "stress"], ["load", "stress_ratio"]):
        models: tuple[type[BaseModel], ...] = (LoadRange,)
    elif tables == ["material", "fragments"]:
        models = FRAGMENTS
    else:
        annotation = Case.model_fields[tables[0]].annotation
        models = GRADINGS if tables[0] == "grading" else (annotation,)  # type: ignore[assignment]
    table = raw
    for key in tables:
        table = table[key]
    tag = table.get("law") or table.get("kind")
    for model in models:
        field = model.model_fields.get("law") or model.model_fields.get("kind")
        if len(models) == 1 or (field is not None and tag in get_args(field.annotation)):
            return [field.alias or key for key, field in model.model_fields.items()]
    return []

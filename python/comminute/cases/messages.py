"""Errors of case files: the remedies in the words of a case, and the first mistake that pydantic found."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any, get_args

from comminute.cases.schema import FRAGMENTS, GRADINGS, LOADS, Case, LoadRange
from comminute.util.errors import PYTHON, parameter_error
from comminute.util.names import shorten

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError

    from comminute._core import ParameterError

# The keys that a user of a case file can write, by kind of remedy.
WORDS: dict[str, str] = PYTHON | {
    "raise_psi_max": "raise psi_max in [grid]",
    "size_grid_automatically": "raise psi_max, or leave out [grid] to have it sized from the grading",
    "lower_psi_min": "lower psi_min in [grid] to resolve it",
    "resolve_fines": "lower psi_min in [grid] to resolve it",
    "extrapolate": "add finer sieves",
    "extend_top": 'add the size that all grains pass, or write top = "extend" in [grading] to carry the last slope on '
    "to 100 %",
    "set_first_crush_stress": "set it in [material], or give stress_ratio",
    "set_stress_measure": 'name it in [material], stress_measure = "mean" for example',
    "use_same_grid": "leave out [grid]",
    "use_blend_kernel": 'write kind = "blend" in [engine], or leave out loading_rate',
    "choose_path": "leave the choice to the engine",
    "record_avalanches": "record them from the start",
    "use_own_memory": "give it memory of its own",
    "order_rows": "order its rows one after the other",
    "name_unit": "name it in [units]",
    "keep_fabric": "list its load under fabrics in [output]",
    "count_from_smallest": "give the size from which to count",
}


def table_place(name: str, *tables: str) -> str:
    """Name of a file, or of a table in it, as a place: "case.toml [load.stress]"."""
    return f"{name} [{'.'.join(map(shorten, tables))}]" if tables else name


def explained(error: ValidationError, raw: dict[str, Any], name: str) -> ParameterError:
    """Make the error of the first mistake that pydantic found; unknown keys come with the nearest known one."""
    found = error.errors(include_url=False)
    first = next((e for e in found if e["type"] == "extra_forbidden"), found[0])
    *tables, key = _keys_on(first["loc"], raw) or [""]
    place, parameter = table_place(name, *tables), shorten(key)
    if first["type"] == "extra_forbidden":
        known = _known(tables, raw)
        meant = _nearest(key, known, cutoff=0.0)
        rule = f"did you mean {meant}? (known: {', '.join(known)})" if meant else "it has no keys"
        return parameter_error(parameter, "an unknown key" if tables else "an unknown table", rule, place=place)
    if first["type"] == "union_tag_invalid":
        choice, known = _choice([*tables, key])
        tag = str(first["ctx"]["tag"])
        meant = _nearest(tag, known, cutoff=0.4)
        rule = f"it must be one of {', '.join(known)}" + (f"; did you mean {meant}?" if meant else "")
        return parameter_error(choice, f"'{shorten(tag)}'", rule, place=table_place(name, *tables, key))
    if first["type"] == "missing":
        return parameter_error(parameter, "missing", "it must be given", place=place)
    rule = first["msg"][0].lower() + first["msg"][1:]
    return parameter_error(parameter, shorten(repr(first["input"])), rule, place=place)


def _nearest(word: str, known: list[str], *, cutoff: float) -> str:
    """Known word that is nearest; empty where none is near enough."""
    return next(iter(difflib.get_close_matches(word, known, n=1, cutoff=cutoff)), "")


def _choice(tables: list[str]) -> tuple[str, list[str]]:
    """Key by whose value a table is one of several kinds, and the values that it may have."""
    key, models = ("law", FRAGMENTS) if tables == ["material", "fragments"] else ("kind", GRADINGS)
    return key, [tag for model in models for tag in get_args(model.model_fields[key].annotation)]


def _keys_on(loc: tuple[int | str, ...], raw: dict[str, Any]) -> list[str]:
    """Keys of the file among the parts of a pydantic place, which has the tags of unions too."""
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
    if len(tables) == 2 and tables[0] == "load" and tables[1] in LOADS:
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

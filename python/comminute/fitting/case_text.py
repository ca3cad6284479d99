"""A case file from the outcome of a fit."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np

from comminute._core import Grading, Material, WeibullFragments
from comminute.gradings.curves import SizeCurve
from comminute.util.errors import parameter_error


def case_text(
    material: Material,
    start: Grading,
    loads: Sequence[float],
    loading_rate: float,
    closure: str,
    units: Mapping[str, str],
    remarks: Sequence[str],
) -> str:
    """Text of a case with a material, a start as sieves, and loads.

    Parameters
    ----------
    material : Material
    start : Grading
    loads : sequence of float
        Stresses, or stress ratios where the material has no first crush stress.
    loading_rate : float
    closure : str
    units : mapping of str to str
        Of "size" and "stress"; an empty one is left out.
    remarks : sequence of str
        Lines of the comment at its head.

    Raises
    ------
    ParameterError
        For a start with exact sizes, and for fragments that a case does not name by two numbers.
    """
    curve = SizeCurve.of(start)
    fragments = material.fragments
    if not isinstance(fragments, WeibullFragments):
        kind = type(fragments).__name__
        raise parameter_error("path", ".toml", "write .json instead", finding=f"cannot have a case with {kind}")
    if np.any(np.diff(curve.size) == 0.0):
        rule = "write .json instead"
        raise parameter_error("path", ".toml", rule, finding="cannot have a case whose start has exact sizes")
    kind = "stress" if material.first_crush_stress is not None else "stress_ratio"
    tables: dict[str, dict[str, object]] = {
        "units": {name: unit for name, unit in units.items() if unit},
        "material": {
            "weibull_modulus": material.weibull_modulus,
            "fabric_width": material.fabric_width,
            "reference_size": material.reference_size,
            "first_crush_stress": material.first_crush_stress,
            "stress_measure": material.stress_measure.name if material.stress_measure else None,
            "poisson": material.stress_measure.poisson if material.stress_measure else None,
            "k0": material.k0,
            "strength_scatter": material.strength_scatter or None,
        },
        "material.fragments": {"law": "weibull", "scale": fragments.scale, "shape": fragments.shape},
        "grading": {
            "kind": "sieves",
            "size": [float(size) for size in curve.size],
            "percent_finer": [float(100.0 * finer) for finer in curve.finer],
        },
        "load": {kind: sorted(loads), "loading_rate": loading_rate or None},
        "engine": {} if closure == "paper" else {"closure": "resolved"},
    }
    lines = [f"# {remark}" for remark in remarks]
    for table, entries in tables.items():
        given = {key: value for key, value in entries.items() if value is not None}
        if given:
            lines += ["", f"[{table}]", *(f"{key} = {json.dumps(value)}" for key, value in given.items())]
    return "\n".join(lines) + "\n"

"""Parameters that a fit may free: their bounds, the scale on which they are sought, and the material they make."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from comminute._core import Material, WeibullFragments
from comminute.util.choices import Closure
from comminute.util.errors import parameter_error

FRAGMENTS = {"fragment_scale": "scale", "fragment_shape": "shape"}
OF_MATERIAL = ("fabric_width", "weibull_modulus", "first_crush_stress")
FREE = (*OF_MATERIAL, *FRAGMENTS, "loading_rate")


@dataclass(frozen=True)
class Parameter:
    """A number that a fit seeks.

    Attributes
    ----------
    name : str
    low, high : float
        Bounds; no fit leaves them.
    usual_low, usual_high : float
        Range from which further starts of the search are taken.
    by_ratio : bool
        Sought by its logarithm, since it is positive and its error a matter of ratios.
    """

    name: str
    low: float
    high: float
    usual_low: float
    usual_high: float
    by_ratio: bool = True

    def inner(self, value: float) -> float:
        """Give the number on the scale of the search."""
        return math.log(value) if self.by_ratio else value

    def outer(self, inner: float) -> float:
        """Give the value of a number on the scale of the search, a bound to the last digit."""
        if inner <= self.inner(self.low):
            return self.low
        if inner >= self.inner(self.high):
            return self.high
        return math.exp(inner) if self.by_ratio else inner


def parameters_of(
    free: Sequence[str], material: Material, largest_stress: float, closure: Closure | str, *, by_ratio: bool
) -> list[Parameter]:
    """Parameters by their names.

    Parameters
    ----------
    free : sequence of str
        Names among `FREE`.
    material : Material
        Material that has all other values.
    largest_stress : float
        Largest load of the data, which bounds the first crush stress.
    closure : str
        Model that is fitted; only the paper's closure knows a loading rate.
    by_ratio : bool
        Loads are stress ratios, so that there is no first crush stress to be found.

    Raises
    ------
    ParameterError
        For a name that it does not know, that stands twice, or that the data can never tell.
    """
    known = {
        "fabric_width": Parameter("fabric_width", 0.01, 10.0, 0.05, 1.5),
        "weibull_modulus": Parameter("weibull_modulus", 0.3, 50.0, 1.5, 12.0),
        "first_crush_stress": Parameter(
            "first_crush_stress", 1e-4 * largest_stress, 1e2 * largest_stress, 1e-2 * largest_stress, largest_stress
        ),
        "fragment_scale": Parameter("fragment_scale", 0.05, 20.0, 0.3, 2.0),
        "fragment_shape": Parameter("fragment_shape", 0.1, 20.0, 0.5, 2.0),
        "loading_rate": Parameter("loading_rate", 0.0, 1.0, 0.0, 1.0, by_ratio=False),
    }
    if not free:
        raise parameter_error("free", "()", f"it must name at least one of {', '.join(FREE)}", finding="is empty")
    for name in free:
        if name == "reference_size":
            rule = (
                "only first_crush_stress reference_size**(3 / weibull_modulus) can be told from data: "
                "set reference_size to a size of your choice, and free first_crush_stress"
            )
            raise parameter_error("free", "'reference_size'", rule, finding="names 'reference_size'")
        if name not in known:
            rule = f"it must be one of {', '.join(FREE)}"
            raise parameter_error("free", f"'{name}'", rule, finding=f"names '{name}'")
        if free.count(name) > 1:
            raise parameter_error("free", f"'{name}'", "name it once", finding=f"names '{name}' twice")
        if name in FRAGMENTS and not isinstance(material.fragments, WeibullFragments):
            kind = type(material.fragments).__name__
            rule = f"it belongs to WeibullFragments, and the material has {kind}"
            raise parameter_error("free", f"'{name}'", rule, finding=f"names '{name}'")
        if name == "loading_rate" and closure != "paper":
            rule = "only closure 'paper' knows a loading rate"
            raise parameter_error("free", f"'{name}'", rule, finding=f"names '{name}'")
        if name == "first_crush_stress" and by_ratio:
            rule = "loads are stress ratios, which have no stress: give stresses, or leave it out"
            raise parameter_error("free", f"'{name}'", rule, finding=f"names '{name}'")
    return [known[name] for name in free]


def material_with(material: Material, values: Mapping[str, float]) -> Material:
    """Give a material with other values.

    Parameters
    ----------
    material : Material
    values : mapping of str to float
        By the names of `FREE`; a loading rate is no matter of the material.
    """
    fragments = material.fragments
    named = {FRAGMENTS[name]: value for name, value in values.items() if name in FRAGMENTS}
    if named:
        assert isinstance(fragments, WeibullFragments)  # as `parameters_of` requires
        shape, scale = named.get("shape", fragments.shape), named.get("scale", fragments.scale)
        fragments = WeibullFragments(scale=scale, shape=shape)
    return Material(
        weibull_modulus=values.get("weibull_modulus", material.weibull_modulus),
        fabric_width=values.get("fabric_width", material.fabric_width),
        first_crush_stress=values.get("first_crush_stress", material.first_crush_stress),
        reference_size=material.reference_size,
        fragments=fragments,
        stress_measure=material.stress_measure,
        k0=material.k0,
        strength_scatter=material.strength_scatter,
    )


def value_in(material: Material, name: str, smallest_stress: float) -> float:
    """Give the value from which the search starts; a first crush stress that is not set is half the least load."""
    if name in FRAGMENTS:
        return float(getattr(material.fragments, FRAGMENTS[name]))
    if name == "first_crush_stress":
        return material.first_crush_stress or 0.5 * smallest_stress
    if name == "loading_rate":
        return 0.0
    return float(getattr(material, name))

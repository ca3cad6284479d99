"""Reference for masses at exact sizes, in plain NumPy: points, and lines on which one of the two sizes is exact.

An atom (psi, psibar) whose psi grain crushes leaves fragments of psi beside a neighbourhood that is still exactly
psibar: a line. So does an exact size mixed with a spread grading. Here a line is cut into so many parts of a bin that
its own discretisation does not matter: each part is a packet at its centre, all of it moves or none. Whatever crushes
at the exact size enters the bins, and there the sweep of `reference_quasi_static` takes over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

import reference as ref
import reference_quasi_static as qs
from reference import Array, Law, Model

Axis = Literal["grain", "neighbour"]


class Atom(NamedTuple):
    """Mass at one point."""

    psi: float
    psibar: float
    mass: float


@dataclass(frozen=True)
class Line:
    """Mass with one size exact; `fine` by parts of the bins of the other, [0] being the whole fines bin."""

    exact: Axis
    at: float
    fine: Array


class Rest(NamedTuple):
    """Mass at rest, and mass that crushed."""

    p: Array
    atoms: list[Atom]
    lines: list[Line]
    crushed: float
    crushed_neighbour: float


def part_edges(psi: Array, parts: int) -> Array:
    """Upper edges of the fines bin and of the parts of the other bins."""
    spacing = ref._spacing(psi)
    return np.asarray(psi[0] + 0.5 * spacing + spacing / parts * np.arange((len(psi) - 1) * parts + 1))


def part_centres(psi: Array, parts: int) -> Array:
    """Centres of the fines bin and of the parts of the other bins."""
    return np.append(psi[0], part_edges(psi, parts)[1:] - 0.5 * ref._spacing(psi) / parts)


def in_bins(fine: Array, bins: int) -> Array:
    """Masses of parts added up to bins."""
    return np.append(fine[0], fine[1:].reshape(bins - 1, -1).sum(axis=1))


def even_line(exact: Axis, at: float, mass: Array, parts: int) -> Line:
    """Line whose mass is even over each bin."""
    return Line(exact, at, np.append(mass[0], np.repeat(mass[1:] / parts, parts)))


def _landing(edges: Array, at: float, law: Law) -> Array:
    """Fragments of an exact size by upper edges of the bins in which they land."""
    return np.diff(law.cdf(np.minimum(edges - at, 0.0)), prepend=0.0)


class _Lines:
    """Lines by their place."""

    def __init__(self, lines: list[Line], size: int) -> None:
        self._size = size
        self.masses: dict[tuple[Axis, float], Array] = {}
        for line in lines:
            self.onto(line.exact, line.at)[:] += line.fine

    def onto(self, exact: Axis, at: float) -> Array:
        return self.masses.setdefault((exact, at), np.zeros(self._size))


def settle_points(
    p: Array,
    atoms: list[Atom],
    lines: list[Line],
    psi: Array,
    model: Model,
    stress_ratio: float,
    settled_at: float | None = None,
    loading_rate: float = 0.0,
    parts: int = 40,
) -> Rest:
    """State after infinitely slow loading from settled_at, conservative scheme."""
    edges, places, bins = part_edges(psi, parts), part_centres(psi, parts), len(psi)
    of_bins = ref._upper_edges(psi)
    bin_of = np.append(0, 1 + np.arange(len(places) - 1) // parts)
    held, arrived = _Lines(lines, len(places)), np.zeros(p.shape)
    count = {"grain": 0.0, "neighbour": 0.0}
    other: dict[Axis, Axis] = {"grain": "neighbour", "neighbour": "grain"}

    def enters(exact: Axis, of_exact: Array, of_other: Array) -> None:
        arrived[:] += np.outer(of_exact, of_other) if exact == "grain" else np.outer(of_other, of_exact)

    left = [atom for atom in atoms if not qs.atom_crushes(qs.Atom(*atom), psi, model, stress_ratio)]
    for a, b, mass in (atom for atom in atoms if atom not in left):
        near = abs(a - b) <= 8.0 * ref.EPS * max(1.0, abs(a), abs(b))
        slow = (1.0 - loading_rate) * mass
        first = slow * (0.5 if near else float(a > b))
        if first > 0.0:
            held.onto("neighbour", b)[:] += first * _landing(edges, a, model.law)
        if slow > first:
            held.onto("grain", a)[:] += (slow - first) * _landing(edges, b, model.law)
        both = loading_rate * mass
        arrived += both * np.outer(_landing(of_bins, a, model.law), _landing(of_bins, b, model.law))
        count["grain"] += first + both
        count["neighbour"] += slow - first + both

    log_stress = ref._log_stress(stress_ratio)
    slope, log_reference = 3.0 / model.weibull_modulus, math.log(model.reference_size)
    for exact, at in held.masses:
        fine = held.masses[exact, at]
        load = log_stress + slope * (np.maximum(places, at) - log_reference)
        active = load >= (places - at) ** 2 / (2.0 * model.fabric_width**2)  # Eq. (2) of the larger grain
        own = _landing(of_bins, at, model.law)
        for k in np.flatnonzero(active)[::-1]:
            mass, fine[k] = fine[k], 0.0
            if mass == 0.0:
                continue
            there = np.eye(bins)[bin_of[k]]
            if places[k] > at:
                landing = _landing(edges, places[k], model.law)
                again = mass / (1.0 - (1.0 - loading_rate) * landing[k])  # what stays in the part crushes again
                landing[k] = 0.0
                fine[:] += (1.0 - loading_rate) * again * landing
                both, slow = loading_rate * again, (1.0 - loading_rate) * again
                count[other[exact]] += slow
            else:
                both, slow = loading_rate * mass, (1.0 - loading_rate) * mass
                enters(exact, slow * own, there)
                count[exact] += slow
            enters(exact, both * own, _landing(of_bins, float(places[k]), model.law))
            count["grain"] += both
            count["neighbour"] += both

    settled = qs.settle(p, psi, model, stress_ratio, settled_at, "conservative", loading_rate, arrived)
    return Rest(
        settled.p,
        left,
        [Line(exact, at, fine) for (exact, at), fine in held.masses.items() if fine.any()],
        count["grain"] + settled.crushed,
        count["neighbour"] + settled.crushed_neighbour,
    )


def grainsize(rest: Rest, psi: Array) -> Array:
    """Marginal over psibar, exact sizes in the bins that hold them."""
    marginal = rest.p.sum(axis=1)
    spacing = ref._spacing(psi)
    for atom in rest.atoms:
        marginal[math.floor((atom.psi - psi[0]) / spacing + 0.5)] += atom.mass
    for line in rest.lines:
        if line.exact == "neighbour":
            marginal += in_bins(line.fine, len(psi))
        else:
            marginal[math.floor((line.at - psi[0]) / spacing + 0.5)] += line.fine.sum()
    return np.asarray(marginal)

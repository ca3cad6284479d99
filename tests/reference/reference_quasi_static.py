"""Reference implementation of quasi-static crushing, in plain NumPy: one sweep to rest instead of many steps.

Written from the equations of Huang, Marks & Einav (2020), doi:10.1016/j.jmps.2020.103897, on top of `reference`,
whose conventions hold here too. Every active cell is spread by its own dense kernel: slow, short, easy to check.

Why one sweep is enough. Where a packet of mass goes next depends on its position alone; the load only decides
whether it has to move, and zones only grow with the largest load so far. So a packet walks until it first stands
outside the zone of that load, whatever the steps between, and a crush never makes a grain larger: with the cells
taken from large to small, each is final once its turn is over.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

import reference as ref
import reference_shares
from reference import Array, Law, Model, Rule

Scheme = Literal["conservative", "paper"]


# --- fragments ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class LogNormal:
    """Log-normal law cut off at X = 1: R = ln X is normal with this mean and deviation, given that R <= 0."""

    mean: float = -1.0
    sd: float = 1.0

    def _below(self, r: Array) -> Array:
        """Probability of r or below before the cut, without cancellation in the lower tail."""
        score = (np.asarray(r) - self.mean) / (self.sd * math.sqrt(2.0))
        return np.array([0.5 * math.erfc(-z) for z in score.ravel()]).reshape(score.shape)

    def cdf(self, r: Array) -> Array:
        """Probability of a reduction to r or below."""
        return np.asarray(self._below(r) / self._below(np.zeros(1)))

    def pdf(self, r: Array) -> Array:
        """Density in r."""
        density = np.exp(-0.5 * ((r - self.mean) / self.sd) ** 2) / (self.sd * math.sqrt(2.0 * math.pi))
        return np.asarray(density / self._below(np.zeros(1)))


@dataclass(frozen=True)
class Tabulated:
    """Law given as P[X <= x] = finer at increasing x, the last point being (1, 1), and linear in ln x between.

    Below the first point it is zero if finer is zero there, else the power law through the first two points.
    """

    x: tuple[float, ...]
    finer: tuple[float, ...]

    def __post_init__(self) -> None:
        rising = len(self.x) == len(self.finer) > 1 and self.x[0] > 0.0 and bool((np.diff(self.x) > 0.0).all())
        if not (rising and self.x[-1] == 1.0):
            raise ValueError("x must increase from above 0 to 1, with one value of the cdf for each")
        if not (self.finer[0] >= 0.0 and self.finer[-1] == 1.0 and bool((np.diff(self.finer) >= 0.0).all())):
            raise ValueError("the cdf must not fall, start below 0 or end off 1")
        if self.finer[0] > 0.0 and self.finer[1] == self.finer[0]:
            raise ValueError("no power law below the first point: the cdf is the same at the first two")

    @property
    def kinks(self) -> Array:
        """Reductions at which the density jumps."""
        return np.asarray(np.log(self.x))

    @property
    def exponent(self) -> float:
        """Exponent of the power law below the first point."""
        return math.log(self.finer[1] / self.finer[0]) / math.log(self.x[1] / self.x[0]) if self.finer[0] else 1.0

    def cdf(self, r: Array) -> Array:
        """Probability of a reduction to r or below."""
        tail = self.finer[0] * np.exp(self.exponent * np.minimum(r - self.kinks[0], 0.0))
        return np.where(r < self.kinks[0], tail, np.interp(r, self.kinks, self.finer))

    def pdf(self, r: Array) -> Array:
        """Density in r."""
        slope = np.diff(self.finer) / np.diff(self.kinks)
        interval = np.clip(np.searchsorted(self.kinks, r, side="right") - 1, 0, len(slope) - 1)
        return np.where(r < self.kinks[0], self.exponent * self.cdf(r), slope[interval])


def fragment_masses(law: Law, spacing: float, bins: int, rule: Rule) -> Array:
    """Probability f_m as in `reference.fragment_pmf`, by panels that also end where the density jumps."""
    node, weight = ref._panels()
    kinks = law.kinks if isinstance(law, Tabulated) else np.zeros(0)
    pmf = np.zeros(bins + 1)
    for m in range(bins):  # the reductions from low to low + h
        low, high = -(m + 1) * spacing, -m * spacing
        for left, right in pairwise([low, *kinks[(kinks > low) & (kinks < high)], high]):
            r = left + (right - left) * node
            mass = (right - left) * weight * law.pdf(r)
            # A bin shifted by r overlaps bins m and m+1; by the paper's rule all of it moves to bin m+1.
            nearer = (r - low) / spacing if rule == "conservative" else np.zeros(len(r))
            pmf[m] += mass @ nearer
            pmf[m + 1] += mass @ (1.0 - nearer)
    return pmf[:bins]


def crush_lines(psi: Array, law: Law, rule: Rule) -> Array:
    """Row i: where one crush takes the mass of bin i along its axis; bin 0 keeps all that falls below it."""
    pmf = fragment_masses(law, ref._spacing(psi), len(psi), rule)
    lines = np.zeros((len(psi), len(psi)))
    for i in range(len(psi)):
        lines[i, 1 : i + 1] = pmf[:i][::-1]
        lines[i, 0] = max(0.0, 1.0 - math.fsum(pmf[:i]))
    return lines


# --- the sweep ----------------------------------------------------------------------------------------------


class Settled(NamedTuple):
    """State at rest, and the mass that crushed on the way: in psi, and in psibar, once for every crush."""

    p: Array
    crushed: float
    crushed_neighbour: float


def fractions(psi: Array, model: Model, stress_ratio: float, scheme: Scheme) -> Array:
    """Share of each cell that the slow rule moves."""
    if scheme == "paper":  # the whole cell or nothing, by its centre; the zones 01, 10 and 11 alike, Eq. (63)
        return (ref.zones(psi, model, stress_ratio) > 0).astype(np.float64)
    if scheme == "conservative":
        return reference_shares.active_share(psi, model, stress_ratio)
    raise ValueError(f"unknown scheme {scheme!r}")


def _share_of_settled(before: Array, after: Array) -> Array:
    """Share of the mass settled at one load that a higher load moves, given the active shares at both.

    Mass is uniform over its cell; what settled fills the part outside the old zone, 1 - before, and of that part
    after - before is now inside. Where the whole cell was active nothing can have settled.
    """
    return np.divide(after - before, 1.0 - before, out=np.zeros(before.shape), where=before < 1.0)


def _from_large_to_small(bins: int) -> Iterator[tuple[int, int]]:
    """Cells in an order in which mass only ever moves to a later one.

    Shell m holds the cells whose larger index is m. Its diagonal cell comes first, since its fragments land in
    both arms of the same shell. Each arm runs downwards: with the fast kernel the larger grain may stay in its
    bin while the smaller one moves on along the arm.
    """
    for m in range(bins - 1, -1, -1):
        yield m, m
        for k in range(m - 1, -1, -1):
            yield m, k
            yield k, m


def sweep(
    p: Array, arrived: Array, settled_share: Array, arriving_share: Array, lines: Array, loading_rate: float
) -> Settled:
    """Sweep to rest: p has settled, and moves by settled_share; arrived and what lands later, by arriving_share."""
    rest, arrived = np.zeros(p.shape), arrived.copy()
    crushed = crushed_neighbour = 0.0
    # Which grain crushes, were the cell active: (1 - alpha) slow + alpha fast, Eq. (67).
    psi_only, psibar_only, both = ref.shares(np.full(p.shape, 3, dtype=np.uint8), "blend", loading_rate)
    for i, j in _from_large_to_small(len(p)):
        # Mass that lands in the cell is shared once between its active part and the rest.
        moving = float(p[i, j] * settled_share[i, j] + arrived[i, j] * arriving_share[i, j])
        rest[i, j] = p[i, j] * (1.0 - settled_share[i, j]) + arrived[i, j] * (1.0 - arriving_share[i, j])
        if moving == 0.0:
            continue
        share = (float(psi_only[i, j]), float(psibar_only[i, j]), float(both[i, j]))
        # Mass that a crush leaves in the cell is still in its active part and crushes again, and so on until all has
        # left: the kernel without its own cell, divided by what leaves at a time. For i, j > 0 that is 1 less
        # (1 - alpha) f_0 + alpha f_0^2: a fast crush stays only if both grains do, and moves the mass along one
        # axis only if one of them does. In row or column 0 it is 1 - f_0 for any alpha: fines stay fines.
        kernel = ref._kernel(i, j, share, lines)
        kernel[i, j] = 0.0
        leaving = float(kernel.sum())
        arrived += moving / leaving * kernel
        crushed += moving / leaving * (share[0] + share[2])
        crushed_neighbour += moving / leaving * (share[1] + share[2])
    return Settled(rest, crushed, crushed_neighbour)


def settle(
    p: Array,
    psi: Array,
    model: Model,
    stress_ratio: float,
    settled_at: float | None = None,
    scheme: Scheme = "conservative",
    loading_rate: float = 0.0,
    arrived: Array | None = None,
) -> Settled:
    """State after infinitely slow loading from settled_at, the largest load so far; arrived comes from elsewhere."""
    before = np.zeros(p.shape) if settled_at is None else fractions(psi, model, settled_at, scheme)
    after = np.maximum(before, fractions(psi, model, stress_ratio, scheme))  # zones are nested: unloading moves none
    arrived = np.zeros(p.shape) if arrived is None else arrived
    return sweep(p, arrived, _share_of_settled(before, after), after, crush_lines(psi, model.law, scheme), loading_rate)


def settle_path(
    p: Array,
    psi: Array,
    model: Model,
    loads: Sequence[float],
    settled_at: float | None = None,
    scheme: Scheme = "conservative",
    loading_rate: float = 0.0,
) -> list[Settled]:
    """State after each load in turn, with the crushes since the start of the path."""
    path, largest = [Settled(p, 0.0, 0.0)], 0.0 if settled_at is None else settled_at
    for load in loads:
        p, *more = settle(path[-1].p, psi, model, load, largest, scheme, loading_rate)
        path.append(Settled(p, path[-1].crushed + more[0], path[-1].crushed_neighbour + more[1]))
        largest = max(largest, load)
    return path[1:]


# --- atoms --------------------------------------------------------------------------------------------------


class Atom(NamedTuple):
    """Mass at one point, not spread over a cell: all of it crushes, or none."""

    psi: float
    psibar: float
    mass: float


class SettledAtoms(NamedTuple):
    """Grid state at rest, the atoms that did not crush, and the mass that crushed, as in `Settled`."""

    p: Array
    atoms: list[Atom]
    crushed: float
    crushed_neighbour: float


def atom_crushes(atom: Atom, psi: Array, model: Model, stress_ratio: float) -> bool:
    """Tell whether an atom lies in the crush zone, Eqs. (52)-(55), which is closed; fines among fines rest."""
    log_stress = ref._log_stress(stress_ratio)
    if log_stress == -math.inf or max(atom.psi, atom.psibar) <= ref._upper_edges(psi)[0]:
        return False
    crushes = ref._psi_crushes(np.array([atom.psi, atom.psibar, *psi]), model, log_stress)  # with the grid's slack
    return bool(crushes[0, 1] or crushes[1, 0])


def _at_rest(at: float, psi: Array) -> Array:
    """Bin shares of a point: hat weights between the two nearest centres, which keep the mean of psi."""
    place = np.clip((at - psi[0]) / ref._spacing(psi), 0.0, len(psi) - 1.0)
    return np.asarray(np.maximum(0.0, 1.0 - np.abs(place - np.arange(len(psi)))))


def _fragments(at: float, psi: Array, law: Law) -> Array:
    """Bin shares of the fragments of a point, exact; all that is below the grid goes to the fines bin."""
    return ref._bin_masses(law.cdf(np.minimum(ref._upper_edges(psi) - at, 0.0)))


def spread_atom(atom: Atom, psi: Array, law: Law, loading_rate: float) -> tuple[Array, float, float]:
    """Places to which one crush takes an atom, and the mass that crushed in psi and in psibar, Eq. (67)."""
    # Sizes that are equal but for rounding count as equal: each grain crushes first in half of the cases.
    near = abs(atom.psi - atom.psibar) <= 8.0 * ref.EPS * max(1.0, abs(atom.psi), abs(atom.psibar))
    slow = 0.5 if near else float(atom.psi > atom.psibar)
    psi_only, psibar_only = (1.0 - loading_rate) * slow, (1.0 - loading_rate) * (1.0 - slow)
    crushed, crushed_neighbour = _fragments(atom.psi, psi, law), _fragments(atom.psibar, psi, law)
    spread = psi_only * np.outer(crushed, _at_rest(atom.psibar, psi))
    spread += psibar_only * np.outer(_at_rest(atom.psi, psi), crushed_neighbour)
    spread += loading_rate * np.outer(crushed, crushed_neighbour)
    return atom.mass * spread, atom.mass * (psi_only + loading_rate), atom.mass * (psibar_only + loading_rate)


def settle_atoms(
    p: Array,
    atoms: Sequence[tuple[float, float, float]],
    psi: Array,
    model: Model,
    stress_ratio: float,
    settled_at: float | None = None,
    scheme: Scheme = "conservative",
    loading_rate: float = 0.0,
) -> SettledAtoms:
    """State after infinitely slow loading of atoms (psi, psibar, mass) together with a grid state p."""
    arrived, crushed, crushed_neighbour = np.zeros(p.shape), 0.0, 0.0
    left = [Atom(*atom) for atom in atoms if not atom_crushes(Atom(*atom), psi, model, stress_ratio)]
    for atom in (each for each in atoms if each not in left):
        spread, first, first_neighbour = spread_atom(Atom(*atom), psi, model.law, loading_rate)
        arrived += spread
        crushed, crushed_neighbour = crushed + first, crushed_neighbour + first_neighbour
    settled = settle(p, psi, model, stress_ratio, settled_at, scheme, loading_rate, arrived)
    return SettledAtoms(settled.p, left, crushed + settled.crushed, crushed_neighbour + settled.crushed_neighbour)

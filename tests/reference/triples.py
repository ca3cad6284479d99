"""The law of three cells, written from its equations (docs/theory/three_cells.md) with dense arrays, for few nodes.

Arrays are indexed [b, a, c] for the centre b between a and c, and [a, b] for centres b beside a. A cell's own chain of
crushes between the same neighbours is one linear system here, solved as such.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Nodes:
    """Ends of the nodes in ln(size), the fines bin first, with all that depends on them alone."""

    lower: Floats
    upper: Floats
    width: float  # of the fabric, n
    modulus: float  # w
    cdf: Callable[[Floats], Floats]  # of R = ln X
    geometric: bool = False
    scattered: bool = False  # strengths

    @property
    def centre(self) -> Floats:
        """(N,) middles of the nodes."""
        return 0.5 * (self.lower + self.upper)

    @property
    def k(self) -> float:
        """Strength of a log size (Eq. 15)."""
        return 6.0 * self.width**2 / self.modulus

    def neighbourhood(self) -> tuple[Floats, Floats]:
        """Log of the mean of two sizes, and the square of its spread, (N, N)."""
        psi, extent = self.centre, self.upper - self.lower
        size = np.exp(psi)
        if self.geometric:
            share = np.full((psi.size, psi.size), 0.5)
            mean = 0.5 * (psi[:, None] + psi)
        else:
            share = size[:, None] / (size[:, None] + size)
            mean = np.log(0.5 * (size[:, None] + size))
        return mean, (share * extent[:, None]) ** 2 + ((1.0 - share) * extent) ** 2

    def fragments(self) -> Floats:
        """(N, N) share of one crush of b that ends in b'; the source is spread over its bin (20 000 points)."""
        count, exact = self.centre.size, self.lower == self.upper
        found = np.zeros((count, count))
        for b in range(count):
            points = (np.arange(20_000) + 0.5) / 20_000 if not exact[b] else np.array([0.5])
            source = self.lower[b] + points * (self.upper[b] - self.lower[b])
            for i in range(1, b + 1):
                if not exact[i]:
                    share = self.cdf(np.minimum(self.upper[i] - source, 0.0)) - self.cdf(
                        np.minimum(self.lower[i] - source, 0.0)
                    )
                    found[b, i] = share.mean()
            found[b, 0] = 1.0 - found[b, 1:].sum()
        return found

    def active(self, level: float) -> Floats:
        """(N, N, N) share of each triple inside the crush zone."""
        psi, extent, exact = self.centre, self.upper - self.lower, self.lower == self.upper
        mean, spread = self.neighbourhood()
        half = np.sqrt(np.maximum(level + self.k * psi, 0.0))[:, None, None]
        x = psi[:, None, None] - mean
        edge = np.sqrt((extent**2)[:, None, None] + spread + (0.01 * self.width) ** 2)
        share = np.clip((half - x) / edge + 0.5, 0, 1) - np.clip((-half - x) / edge + 0.5, 0, 1)
        share[np.broadcast_to(half == 0.0, share.shape)] = 0.0
        tie = exact[:, None, None] & exact[None, :, None] & exact
        rise = 0.002 * self.width**2
        at_once = np.clip(1.0 + (level - (x**2 - self.k * psi[:, None, None])) / rise, 0.0, 1.0)
        share = np.where(tie, at_once, share)
        share[0] = 0.0  # the fines bin
        return share

    def exposed(self, level: float) -> tuple[Floats, Floats]:
        """(N, N, N) share of each triple that a load crushes, and hazard that the rest has endured on average.

        Where strengths scatter, by the mean over 1000 contrasts of each triple.
        """
        if not self.scattered:
            active = self.active(level)
            return active, np.zeros_like(active)
        psi, extent, exact = self.centre, self.upper - self.lower, self.lower == self.upper
        mean, spread = self.neighbourhood()
        log_hazard = (0.5 * self.modulus / self.width**2 * (level + self.k * psi))[:, None, None]
        edge = np.sqrt((extent**2)[:, None, None] + spread + (0.01 * self.width) ** 2)
        edge[exact[:, None, None] & exact[None, :, None] & exact] = 0.0
        share, borne = np.zeros(edge.shape), np.zeros(edge.shape)
        for place in (np.arange(1000) + 0.5) / 1000 - 0.5:
            contrast = (psi[:, None, None] - mean + place * edge) * math.sqrt(self.modulus) / self.width
            hazard = np.exp(log_hazard - 0.5 * contrast**2)
            share -= np.expm1(-hazard) / 1000
            borne += hazard * np.exp(-hazard) / 1000
        rest = np.maximum(1.0 - share, 1e-300)
        share[0], borne[0] = 0.0, 0.0  # the fines bin
        return share, np.minimum(borne / rest, hazard_of(share))


def hazard_of(share: Floats) -> Floats:
    """Hazard that a share of cells has not endured, no more than e^-37 can tell."""
    hazard: Floats = -np.log(np.maximum(1.0 - share, math.exp(-37.0)))
    return hazard


@dataclass
class State:
    """Settled and pending mass, and the share that is active under the load."""

    settled: Floats
    pending: Floats
    active: Floats
    own: Floats  # hazard that cells have endured which were always in their triple
    endured: Floats  # hazard that settled mass has endured, times it
    scattered: bool
    crushes: float = 0.0

    @classmethod
    def mixed(cls, pmf: Floats, scattered: bool = False) -> State:
        """Mix the nodes at random."""
        mass = np.einsum("b,a,c->bac", pmf, pmf, pmf)
        none = np.zeros((4, *mass.shape))
        return cls(mass, none[0], none[1], none[2], none[3], scattered)

    def copy(self) -> State:
        """Copy all arrays."""
        settled, pending, active = self.settled.copy(), self.pending.copy(), self.active.copy()
        return State(settled, pending, active, self.own.copy(), self.endured.copy(), self.scattered, self.crushes)

    def pmf(self) -> Floats:
        """(N,) mass by node."""
        grading: Floats = (self.settled + self.pending).sum(axis=(1, 2))
        return grading

    def pairs(self) -> Floats:
        """(N, N) mass of centres b beside a."""
        mass: Floats = (self.settled + self.pending).sum(axis=2).T
        return mass

    def overrun(self, active: Floats) -> Floats:
        """(N, N, N) settled mass that a rise of the shares overruns."""
        if self.scattered:
            already = np.maximum(hazard_of(self.active), self._mean(self.endured, self.settled))
            return self.settled * -np.expm1(-np.maximum(hazard_of(active) - already, 0.0))
        rest = np.where(self.active < 1.0, 1.0 - self.active, 1.0)
        return self.settled * np.maximum(active - self.active, 0.0) / rest

    @staticmethod
    def _mean(moment: Floats, mass: Floats) -> Floats:
        return np.divide(moment, mass, out=np.zeros_like(mass), where=mass > 0.0)

    def step(self, exposed: tuple[Floats, Floats], fragments: Floats) -> None:
        """Raise the load to where shares and hazards are `exposed`."""
        active, own = exposed
        taken = self.overrun(active)
        endured = self._mean(self.endured, self.settled)
        self.settled -= taken
        self.pending += taken
        self.active, self.own = active, own
        self.endured = self.settled * np.maximum(endured, own)
        pairs, waiting = self.pairs(), self.pending.sum(axis=2).T
        wanted = np.maximum(2.0 * waiting + waiting.T, 2.0 * waiting.T + waiting)
        limit = np.where(wanted > pairs, pairs / np.where(wanted > 0.0, wanted, 1.0), 1.0)
        limit = np.minimum(limit, limit.T)
        crushing = self.pending * limit.T[:, :, None] * limit.T[:, None, :]
        self.pending -= crushing

        between = active.transpose(1, 2, 0)  # [a, c, b]
        system = np.eye(fragments.shape[0]) - fragments * between[:, :, None, :]
        ends = np.linalg.solve(system, fragments * (1.0 - between)[:, :, None, :])
        count = np.linalg.solve(system, np.ones((*between.shape, 1)))[..., 0]
        self.crushes += float(np.einsum("bac,acb->", crushing, count))
        landed = np.einsum("bac,acbi->iac", crushing, ends)
        beside = np.einsum("bac,acbi->abi", crushing, ends)

        gone = crushing.sum(axis=2).T
        keeping = pairs.T - gone.T
        share = np.divide(gone, keeping, out=np.zeros_like(gone), where=gone > 0.0)
        moved = np.divide(beside, keeping[:, :, None], out=np.zeros_like(beside), where=gone[:, :, None] > 0.0)
        around = self.settled + self.pending
        arriving = np.einsum("azb,abi->azi", around, moved)
        arriving += arriving.transpose(0, 2, 1)
        stays = 1.0 - share[:, :, None] - share[:, None, :]
        settling = (1.0 - active) * arriving
        if self.scattered:
            borne = np.einsum("azb,abi->azi", self.endured, moved)
            waiting = np.einsum("azb,abi->azi", self.pending, moved)
            waiting += waiting.transpose(0, 2, 1)
            waiting[active == 0.0] = 0.0  # pending mass lies where something is active
            before = self._mean(borne + borne.transpose(0, 2, 1), arriving - waiting)
            settling = (arriving - waiting) * np.exp(-np.maximum(hazard_of(active) - before, 0.0))
            self.endured = self.endured * stays + settling * np.maximum(before, own) + landed * own
        self.settled = self.settled * stays + settling + landed
        self.pending = self.pending * stays + arriving - settling


@dataclass
class Clock:
    """A coarse and a fine state on one clock of loads; results are twice the fine less the coarse."""

    nodes: Nodes
    pmf_at_start: Floats
    tolerance: float = 0.02
    max_step: float = 0.25
    fragments: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.fragments = self.nodes.fragments()
        self.coarse, self.fine = (State.mixed(self.pmf_at_start, self.nodes.scattered) for _ in range(2))
        top = self.nodes.upper[-1]
        early = 32.0 * self.nodes.width**2 / self.nodes.modulus if self.nodes.scattered else 0.0
        self.at = self._log_load(-self.nodes.k * top - 0.004 * self.nodes.width**2 - early)
        self.hint = 0.01

    def _log_load(self, level: float) -> float:
        return level / (2.0 * self.nodes.width**2)

    def _exposed(self, log_load: float) -> tuple[Floats, Floats]:
        return self.nodes.exposed(2.0 * self.nodes.width**2 * log_load)

    def _next(self) -> tuple[float, float]:
        step = min(self.hint, self.max_step)
        pairs = self.coarse.pairs()
        while True:
            shell = self.coarse.overrun(self._exposed(self.at + step)[0]).sum(axis=2).T
            clash = np.divide(shell**2, pairs, out=np.zeros_like(shell), where=pairs > 0.0).sum()
            hardness = max(shell.sum(), math.sqrt(clash)) / self.tolerance
            if hardness <= 1.0 or step < 1e-7:
                break
            step *= min(max(0.9 / hardness, 0.1), 0.8)
        return self.at + step, step * (min(max(0.9 / hardness, 1.0), 4.0) if hardness > 0.0 else 4.0)

    def _advance(self, coarse: State, fine: State, log_load: float) -> None:
        coarse.step(self._exposed(log_load), self.fragments)
        fine.step(self._exposed(0.5 * (self.at + log_load)), self.fragments)
        fine.step(self._exposed(log_load), self.fragments)

    def load_to(self, stress_ratio: float) -> tuple[Floats, float]:
        """Give the grading and the crushes a cell under a load that is no lower than the last."""
        log_load = math.log(stress_ratio)
        while (found := self._next())[0] <= log_load:
            self._advance(self.coarse, self.fine, found[0])
            self.at, self.hint = found
        coarse, fine = self.coarse.copy(), self.fine.copy()
        if log_load > self.at:
            self._advance(coarse, fine, log_load)
        return 2.0 * fine.pmf() - coarse.pmf(), 2.0 * fine.crushes - coarse.crushes

"""Reference implementation of comminution with grainsize fabric, in plain NumPy.

Written from the equations of Huang, Marks & Einav (2020), doi:10.1016/j.jmps.2020.103897, whose numbers the
comments cite. Zones and kernels are dense and quadratures blunt: this code is slow, short and easy to check.
Arrays over two axes are indexed [i, j] = [psi, psibar], both growing with size; psi = ln s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Zones = npt.NDArray[np.uint8]
Kind = Literal["exact", "slow", "fast", "blend"]
Rule = Literal["paper", "conservative"]
Mean = Literal["arithmetic", "geometric"]

EPS = float(np.finfo(np.float64).eps)


# --- grid ---------------------------------------------------------------------------------------------------


def centres(psi_min: float, psi_max: float, bins: int) -> Array:
    """Bin centres; bin 0 is the fines bin and stands for everything below its upper edge."""
    return np.asarray(psi_min + np.arange(bins) * ((psi_max - psi_min) / (bins - 1)), dtype=np.float64)


def _spacing(psi: Array) -> float:
    """Bin width in psi."""
    return float(psi[-1] - psi[0]) / (len(psi) - 1)


def _upper_edges(psi: Array) -> Array:
    """Upper bin edges in psi."""
    return psi + 0.5 * _spacing(psi)


# --- fragments ----------------------------------------------------------------------------------------------


class Law(Protocol):
    """Law of R = ln X on (-inf, 0], X being the factor by which a crush reduces the grainsize."""

    def cdf(self, r: Array) -> Array:
        """Probability of a reduction to r or below."""

    def pdf(self, r: Array) -> Array:
        """Density in r, f(r) = x rho_X(x) at x = e^r."""


@dataclass(frozen=True)
class Weibull:
    """Weibull law cut off at X = 1, Eq. (3); Eq. (4) for scale = shape = 1."""

    scale: float = 1.0
    shape: float = 1.0

    def cdf(self, r: Array) -> Array:
        """Integral of Eq. (3) from 0 to e^r."""
        rate = self.scale**-self.shape
        return np.asarray(np.expm1(-rate * np.exp(self.shape * r)) / math.expm1(-rate))

    def pdf(self, r: Array) -> Array:
        """Density in r."""
        rate = self.scale**-self.shape
        hazard = rate * np.exp(self.shape * r)
        return np.asarray(self.shape * hazard * np.exp(-hazard) / -math.expm1(-rate))


@dataclass(frozen=True)
class PowerLaw:
    """Power law F_X(x) = x**exponent on (0, 1]; exponent 1 is the uniform law."""

    exponent: float = 1.0

    def cdf(self, r: Array) -> Array:
        """Probability of a reduction to r or below."""
        return np.exp(self.exponent * r)

    def pdf(self, r: Array) -> Array:
        """Density in r."""
        return self.exponent * np.exp(self.exponent * r)


def _panels(panels: int = 48, points: int = 12) -> tuple[Array, Array]:
    """Nodes and weights of a composite Gauss rule on (0, 1)."""
    node, weight = np.polynomial.legendre.leggauss(points)
    nodes = (np.arange(panels)[:, None] + 0.5 * (1.0 + node)) / panels
    return nodes.ravel(), np.tile(0.5 * weight / panels, panels)


def fragment_pmf(law: Law, spacing: float, bins: int, rule: Rule) -> Array:
    """Probability f_m, m = 0..bins-1, that one crush moves mass down by m bins."""
    node, weight = _panels()
    # Row m covers the reductions -(m+1)h < r < -mh; node is the place in that interval, from its lower end.
    density = spacing * law.pdf((node - 1.0 - np.arange(bins)[:, None]) * spacing)
    if rule == "paper":  # before Eq. (58): a reduction of any size below one bin moves the mass by one bin
        return np.concatenate([[0.0], density @ weight])[:bins]
    if rule == "conservative":  # a bin shifted by r overlaps bins m and m+1 in the shares node and 1-node
        pmf = density @ (weight * node)
        pmf[1:] += (density @ (weight * (1.0 - node)))[:-1]
        return np.asarray(pmf)
    raise ValueError(f"unknown fragment rule {rule!r}")


# --- crush zones --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Model:
    """Material: Weibull modulus w, fabric scaling parameter n, reference size s_max, fragment law."""

    weibull_modulus: float = 3.0
    fabric_width: float = 0.05
    reference_size: float = 1.0
    law: Law = Weibull()


def _log_stress(stress_ratio: float) -> float:
    """Log of the stress ratio, -inf for no load."""
    if not stress_ratio >= 0.0:
        raise ValueError(f"stress ratio must not be negative or NaN, got {stress_ratio}")
    return math.log(stress_ratio) if stress_ratio > 0.0 else -math.inf


def _psi_crushes(psi: Array, model: Model, log_stress: float) -> npt.NDArray[np.bool_]:
    """Tell whether the psi grain of each cell crushes: g(psi, psibar) <= g* of Eq. (15), divided by 2 n^2."""
    slope, log_reference = 3.0 / model.weibull_modulus, math.log(model.reference_size)
    gap = psi[:, None] - psi[None, :]
    resistance = -slope * (psi[:, None] - log_reference) + gap**2 / (2.0 * model.fabric_width**2)
    # The zone is closed. A bin centre carries a rounding error of the order of eps * reach, reach being the
    # largest |psi|, and hands it on to every term, to the last one by the factor gap / n^2. Without slack,
    # that error would decide whether a cell on the boundary crushes.
    reach = max(float(np.abs(psi).max()), abs(log_reference))
    magnitude = abs(log_stress) + slope * reach + np.abs(gap) * reach / model.fabric_width**2
    return np.asarray(log_stress >= resistance - 8.0 * EPS * magnitude)


def zones(psi: Array, model: Model, stress_ratio: float) -> Zones:
    """Crush zone at every cell centre, Eqs. (52)-(55): 0 = 00, 1 = 01, 2 = 10, 3 = 11."""
    log_stress = _log_stress(stress_ratio)
    if log_stress == -math.inf:
        return np.zeros((len(psi), len(psi)), dtype=np.uint8)
    crushes = _psi_crushes(psi, model, log_stress)
    zone = (2 * crushes + crushes.T).astype(np.uint8)  # transposed, psibar is the grain and psi its neighbour
    zone[0, 0] = 0  # fines among fines have nowhere to go
    return zone


def active_share(psi: Array, model: Model, stress_ratio: float, points: int = 20000) -> Array:
    """Share of each cell's area in which the larger of the two grains crushes."""
    share = np.zeros((len(psi), len(psi)))
    log_stress, spacing = _log_stress(stress_ratio), _spacing(psi)
    curvature = 6.0 * model.fabric_width**2 / model.weibull_modulus  # k of Eq. (15)
    least = math.log(model.reference_size) - model.weibull_modulus / 3.0 * log_stress  # here W = 0
    v = (np.arange(points) + 0.5) / points
    for m, larger in enumerate(psi):
        onset = (least - larger) / spacing
        if onset >= 0.5:
            continue
        # Midpoint rule over the place t of the larger grain in its bin. W rises from the onset like a square
        # root (at once, without fabric), so the points crowd there: t = start + (1/2 - start) v^2.
        start = max(onset, -0.5)
        rise = (0.5 - start) * v**2
        t, weight = start + rise, 2.0 * (0.5 - start) * v / points
        width = np.sqrt(curvature / spacing * (start - onset + rise))  # W / h
        for d in range(m + 1):
            # Length of the smaller grain's bin that lies within W below the larger grain.
            length = np.clip(0.5 - d - t + width, 0.0, 1.0)
            if d == 0:  # either grain may be the larger one: two triangles
                length = 2.0 * np.minimum(width, t + 0.5)
            share[m, m - d] = share[m - d, m] = weight @ length
    share[0, 0] = 0.0
    return share


# --- one step -----------------------------------------------------------------------------------------------
#
# A case worked by hand. Four bins, psi = -3, -2, -1, 0, h = 1; w = 4, n = 1, s_max = e, sigma = e^3.25.
#
# Load on a grain of bin i, ln sigma + (3/w)(psi - ln s_max) = 3.25 + 0.75 (psi - 1):  0.25  1.00  1.75  2.50
# Shielding by the neighbour, (psi - psibar)^2 / (2 n^2), for |i-j| = 0, 1, 2, 3:       0     0.5   2     4.5
# A grain crushes where load >= shielding. No cell is nearer to the boundary than 0.25. By pairs of bins:
#
#   (0,0)  0.25 >= 0, but the fines bin rests: 00     (2,0)  1.75 < 2   and 0.25 < 2:    00, (0,2) 00
#   (1,1)  1.00 >= 0:                          11     (2,1)  1.75 >= .5 and 1.00 >= .5:  11, (1,2) 11
#   (2,2)  1.75 >= 0:                          11     (3,0)  2.50 < 4.5 and 0.25 < 4.5:  00, (0,3) 00
#   (3,3)  2.50 >= 0:                          11     (3,1)  2.50 >= 2  and 1.00 < 2:    10, (1,3) 01
#   (1,0)  1.00 >= .5 and 0.25 < .5:  10, (0,1) 01    (3,2)  2.50 >= .5 and 1.75 >= .5:  11, (2,3) 11
#
# Fragments F_X(x) = x^a, a = ln 2.5: F(-m h) = 0.4^m and, by the paper rule, f_1, f_2, ... = 0.6, 0.24, ....
# One crush takes bin 3 to bins 0, 1, 2 in shares L3 = (.16, .24, .6), bin 2 to bins 0, 1 in L2 = (.4, .6),
# bins 1 and 0 to bin 0. Per mille of mass in each cell, and where the exact kernel (59) takes it:
#
#   at rest    (0,0) 20, (0,2) 30, (0,3) 10, (2,0) 70, (3,0) 40
#   (0,1) 50   row 0: 50 to (0,0)                       (1,0) 80    column 0: 80 to (0,0)
#   (1,3) 60   row 1: 9.6, 14.4, 36 by L3               (3,1) 200   column 1: 32, 48, 120 by L3
#   (1,1) 100  100 to (0,0)                             (2,2) 90    row 0: 14.4, 21.6; row 1: 21.6, 32.4
#   (1,2) 40   row 0: 16, 24                            (2,1) 120   column 0: 48, 72
#   (2,3) 20   L2 x L3, row 0: 1.28, 1.92, 4.8; row 1: 1.92, 2.88, 7.2
#   (3,2) 10   L3 x L2, column 0: .64, .96, 2.4; column 1: .96, 1.44, 3.6
#   (3,3) 60   L3 x L3, row 0: 1.536, 2.304, 5.76; row 1: 2.304, 3.456, 8.64; row 2: 5.76, 8.64, 21.6
#
# so that (0,0) = 20 + 50 + 80 + 100 + 14.4 + 16 + 48 + 1.28 + .64 + 1.536 = 331.856, and so on cell by cell.
# Under the slow kernel (63) zones 00, 01 and 10 do the same, and in the others the larger crushes:
#
#   (1,2) 40   row 1: 16, 24 by L2                      (2,1) 120   column 1: 48, 72 by L2
#   (2,3) 20   row 2: 3.2, 4.8, 12 by L3                (3,2) 10    column 2: 1.6, 2.4, 6 by L3
#   (1,1) 100  50 to (0,1), 50 to (1,0)                 (2,2) 90    column 2: 18, 27 and row 2: 18, 27
#   (3,3) 60   column 3: 4.8, 7.2, 18 and row 3: 4.8, 7.2, 18
#
# so that (1,1) = 14.4 + 48 + 24 + 72 = 158.4. The fast kernel (68) differs from the exact one in 01 and 10:
#
#   (1,3) 60   row 0: 9.6, 14.4, 36                     (3,1) 200   column 0: 32, 48, 120
#   (0,1) 50 and (1,0) 80 to (0,0) as before
#
# Blend (67) at a loading rate of 1/4: 3/4 slow + 1/4 fast.


class HandCase(NamedTuple):
    """A case worked by hand: a start, its crush zones, and the state after one step of each kernel."""

    psi: Array
    model: Model
    stress_ratio: float
    loading_rate: float
    p: Array
    zones: Zones
    exact: Array
    slow: Array
    fast: Array
    blend: Array


def _thousandths(*rows: tuple[float, ...]) -> Array:
    """State written in per mille."""
    return np.array(rows, dtype=np.float64) / 1000.0


HAND_CASE = HandCase(
    psi=np.array([-3.0, -2.0, -1.0, 0.0]),
    model=Model(weibull_modulus=4.0, fabric_width=1.0, reference_size=math.e, law=PowerLaw(math.log(2.5))),
    stress_ratio=math.exp(3.25),
    loading_rate=0.25,
    p=_thousandths((20, 50, 30, 10), (80, 100, 40, 60), (70, 120, 90, 20), (40, 200, 10, 60)),
    zones=np.array([[0, 1, 0, 0], [2, 3, 3, 1], [0, 3, 3, 3], [0, 2, 3, 3]], dtype=np.uint8),
    exact=_thousandths(
        (331.856, 82.784, 40.56, 10), (108.384, 102.576, 51.84, 0), (78.16, 132.24, 21.6, 0), (40, 0, 0, 0)
    ),
    slow=_thousandths((150, 130, 49.6, 14.8), (75.6, 158.4, 65.4, 7.2), (91.2, 151.8, 18, 18), (44.8, 7.2, 18, 0)),
    fast=_thousandths(
        (373.456, 65.184, 76.56, 10), (146.784, 40.176, 15.84, 0), (198.16, 12.24, 21.6, 0), (40, 0, 0, 0)
    ),
    blend=_thousandths(
        (205.864, 113.796, 56.34, 13.6),
        (93.396, 128.844, 53.01, 5.4),
        (117.94, 116.91, 18.9, 13.5),
        (43.6, 5.4, 13.5, 0),
    ),
)


def shares(zone_array: Zones, kind: Kind, loading_rate: float) -> tuple[Array, Array, Array]:
    """Share of each cell's mass that crushes in psi only, in psibar only, and in both, in one step."""
    none, active = np.zeros(zone_array.shape), (zone_array > 0).astype(np.float64)
    if kind == "exact":  # Eq. (59), its first case being A_00 and its last f_i f_j
        psi_only, psibar_only, both = ((zone_array == zone).astype(np.float64) for zone in (2, 1, 3))
        return psi_only, psibar_only, both
    if kind == "slow":  # Eq. (63) with its cases i > j and i < j exchanged: the larger grain crushes
        half = 0.5 * np.eye(len(zone_array))
        larger = np.tril(np.ones(zone_array.shape), -1) + half
        return active * larger, active * larger.T, none
    if kind == "fast":  # Eq. (68), its second case being the complement of A_00
        return none, none, active
    if kind == "blend":  # Eq. (67)
        psi_only, psibar_only, _ = shares(zone_array, "slow", loading_rate)
        return (1.0 - loading_rate) * psi_only, (1.0 - loading_rate) * psibar_only, loading_rate * active
    raise ValueError(f"unknown kernel {kind!r}")


def _lines(psi: Array, model: Model, rule: Rule) -> Array:
    """Row i: where one crush takes the mass of bin i along its axis; bin 0 keeps all that falls below it."""
    pmf = fragment_pmf(model.law, _spacing(psi), len(psi), rule)
    lines = np.zeros((len(psi), len(psi)))
    for i in range(len(psi)):
        for m in range(i):
            lines[i, i - m] = pmf[m]
        lines[i, 0] = max(0.0, 1.0 - math.fsum(pmf[:i]))
    return lines


def _kernel(i: int, j: int, share: tuple[float, float, float], lines: Array) -> Array:
    """Kernel of one cell, Eqs. (59), (63), (67), (68), given its crushing shares."""
    psi_only, psibar_only, both = share
    kernel = both * np.outer(lines[i], lines[j])
    kernel[:, j] += psi_only * lines[i]
    kernel[i, :] += psibar_only * lines[j]
    if not any(share):
        kernel[i, j] = 1.0
    return kernel


def cell_kernel(
    psi: Array,
    model: Model,
    stress_ratio: float,
    i: int,
    j: int,
    kind: Kind = "exact",
    loading_rate: float = 0.0,
    rule: Rule = "paper",
) -> Array:
    """Spread of the unit mass of cell (i, j) in one step."""
    split = shares(zones(psi, model, stress_ratio), kind, loading_rate)
    share = (float(split[0][i, j]), float(split[1][i, j]), float(split[2][i, j]))
    return _kernel(i, j, share, _lines(psi, model, rule))


def step(
    p: Array,
    psi: Array,
    model: Model,
    stress_ratio: float,
    kind: Kind = "slow",
    loading_rate: float = 0.0,
    rule: Rule = "paper",
) -> Array:
    """State after one step, Eq. (38): mass leaves its cell and is spread by that cell's own kernel."""
    split = shares(zones(psi, model, stress_ratio), kind, loading_rate)
    lines = _lines(psi, model, rule)
    out = np.zeros(p.shape)
    for i, j in zip(*np.nonzero(p), strict=True):
        share = (float(split[0][i, j]), float(split[1][i, j]), float(split[2][i, j]))
        out += p[i, j] * _kernel(i, j, share, lines)
    return out


# --- states and gradings ------------------------------------------------------------------------------------


def neighbour_pmf(pmf: Array, psi: Array, mean: Mean = "arithmetic") -> Array:
    """Law of psibar for two independent neighbours; bins, the fines bin too, are points at their centres."""
    if mean not in ("arithmetic", "geometric"):
        raise ValueError(f"unknown mean {mean!r}")
    # Eqs. (48), (65): the variable in which the mean of two neighbours is half their sum.
    node = np.exp(psi) if mean == "arithmetic" else psi
    out = np.zeros(len(psi))
    for i in range(len(psi)):
        for j in range(len(psi)):
            # Hat weights between the two nearest centres keep the expectation of the mean.
            value = 0.5 * (node[i] + node[j])
            k = min(int(np.searchsorted(node, value, side="right")) - 1, len(psi) - 2)
            upper = (value - node[k]) / (node[k + 1] - node[k])
            out[k] += pmf[i] * pmf[j] * (1.0 - upper)
            out[k + 1] += pmf[i] * pmf[j] * upper
    return out


def mixed(pmf: Array, psi: Array, mean: Mean = "arithmetic") -> Array:
    """Completely mixed state, Eq. (64)."""
    return np.outer(pmf, neighbour_pmf(pmf, psi, mean))


def _bin_masses(cdf: Array) -> Array:
    """Bin masses from the cdf at the upper bin edges, all that is below the first of them going to bin 0."""
    if cdf[-1] < 1.0 - 1e-12:
        raise ValueError("the grading has sizes above the top bin")
    return np.diff(cdf, prepend=0.0)


def power_law_pmf(psi: Array, fractal_dimension: float, smallest: float, largest: float) -> Array:
    """Bin masses of a power law of given fractal dimension; dimension 3 is log-uniform in mass."""
    low, high = math.log(smallest), math.log(largest)
    place, exponent = np.clip(_upper_edges(psi), low, high) - low, 3.0 - fractal_dimension
    if exponent == 0.0:
        return _bin_masses(place / (high - low))
    return _bin_masses(np.expm1(exponent * place) / math.expm1(exponent * (high - low)))


def sieve_pmf(psi: Array, size: Array, finer: Array) -> Array:
    """Bin masses of a sieve curve, linear in ln d; a power law below the finest sieve if that passes any."""
    log_size, edge = np.log(size), _upper_edges(psi)
    cdf = np.interp(edge, log_size, finer)
    if finer[0] > 0.0:
        exponent = math.log(finer[1] / finer[0]) / (log_size[1] - log_size[0])
        cdf = np.where(edge < log_size[0], finer[0] * np.exp(np.minimum(exponent * (edge - log_size[0]), 0.0)), cdf)
    return _bin_masses(cdf)


def percentile(cdf: Array, edge_psi: Array, percent: float) -> float:
    """Smallest size that at least this percentage is finer than; inside the fines bin, its upper edge."""
    target = min(percent / 100.0, float(cdf[-1]))  # the cdf may end an ulp below 1
    k = int(np.searchsorted(cdf, target, side="left"))
    if k == 0:
        return math.exp(edge_psi[0])
    share = (target - cdf[k - 1]) / (cdf[k] - cdf[k - 1])
    return math.exp(edge_psi[k - 1] + share * (edge_psi[k] - edge_psi[k - 1]))

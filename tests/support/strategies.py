"""Random materials, grids, loads and states, in the words of the library and of the reference at once."""

import math
from dataclasses import dataclass
from typing import Literal, cast

import numpy as np
from hypothesis import strategies as st

import comminute as cm
import reference as ref
from reference import Array, Kind, Rule
from reference_quasi_static import LogNormal, Scheme, Tabulated

Fragments = cm.WeibullFragments | cm.PowerLawFragments | cm.LogNormalFragments | cm.TabulatedFragments


@dataclass(frozen=True)
class Case:
    """One step to take, described once; `grid` and `material` for the library, `psi` and `model` for the reference."""

    grid: cm.LogGrid
    material: cm.Material
    psi: Array
    model: ref.Model
    stress_ratio: float
    kind: Kind
    loading_rate: float
    rule: Rule
    p: Array


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


@st.composite
def laws(draw: st.DrawFn) -> tuple[cm.WeibullFragments | cm.PowerLawFragments, ref.Law]:
    if draw(st.booleans()):
        scale, shape = draw(log_uniform(0.2, 5.0)), draw(log_uniform(0.4, 4.0))
        return cm.WeibullFragments(scale, shape), ref.Weibull(scale, shape)
    exponent = draw(log_uniform(0.3, 4.0))
    return cm.PowerLawFragments(exponent), ref.PowerLaw(exponent)


@st.composite
def every_law(draw: st.DrawFn) -> tuple[Fragments, ref.Law]:
    """Four laws; the Weibull law over all rates scale^-shape from 0.1 to 100."""
    which = draw(st.sampled_from(["weibull", "weibull", "power", "lognormal", "tabulated"]))
    if which == "weibull":
        shape, rate = draw(log_uniform(0.5, 4.0)), draw(log_uniform(0.1, 100.0))
        scale = rate ** (-1.0 / shape)
        return cm.WeibullFragments(scale, shape), ref.Weibull(scale, shape)
    if which == "power":
        exponent = draw(log_uniform(0.3, 4.0))
        return cm.PowerLawFragments(exponent), ref.PowerLaw(exponent)
    if which == "lognormal":
        mean, sd = draw(st.floats(-2.0, 1.0)), draw(log_uniform(0.1, 2.0))
        return cm.LogNormalFragments(mean, sd), LogNormal(mean, sd)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    points = draw(st.integers(2, 8))
    x = np.exp(np.append(-np.cumsum(rng.uniform(0.1, 1.0, points - 1))[::-1], 0.0))
    share = np.cumsum(rng.dirichlet(np.ones(points)))
    finer = np.append(share[:-1] - draw(st.sampled_from([0.0, 1.0])) * share[0], 1.0)
    return cm.TabulatedFragments(x, finer), Tabulated(tuple(x.tolist()), tuple(finer.tolist()))


def random_state(seed: int, bins: int) -> Array:
    """Random masses of total 2, with empty cells, empty lines, or a single packet among them."""
    rng = np.random.default_rng(seed)
    p = rng.exponential(size=(bins, bins))
    p *= rng.random((bins, bins)) < rng.choice([0.02, 0.3, 1.0])
    p[rng.random(bins) < 0.1, :] = 0.0
    p[rng.integers(1, bins), rng.integers(1, bins)] += 1.0
    return cast(Array, 2.0 * p / p.sum())


@st.composite
def cases(draw: st.DrawFn, max_bins: int = 96) -> Case:
    bins = draw(st.integers(8, max_bins))
    top = draw(st.floats(-1.0, 1.5))
    bottom = top - draw(st.floats(0.5, 9.0))
    w, n = draw(log_uniform(0.5, 12.0)), draw(log_uniform(0.02, 5.0))
    s_max = draw(st.sampled_from([1.0, 0.3, 2.0]))
    law, reference_law = draw(laws())
    kinds: tuple[Kind, ...] = ("exact", "slow", "fast", "blend")
    kind = draw(st.sampled_from(kinds))
    grid = cm.LogGrid(bottom, top, bins)
    return Case(
        grid=grid,
        material=cm.Material(weibull_modulus=w, fabric_width=n, reference_size=s_max, fragments=law),
        psi=ref.centres(bottom, top, bins),
        model=ref.Model(w, n, s_max, reference_law),
        stress_ratio=draw(log_uniform(0.2, 1e5)),
        kind=kind,
        loading_rate=draw(st.floats(0.0, 1.0)) if kind == "blend" else 0.0,
        rule=draw(st.sampled_from(["paper", "conservative"])),
        p=random_state(draw(st.integers(0, 2**32 - 1)), bins),
    )


@dataclass(frozen=True)
class SolveCase:
    """One solve from an unloaded state of unit mass, for library and reference."""

    grid: cm.LogGrid
    material: cm.Material
    psi: Array
    model: ref.Model
    stress_ratio: float
    scheme: Scheme
    p: Array

    def solver(self, path: Literal["automatic", "direct", "sums"] = "automatic", rate: float = 0.0) -> cm.QuasiStatic:
        """Build a solver of this case."""
        return cm.QuasiStatic(self.grid, self.material, self.scheme, rate, path=path)


@st.composite
def solve_cases(draw: st.DrawFn, max_bins: int = 96, fabric_off: bool = False) -> SolveCase:
    """Grids from a few bins over much to many over little: band wider than the grid, over the fines bin, or nowhere."""
    bins = draw(st.integers(8, 40) | st.integers(8, max_bins))
    top = draw(st.floats(-1.0, 1.5))
    bottom = top - draw(st.floats(0.3, 12.0))
    w, n, s_max = draw(log_uniform(0.5, 12.0)), draw(log_uniform(0.01, 300.0)), draw(log_uniform(0.1, 10.0))
    if fabric_off:
        n = math.inf
    law, reference_law = draw(every_law())
    grid = cm.LogGrid(bottom, top, bins)
    return SolveCase(
        grid=grid,
        material=cm.Material(weibull_modulus=w, fabric_width=n, reference_size=s_max, fragments=law),
        psi=ref.centres(bottom, top, bins),
        model=ref.Model(w, n, s_max, reference_law),
        stress_ratio=draw(log_uniform(0.05, 1e5)),
        scheme=draw(st.sampled_from(["conservative", "paper"])),
        p=random_state(draw(st.integers(0, 2**32 - 1)), bins) / 2.0,
    )

"""Random materials, grids, loads and states, in the words of the library and of the reference at once."""

from dataclasses import dataclass
from typing import cast

import numpy as np
from hypothesis import strategies as st

import comminute as cm
import reference as ref
from reference import Array, Kind, Rule


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

"""Laws of stress measures, against NumPy's eigenvalues, linear elasticity and closed forms."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

import comminute as cm
from comminute.util.choices import StressName
from strategies import log_uniform

Floats = npt.NDArray[np.float64]

NAMES: tuple[StressName, ...] = ("largest", "mean", "octahedral", "energy")
VOIGT = ([0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1])  # xx yy zz yz xz xy
ratios = st.floats(0.0, 0.45)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def principal_stresses(draw: st.DrawFn) -> Floats:
    """Compressive, often with two or three that are equal or nearly so."""
    s = np.array([draw(log_uniform(0.1, 10.0)) for _ in range(3)])
    for equal in draw(st.sets(st.sampled_from([1, 2]))):
        s[equal] = s[0] * (1.0 + draw(st.sampled_from([0.0, 1e-15, 1e-8, 1e-3])))
    return s


def turned(principal: Floats, seed: int) -> Floats:
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    tensor = rotation @ np.diag(principal) @ rotation.T
    return np.asarray(0.5 * (tensor + tensor.T))


def by_definition(name: str, poisson: float, tensor: Floats) -> float:
    """Measure from the eigenvalues and the deviator, as textbooks have it."""
    p = float(np.trace(tensor)) / 3.0
    deviator = tensor - p * np.eye(3)
    q = math.sqrt(1.5 * float((deviator**2).sum()))
    bulk, shear = 1.0 / (3.0 * (1.0 - 2.0 * poisson)), 1.0 / (2.0 * (1.0 + poisson))  # of a Young's modulus of 1
    values = {
        "largest": float(np.linalg.eigvalsh(tensor).max()),
        "mean": p,
        "octahedral": math.sqrt(float((deviator**2).sum()) / 3.0),
        "energy": math.hypot(p, math.sqrt(bulk / (3.0 * shear)) * q),
    }
    return values[name]


@given(principal_stresses(), ratios, seeds)
def test_measures_are_those_of_the_textbooks_whichever_way_the_tensor_is_given(
    principal: Floats, poisson: float, seed: int
) -> None:
    tensor = turned(principal, seed)
    for name in NAMES:
        measure = cm.StressMeasure(name, poisson=poisson)
        found = measure.equivalent(tensor)
        assert abs(found - by_definition(name, poisson, tensor)) < 2e-14 * principal.max()
        assert measure(tensor[VOIGT]) == found
        assert measure(-tensor, compression_positive=False) == found
        assert measure(-tensor) == 0.0


@given(principal_stresses(), ratios, seeds)
def test_turning_a_tensor_changes_no_measure(principal: Floats, poisson: float, seed: int) -> None:
    tensors = np.stack([np.diag(principal), turned(principal, seed), turned(principal[::-1], seed + 1)])
    for name in NAMES:
        found = cm.StressMeasure(name, poisson=poisson)(tensors)
        assert np.ptp(found) < 1e-14 * principal.max()


@given(principal_stresses(), ratios, seeds, log_uniform(1e-100, 1e100))
def test_measures_are_of_degree_one(principal: Floats, poisson: float, seed: int, factor: float) -> None:
    tensor = turned(principal, seed)
    for name in NAMES:
        measure = cm.StressMeasure(name, poisson=poisson)
        assert abs(measure(factor * tensor) / factor - measure(tensor)) < 4e-15 * principal.max()
        assert measure(4.0 * tensor) == 4.0 * measure(tensor)


@given(principal_stresses(), ratios, seeds, log_uniform(0.1, 100.0))
def test_the_energy_measure_is_the_energy_of_linear_elasticity(
    principal: Floats, poisson: float, seed: int, young: float
) -> None:
    stress = turned(principal, seed)
    strain = ((1.0 + poisson) * stress - poisson * np.trace(stress) * np.eye(3)) / young
    bulk = young / (3.0 * (1.0 - 2.0 * poisson))
    measure = cm.StressMeasure("energy", poisson=poisson)
    assert measure(stress) ** 2 / (2.0 * bulk) == pytest.approx(0.5 * float((stress * strain).sum()), rel=1e-13)


@given(log_uniform(1e-3, 1e3), ratios)
def test_an_isotropic_stress_is_its_pressure_by_every_measure(pressure: float, poisson: float) -> None:
    for name in NAMES:
        measure, wanted = cm.StressMeasure(name, poisson=poisson), 0.0 if name == "octahedral" else pressure
        assert measure(pressure * np.eye(3)) == measure(p=pressure, q=0.0) == wanted
        assert measure(vertical=pressure, k0=1.0) == pytest.approx(wanted, rel=1e-15)


@given(log_uniform(0.1, 10.0), log_uniform(0.1, 10.0), ratios)
def test_pairs_stand_for_axisymmetric_tensors(axial: float, radial: float, poisson: float) -> None:
    tensor = np.diag([radial, radial, axial])
    tolerance = 4e-15 * max(axial, radial)
    for name in NAMES:
        measure = cm.StressMeasure(name, poisson=poisson)
        assert abs(measure(p=(axial + 2.0 * radial) / 3.0, q=axial - radial) - measure(tensor)) < tolerance
        assert abs(measure(vertical=axial, k0=radial / axial) - measure(tensor)) < tolerance


@given(log_uniform(1e-3, 1e3), ratios)
def test_without_lateral_strain_the_energy_measure_has_a_closed_form(vertical: float, poisson: float) -> None:
    found = cm.StressMeasure("energy", poisson=poisson)(vertical=vertical, k0=poisson / (1.0 - poisson))
    assert found == pytest.approx(vertical * math.sqrt((1.0 + poisson) / (3.0 * (1.0 - poisson))), rel=1e-14)


@given(principal_stresses(), ratios, st.floats(0.0, 2.0), log_uniform(0.1, 10.0))
def test_a_stress_ratio_is_the_measure_over_that_of_the_first_crush(
    principal: Floats, poisson: float, k0: float, first: float
) -> None:
    tensor = np.diag(principal)
    for name in NAMES:
        measure = cm.StressMeasure(name, poisson=poisson)
        at_first = measure(vertical=first, k0=k0)
        if at_first < 1e-6 * first:
            continue  # an oedometer whose K0 is nearly 1 has no octahedral stress
        plain = cm.Material(first_crush_stress=first, stress_measure=measure)
        tested = cm.Material(first_crush_stress=first, stress_measure=measure, k0=k0)
        assert plain.stress_ratio(tensor) == measure(tensor) / first
        assert tested.stress_ratio(tensor) == pytest.approx(measure(tensor) / at_first, rel=1e-15)
        assert tested.stress_ratio(vertical=3.0 * first) == pytest.approx(tested.stress_ratio(3.0 * first), rel=1e-14)

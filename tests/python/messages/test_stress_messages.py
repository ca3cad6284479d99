# ruff: noqa: E501  (calls, one a line)
"""Mistakes with stresses and their measures, and the exact words that answer them: value, rule, remedy."""

import math
from collections.abc import Callable

import numpy as np
import pytest

import comminute as cm

MEAN = cm.Material(first_crush_stress=10.0, stress_measure="mean")
PLAIN = cm.Material(first_crush_stress=10.0)
TENSORS = np.stack([np.diag([5.0, 5.0, 20.0]), np.diag([30.0, 40.0, 50.0])])


def simulate(material: cm.Material, **loads: object) -> cm.Result:
    return cm.Simulation(material, cm.monodisperse(1.0)).run(**loads)  # type: ignore[arg-type]


REFUSED: list[tuple[Callable[[], object], str]] = [
    (lambda: cm.StressMeasure("pressure"), "stress_measure is 'pressure'; it must be one of 'largest', 'vertical', 'mean'"),  # type: ignore[arg-type]
    (lambda: cm.StressMeasure("energy"), "poisson is missing; the energy measure of a stress needs it, at least 0 and less"),
    (lambda: cm.StressMeasure("energy", poisson=0.5), "poisson is 0.5; it must be at least 0 and less than 0.5"),
    (lambda: cm.StressMeasure("mean", poisson=-0.1), "poisson is -0.1; it must be at least 0 and less than 0.5"),
    (lambda: cm.StressMeasure("mean", poisson=math.nan), "poisson is nan; it must be at least 0 and less than 0.5"),
    (lambda: cm.Material(poisson=0.2), "poisson is 0.2; it belongs to a stress measure, which is not set. Name it on the Material"),
    (lambda: cm.Material(k0=0.5), "k0 is 0.5; it belongs to a stress measure, which is not set. Name it on the Material"),
    (lambda: cm.Material(stress_measure=cm.StressMeasure("mean"), poisson=0.2), "poisson is 0.2; the StressMeasure brings its own. Leave it out"),
    (lambda: cm.Material(stress_measure="mean", k0=-0.5), "k0 is -0.5; it must be at least 0 and finite"),
    (lambda: cm.Material(stress_measure="mean", k0=math.nan), "k0 is nan; it must be at least 0 and finite"),
    (lambda: cm.Material(stress_measure="octahedral", k0=1.0), "k0 is 1; it must be other than 1 with the octahedral measure, which is 0 there"),
    (lambda: MEAN.stress_ratio(p=1.0), "q is missing; p is given with it; q is 0 under an isotropic stress"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio(q=1.0), "p is missing; q is given with it"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio(vertical=1.0), "k0 is missing; a vertical stress needs it, the ratio of the horizontal stress to it"),
    (lambda: MEAN.stress_ratio(k0=0.5), "vertical is missing; k0 is given with it"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio(), "give one stress: stress, p with q, or vertical with k0"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio(1.0, p=1.0, q=1.0), "give one stress: stress, p with q, or vertical with k0"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio(p=[1.0, math.nan], q=0.0), "p[1] is nan; it must be finite"),
    (lambda: MEAN.stress_ratio(p=1.0, q=math.inf), "q is inf; it must be finite"),
    (lambda: MEAN.stress_ratio(vertical=math.nan, k0=0.5), "vertical is nan; it must be finite"),
    (lambda: MEAN.stress_ratio(vertical=1.0, k0=-0.1), "k0 is -0.1; it must be at least 0 and finite"),
    (lambda: MEAN.stress_ratio(vertical=1.0, k0=[0.5, math.nan]), "k0[1] is nan; it must be at least 0 and finite"),
    (lambda: MEAN.stress_ratio(-1.0), "stress is -1; it must be a number of at least 0"),
    (lambda: MEAN.stress_ratio(1.0, compression_positive=False), "compression_positive is False; it is for tensors; numbers are"),
    (lambda: MEAN.stress_ratio(p=1.0, q=1.0, compression_positive=False), "compression_positive is False; it is for tensors; p and vertical"),  # type: ignore[call-overload]
    (lambda: MEAN.stress_ratio([[math.nan] * 6] * 2), "stress[0, 0] is nan; every entry must be finite"),
    (lambda: MEAN.stress_ratio([[[1, 2, 3], [2, 1, 4], [0, 4, 1]]]), "stress[0, 0, 2] is 3; it must equal stress[0, 2, 0], which is 0: stress tensors are symmetric"),
    (lambda: PLAIN.stress_ratio(p=1.0, q=0.0), "stress_measure is missing; stresses that are not single numbers need it. Name it on the Material, stress_measure="),
    (lambda: cm.Material(stress_measure="mean").stress_ratio(TENSORS), "stress is a tensor; it needs first_crush_stress, which is not set"),
    (lambda: simulate(PLAIN, stress=TENSORS), "stress has shape (2, 3, 3); tensors need the material's stress_measure. Name it on the Material"),
    (lambda: simulate(MEAN, stress=np.ones((2, 2, 3, 3))), "stress has shape (2, 2, 3, 3); it must be (T, 3, 3) or (T, 6), a tensor for each of at least one load"),
    (lambda: simulate(MEAN, stress=np.ones((0, 6))), "stress has shape (0, 6); it must be (T, 3, 3) or (T, 6)"),
    (lambda: simulate(MEAN, stress=-TENSORS), "every stress is tensile, the mean down to -40; a packing in tension carries no load. Compression is positive here"),
    (lambda: simulate(MEAN, p=[-1.0, -2.0], q=0.0), "every stress is tensile, the mean down to -2; a packing in tension carries no load"),
    (lambda: simulate(MEAN, p=[[1.0]], q=0.0), "p has shape (1, 1); it must be a list of at least one load"),
    (lambda: simulate(MEAN, stress=[1.0], vertical=2.0, k0=0.5), "give one kind of load: stress_ratio, stress, p with q, or vertical with k0"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSED)
def test_what_is_no_stress_is_refused_in_words(call: Callable[[], object], words: str) -> None:
    with pytest.raises(cm.ParameterError) as refused:
        call()
    assert words in str(refused.value)


SHAPES: list[tuple[Callable[[], object], str]] = [
    (lambda: MEAN.stress_ratio(np.ones((4, 5))), "stress has shape (4, 5); it must be (..., 3, 3), or (..., 6) in the order xx yy zz"),
    (lambda: cm.StressMeasure("mean")(1.0), "tensor has shape (); it must be (..., 3, 3), or (..., 6)"),
    (lambda: MEAN.stress_ratio(p=[1.0, 2.0], q=[1.0, 2.0, 3.0]), "q has shape (3,); p has (2,); give both in one shape, or one of them as a number"),
    (lambda: simulate(MEAN, stress=np.ones((4, 5))), "stress has shape (4, 5); it must be (..., 3, 3)"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), SHAPES)
def test_a_wrong_shape_is_refused_with_the_right_one(call: Callable[[], object], words: str) -> None:
    with pytest.raises(cm.ShapeError) as refused:
        call()
    assert words in str(refused.value)


def test_text_is_no_stress() -> None:
    with pytest.raises(TypeError, match="tensor is a str; it must be a number or an array of numbers"):
        cm.StressMeasure("mean")("abc")

# ruff: noqa: E501  (calls, one a line)
"""Misspelled keywords name the nearest, whoever is called; parts of a simulation of another kind are refused at once."""

import pickle
from collections.abc import Callable

import pytest

import comminute as cm

MATERIAL, START = cm.Material(), cm.monodisperse(1.0)
CALLS: dict[str, tuple[Callable[[], object], str]] = {
    "class": (lambda: cm.Material(weibul_modulus=3.0), "Material() has no keyword weibul_modulus; did you mean weibull_modulus?"),  # type: ignore[call-arg]
    "grid": (lambda: cm.LogGrid(-1.0, 1.0, bin=8), "LogGrid() has no keyword bin; did you mean bins?"),  # type: ignore[call-arg]
    "maker": (lambda: cm.gap_graded(1.0, 0.1, corse_share=0.5), "gap_graded() has no keyword corse_share; did you mean coarse"),  # type: ignore[call-arg]
    "static method": (lambda: cm.Grading.from_sieves([1, 2], [0, 100], unt="mm"), "from_sieves() has no keyword unt; did you mean unit?"),  # type: ignore[call-arg]
    "reader": (lambda: cm.Grading.read("sand.csv", sampel="A"), "Grading.read() has no keyword sampel; did you mean sample?"),  # type: ignore[call-arg]
    "simulation": (lambda: cm.Simulation(MATERIAL, START, sceme="paper"), "Simulation() has no keyword sceme; did you mean scheme?"),  # type: ignore[call-arg]
    "run": (lambda: cm.Simulation(MATERIAL, START).run(stres_ratio=[1]), "run() has no keyword stres_ratio; did you mean stress_ratio?"),  # type: ignore[call-arg]
    "stress of a run": (lambda: cm.Simulation(MATERIAL, START).run(vertial=[1]), "run() has no keyword vertial; did you mean vertical?"),  # type: ignore[call-arg]
    "run of a lattice": (lambda: cm.Lattice(8, MATERIAL, START).run(stress_ratio=1, kep_fabrics="all"), "run() has no keyword kep_fabrics; did you mean keep_fabrics?"),  # type: ignore[call-arg]
    "measure": (lambda: cm.StressMeasure("energy", poison=0.2), "StressMeasure() has no keyword poison; did you mean poisson?"),  # type: ignore[call-arg]
    "lattice": (lambda: cm.Lattice(8, MATERIAL, START, sed=1), "Lattice() has no keyword sed; did you mean seed?"),  # type: ignore[call-arg]
    "nothing near": (lambda: cm.LogGrid(-1.0, 1.0, 8, zzz=1), "LogGrid() has no keyword zzz; it has psi_min, psi_max, bins"),  # type: ignore[call-arg]
}  # fmt: skip


@pytest.mark.parametrize("call", CALLS)
def test_a_misspelled_keyword_names_the_nearest(call: str) -> None:
    make, words = CALLS[call]
    with pytest.raises(TypeError) as refused:
        make()
    assert words in str(refused.value)


def test_other_mistakes_keep_their_own_words() -> None:
    with pytest.raises(TypeError, match="incompatible constructor arguments"):
        cm.Material(3.0)  # type: ignore[call-arg]
    with pytest.raises(cm.ParameterError, match="weibull_modulus is -1"):
        cm.Material(weibull_modulus=-1.0)
    assert pickle.loads(pickle.dumps(cm.gap_graded)) is cm.gap_graded
    assert pickle.loads(pickle.dumps(cm.Material(fabric_width=0.1))) == cm.Material(fabric_width=0.1)


def test_a_file_is_no_start() -> None:
    with pytest.raises(TypeError, match=r"start is 'sand.csv', the name of a file; read it first: Grading.read\('sand"):
        cm.Simulation(MATERIAL, "sand.csv")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="start is a list; it must be a Grading or a Fabric"):
        cm.Simulation(MATERIAL, [1.0])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="material is a Grading; it must be a Material"):
        cm.Simulation(START, MATERIAL)  # type: ignore[arg-type]


def test_no_traceback_holds_an_object_that_was_not_made() -> None:
    with pytest.raises(cm.ParameterError) as caught:
        cm.LogGrid(1.0, 0.0, 60)
    for entry in caught.traceback:  # debuggers and pytest print what a frame holds
        assert not any(isinstance(value, cm.LogGrid) for value in entry.frame.f_locals.get("args", ()))

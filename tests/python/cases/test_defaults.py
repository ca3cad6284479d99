"""Defaults are the core's: of every key of a case file that has one, of the new case, and of the docstrings."""

import inspect
import json
import math
import re
import tomllib
from collections.abc import Iterator

import pytest

import comminute as cm
from comminute import _core

pytest.importorskip("pydantic")
pytest.importorskip("typer")

from comminute.cases import schema
from comminute.cli.texts import new_case
from comminute.runs.recipe import law_of

READ = inspect.signature(cm.Grading.read).parameters
RUN = inspect.signature(cm.Simulation.run).parameters
SIMULATION = inspect.signature(cm.Simulation).parameters
SHORT = ([2.0, 1.0], [90.0, 0.0])  # a curve that only top = "extend" closes
# Defaults as objects show them that were made without the parameter, not as anything lists them.
CORE: dict[str, object] = {
    "Units.size": cm.Grading.from_sieves([2.0, 1.0], [100.0, 0.0]).unit,
    "MaterialTable.weibull_modulus": cm.Material().weibull_modulus,
    "MaterialTable.fabric_width": cm.Material().fabric_width,
    "MaterialTable.reference_size": cm.Material().reference_size,
    "MaterialTable.first_crush_stress": cm.Material().first_crush_stress,
    "MaterialTable.stress_measure": cm.Material().stress_measure,
    "MaterialTable.k0": cm.Material().k0,
    "MaterialTable.poisson": None,  # `test_a_measure_by_name_has_the_poisson_ratio_that_is_given`
    "MaterialTable.strength_scatter": cm.Material().strength_scatter,
    "MaterialTable.fragments": cm.Material().fragments,
    "Weibull.scale": cm.WeibullFragments().scale,
    "Weibull.shape": cm.WeibullFragments().shape,
    "PowerLaw.exponent": cm.PowerLawFragments().exponent,
    "LogNormal.mean_log": cm.LogNormalFragments().mean_log,
    "LogNormal.sd_log": cm.LogNormalFragments().sd_log,
    "GradingFile.top": "error",  # `test_a_curve_that_stops_short_is_refused_unless_told_otherwise`
    "GradingFile.number": False,
    **{f"GradingFile.{name}": READ[name].default for name in ("sheet", "sample", "mesh", "total_mass_g", "edges")},
    "Sieves.top": "error",
    "Sieves.number": False,
    "GapGraded.coarse_share": 1.0 - float(cm.gap_graded(2.0, 1.0).finer(1.5)),
    "Fuller.exponent": math.log(cm.fuller(1.0).finer(0.25)) / math.log(0.25),
    "LogNormalGrading.largest": None,
    "RosinRammler.largest": None,
    "GridTable.bins": None,
    "GridTable.psi_min": None,
    "GridTable.psi_max": None,
    "LoadTable.loading_rate": RUN["loading_rate"].default,
    "LoadTable.remix_after": list(RUN["remix_after"].default),
    "EngineTable.name": RUN["engine"].default,
    "EngineTable.scheme": SIMULATION["scheme"].default,
    "EngineTable.mean": cm.mixed_fabric(cm.monodisperse(1.0), cm.LogGrid(-1.0, 0.0, 8)).mean,
    "EngineTable.closure": SIMULATION["closure"].default,
    "EngineTable.sizes": list(SIMULATION["sizes"].default),
    "EngineTable.kind": RUN["kind"].default,
    "EngineTable.steps_per_load": RUN["steps_per_load"].default,
}
# Keys that only case files have.
OWN = {
    "Units.stress",
    "Sieves.places",
    "Sieves.notes",
    "Sieves.file",
    "LoadRange.spacing",
    "LoadTable.stress",
    "LoadTable.stress_ratio",
    "LoadTable.p",
    "LoadTable.q",
    "LoadTable.vertical",
    "LoadTable.k0",
    "LoadTable.file",
    "OutputTable.file",
    "OutputTable.fabrics",
}


def keys_with_defaults() -> Iterator[tuple[str, object]]:
    """Every key of every table of a case file that may be left out, but tables themselves and words that choose one."""
    for table in vars(schema).values():
        if inspect.isclass(table) and issubclass(table, schema.Table) and table not in (schema.Table, schema.Case):
            for name, field in table.model_fields.items():
                if not field.is_required() and name not in ("law", "kind" if table is not schema.EngineTable else ""):
                    yield f"{table.__name__}.{name}", field.get_default()


def test_every_key_has_the_cores_default_or_is_known_to_be_of_case_files_alone() -> None:
    found = dict(keys_with_defaults())
    assert set(found) == set(CORE) | OWN
    fragments = found["MaterialTable.fragments"]
    assert isinstance(fragments, schema.Table)
    found["MaterialTable.fragments"] = law_of(fragments.model_dump())
    for key, default in CORE.items():
        assert found[key] == default, key
        assert type(found[key]) is type(default), key


def test_a_curve_that_stops_short_is_refused_unless_told_otherwise() -> None:
    with pytest.raises(cm.ParameterError, match="the coarsest sieve"):
        cm.Grading.from_sieves(*SHORT)
    assert cm.Grading.from_sieves(*SHORT, top="extend").largest > 2.0
    by_mass = cm.Grading.from_sieves([2.0, 1.0], [100.0, 0.0])
    assert by_mass == cm.Grading.from_sieves([2.0, 1.0], [100.0, 0.0], number=False)


def test_a_new_case_shows_the_defaults() -> None:
    text = new_case()["case.toml"]
    assert "$" not in text
    shown = tomllib.loads(text)
    assert shown["material"]["weibull_modulus"] == cm.Material().weibull_modulus
    assert shown["material"].pop("fabric_width") == 0.3  # a guess that shows a response, as its comment says
    assert f"have {cm.Material().fabric_width:g}," in text
    assert law_of(shown["material"]["fragments"]) == cm.Material().fragments
    commented = dict(re.findall(r"^# (\w+) = (\S+)", text, re.MULTILINE))
    for key in ("LoadTable.loading_rate", "EngineTable.name", "EngineTable.scheme", "EngineTable.mean"):
        assert json.loads(commented[key.split(".")[1]]) == CORE[key]


@pytest.mark.parametrize("lattice", [cm.Lattice, cm.TimeSteppedLattice])
def test_docstrings_of_lattices_show_the_cores_defaults(lattice: type) -> None:
    shown = dict(re.findall(r"^(\w+) : .*, default (\S+)$", inspect.getdoc(lattice) or "", re.MULTILINE))
    made = lattice(2, cm.Material(), cm.monodisperse(1.0))
    assert shown
    for name, text in shown.items():
        default = _core.defaults[lattice.__name__][name]
        assert text == (json.dumps(default) if isinstance(default, str) else repr(default)), name
        assert getattr(made, name, default) == default, name


def test_what_the_core_says_of_its_defaults_is_what_it_does() -> None:
    plain = cm.fitting_grid(cm.fuller(1.0), cm.Material(), 10.0)
    assert cm.fitting_grid(cm.fuller(1.0), cm.Material(), 10.0, **_core.defaults["fitting_grid"]) == plain
    assert cm.fuller(1.0, **_core.defaults["fuller"]) == cm.fuller(1.0)
    assert cm.gap_graded(1.0, 0.5, **_core.defaults["gap_graded"]) == cm.gap_graded(1.0, 0.5)
    sieves = ([2.0, 1.0], [100.0, 0.0])
    assert cm.Grading.from_sieves(*sieves, **_core.defaults["from_sieves"]) == cm.Grading.from_sieves(*sieves)
    with pytest.raises(TypeError):
        _core.defaults["fuller"]["exponent"] = 1.0  # type: ignore[index]

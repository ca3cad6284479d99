"""Gradings for particle codes, read back as those codes read them."""

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from typer.testing import CliRunner

import comminute as cm
from comminute.cli.app import app
from comminute.gradings.dem import DemCode

Floats = npt.NDArray[np.float64]
SAND = cm.Grading.from_sieves([2.0, 1.6, 1.0, 0.5, 0.16, 0.08], [100, 93, 67, 33, 13, 1], unit="mm")


def of_yade(text: str) -> tuple[Floats, Floats]:
    """Diameters [mm] and mass finer of the lists that makeCloud takes; it interpolates between them."""
    space: dict[str, list[float]] = {}
    exec(text, space)
    size, finer = 1e3 * np.array(space["psdSizes"]), np.array(space["psdCumm"])
    assert size.size == finer.size
    return size, finer


def of_mercury(text: str) -> tuple[Floats, Floats]:
    """Diameters [mm] and volume finer of radii and a rising cdf, one pair a line, without headings."""
    rows = np.array([[float(cell) for cell in line.split(",")] for line in text.splitlines()])
    return 2e3 * rows[:, 0], rows[:, 1]


def of_liggghts(text: str) -> tuple[Floats, Floats]:
    """Diameters [mm] of the templates, and their weights by mass."""
    whole = text.replace("&\n", " ")
    templates = re.findall(r"^fix (\w+) all particletemplate/sphere (\d+) .* radius constant (\S+)$", whole, re.M)
    (distribution,) = re.findall(r"^fix pdd all particledistribution/discrete/massbased (\d+) (\d+) (.*)$", whole, re.M)
    seeds = [int(seed) for _, seed, _ in templates] + [int(distribution[0])]
    for seed in seeds:
        assert seed > 10_000
        assert all(seed % divisor for divisor in range(2, int(seed**0.5) + 1))  # a prime, as it must be
    weights = dict(zip(distribution[2].split()[::2], map(float, distribution[2].split()[1::2]), strict=True))
    assert len(weights) == int(distribution[1]) == len(templates)
    return 2e3 * np.array([float(r) for _, _, r in templates]), np.array([weights[name] for name, _, _ in templates])


@pytest.mark.parametrize(("code", "read"), [("yade", of_yade), ("mercury-dpm", of_mercury)])
def test_curves_come_back_as_they_were(code: DemCode, read: object) -> None:
    size, finer = read(cm.dem_text(SAND, code, smallest=0.2, classes=40))  # type: ignore[operator]
    below = SAND.finer(0.2)
    np.testing.assert_allclose(finer, (np.asarray(SAND.finer(size)) - below) / (1.0 - below), atol=1e-5)
    assert (finer[0], finer[-1]) == (0.0, 1.0)
    assert size[0] == pytest.approx(0.2)
    assert size[-1] == pytest.approx(2.0)
    assert np.all(np.diff(size) > 0.0)


def test_templates_of_one_radius_have_the_mass_of_their_class() -> None:
    size, mass = of_liggghts(cm.dem_text(SAND, "liggghts", smallest=0.2, classes=8))
    assert mass.sum() == pytest.approx(1.0, abs=1e-8)
    edges = np.geomspace(0.2, 2.0, 9)
    np.testing.assert_allclose(size, np.sqrt(edges[:-1] * edges[1:]), rtol=1e-6)
    left = 1.0 - SAND.finer(0.2)
    np.testing.assert_allclose(mass, np.diff(np.asarray(SAND.finer(edges))) / left, atol=1e-5)


@pytest.mark.parametrize(
    ("grading", "sizes", "masses"),
    [
        (cm.monodisperse(2.0), [2.0], [1.0]),
        (cm.gap_graded(2.0, 0.2, 0.7), [0.2, 2.0], [0.3, 0.7]),
    ],
)
def test_exact_sizes_keep_their_mass(grading: cm.Grading, sizes: list[float], masses: list[float]) -> None:
    size, mass = of_liggghts(cm.dem_text(grading.with_unit("mm"), "liggghts"))
    np.testing.assert_allclose(size, sizes, rtol=1e-5)
    np.testing.assert_allclose(mass, masses)
    points, finer = of_yade(cm.dem_text(grading.with_unit("mm"), "yade"))
    for one, share in zip(sizes, masses, strict=True):
        near = np.abs(points / one - 1.0) < 1e-4
        assert np.ptp(finer[near]) == pytest.approx(share)


def test_what_is_left_out_is_said_and_must_be_asked_for() -> None:
    assert "% of the mass, finer than 0.0002 m, is left out" in cm.dem_text(SAND, "yade", smallest=0.2)
    with pytest.raises(cm.ParameterError, match=r"smallest is not given, and 1 % lie below 0\.08 mm"):
        cm.dem_text(SAND, "yade")
    with pytest.raises(cm.ParameterError, match="the grading has no unit"):
        cm.dem_text(cm.monodisperse(1.0), "yade")
    with pytest.raises(cm.ParameterError, match="code is 'edem'"):
        cm.dem_text(SAND, "edem")  # type: ignore[arg-type]
    with pytest.raises(cm.ParameterError, match="at most the largest, 2"):
        cm.dem_text(SAND, "yade", smallest=3.0)
    with pytest.raises(cm.ParameterError, match="classes is 0"):
        cm.dem_text(SAND, "yade", smallest=0.2, classes=0)


def test_the_command_writes_the_same(tmp_path: Path) -> None:
    table = tmp_path / "sand.csv"
    table.write_text("size_mm,percent_finer\n2,100\n1,60\n0.5,0\n")
    words = ["dem", str(table), "--code", "mercury-dpm", "--classes", "4"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert done.output == cm.dem_text(cm.Grading.read(table), "mercury-dpm", classes=4)
    target = tmp_path / "psd.csv"
    assert CliRunner().invoke(app, [*words, "-o", str(target)]).exit_code == 0
    assert target.read_text() == done.output
    assert CliRunner().invoke(app, [*words, "-o", str(target)]).exit_code == 3


@pytest.mark.parametrize(
    "law",
    [
        cm.WeibullFragments(0.8, 1.4),
        cm.PowerLawFragments(2.0),
        cm.LogNormalFragments(-1.0, 0.5),
        cm.TabulatedFragments([0.25, 0.5, 1.0], [0.0, 0.4, 1.0]),
    ],
    ids=lambda law: type(law).__name__,
)
def test_drawn_fragments_follow_their_law(law: cm.WeibullFragments) -> None:
    drawn = np.sort(law.sample(20_000, np.random.default_rng(5)))
    assert np.all((drawn > 0.0) & (drawn <= 1.0))
    distance = np.abs(np.asarray(law.cdf(np.log(drawn))) - (np.arange(20_000) + 0.5) / 20_000).max()
    assert distance < 1.63 / np.sqrt(20_000)  # Kolmogorov, one in a hundred; the seed is fixed
    assert law.sample((2, 3), np.random.default_rng(0)).shape == (2, 3)

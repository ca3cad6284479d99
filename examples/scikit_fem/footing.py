"""A strip footing on sand that crushes, by finite elements: footing.py OUT leaves OUT/footing.png and OUT/footing.csv.

The sand is elastic but for one thing: crushing packs it more densely, by a volumetric strain in proportion to Einav's
breakage. Each quadrature point remembers its largest mean stress, and a response table gives its breakage and D50.
Newton's method needs the derivative of the breakage by the load, which the table gives too.
"""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshTri,
    condense,
    solve,
)
from skfem.helpers import ddot, sym_grad, trace

import comminute as cm

Floats = npt.NDArray[np.float64]
BULK, SHEAR = 600.0, 450.0  # MPa
FIRST_CRUSH = 1.0  # MPa of mean stress
COMPACTION = 0.25  # volumetric strain at a breakage of 1
WIDTH = HEIGHT = 1.0  # m
STRIP = 0.2  # m, half width of the footing; the left side is a plane of symmetry


def sand() -> cm.ResponseTable:
    """Response of a sand to its mean stress."""
    material = cm.Material(reference_size=2.0, fabric_width=0.2, first_crush_stress=FIRST_CRUSH, stress_measure="mean")
    start = cm.power_law(2.3, 0.1, 2.0)  # mm
    return cm.ResponseTable(material, start, largest=200.0)


@dataclass
class Points:
    """Quadrature points: what each remembers, and what it answers to a compression."""

    table: cm.ResponseTable
    largest: Floats  # mean stress that each has borne [MPa]

    def breakage(self, stress: Floats) -> tuple[Floats, Floats]:
        """Breakage under a mean stress, and its derivative by the stress."""
        load = np.maximum(stress, 0.0) / FIRST_CRUSH
        return self.table.value("breakage", load), self.table.derivative("breakage", load) / FIRST_CRUSH

    def answer(self, compression: Floats) -> tuple[Floats, Floats]:
        """Mean stress of a volumetric compression, and its derivative; nothing is remembered until `remember`.

        A point below its largest stress is elastic. Above it, p + K c B(p) = K e has one root, since B only rises.
        """
        compacted = COMPACTION * self.breakage(self.largest)[0]
        stress = BULK * (compression - compacted)
        stiffness = np.full_like(stress, BULK)
        crushes = stress > self.largest
        below, above = self.largest[crushes], stress[crushes]
        root, wanted = above.copy(), BULK * compression[crushes]
        for _ in range(60):
            breakage, slope = self.breakage(root)
            excess = root + BULK * COMPACTION * breakage - wanted
            if np.all(np.abs(excess) <= 1e-13 * np.abs(wanted)):
                break
            below, above = np.where(excess < 0.0, root, below), np.where(excess > 0.0, root, above)
            by_newton = root - excess / (1.0 + BULK * COMPACTION * slope)
            inside = (by_newton > below) & (by_newton < above)
            root = np.where(inside, by_newton, 0.5 * (below + above))
        stress[crushes] = root
        stiffness[crushes] = BULK / (1.0 + BULK * COMPACTION * self.breakage(root)[1])
        return stress, stiffness

    def remember(self, stress: Floats) -> None:
        """Accept the stresses of a converged step."""
        self.largest = np.maximum(self.largest, stress)


@BilinearForm
def stiffness_form(u: Any, v: Any, w: Any) -> Any:
    """Tangent of isotropic elasticity whose bulk modulus differs from point to point."""
    strain, test = sym_grad(u), sym_grad(v)
    return (w.bulk - 2.0 * SHEAR / 3.0) * trace(strain) * trace(test) + 2.0 * SHEAR * ddot(strain, test)


@LinearForm
def internal_form(v: Any, w: Any) -> Any:
    """Virtual work: the deviator of the stress is from the displacement, its mean (in compression) from the points."""
    strain, test = sym_grad(w.displacement), sym_grad(v)
    deviatoric = ddot(strain, test) - trace(strain) * trace(test) / 3.0
    return 2.0 * SHEAR * deviatoric - w.pressure * trace(test)


@dataclass
class Footing:
    """Finite elements of half a footing on a block of sand between smooth walls.

    Parameters
    ----------
    table : ResponseTable
    cells : int
        Cells along each side of the block, each of two quadratic triangles.
    strip : float
        Half width of the footing [m], `WIDTH` for a load on the whole surface.
    """

    table: cm.ResponseTable
    cells: int = 20
    strip: float = STRIP

    def __post_init__(self) -> None:
        mesh = MeshTri.init_tensor(np.linspace(0.0, WIDTH, self.cells + 1), np.linspace(0.0, HEIGHT, self.cells + 1))
        self.basis = Basis(mesh, ElementVector(ElementTriP2()))
        loaded = mesh.facets_satisfying(lambda x: np.isclose(x[1], HEIGHT) & (x[0] < self.strip), boundaries_only=True)
        surface = FacetBasis(mesh, ElementVector(ElementTriP2()), facets=loaded)
        self.unit_load = LinearForm(lambda v, w: -v[1]).assemble(surface)
        sides = self.basis.get_dofs(lambda x: np.isclose(x[0], 0.0) | np.isclose(x[0], WIDTH)).all("u^1")
        floor = self.basis.get_dofs(lambda x: np.isclose(x[1], 0.0)).all("u^2")
        self.fixed = np.union1d(sides, floor)
        self.displacement = self.basis.zeros()
        self.points = Points(self.table, np.zeros(self.basis.dx.shape))

    def step(self, pressure: float) -> list[float]:
        """Take the footing to a pressure [MPa]; the residuals of Newton's method, over the load, are returned.

        Raises
        ------
        RuntimeError
            If Newton's method does not converge in 20 iterations.
        """
        residuals: list[float] = []
        free = np.setdiff1d(np.arange(self.basis.N), self.fixed)
        while len(residuals) < 20:
            field = self.basis.interpolate(self.displacement)
            stress, bulk = self.points.answer(-trace(sym_grad(field)))
            missing = pressure * self.unit_load - internal_form.assemble(
                self.basis, displacement=field, pressure=stress
            )
            residuals.append(float(np.abs(missing[free]).max() / np.abs(self.unit_load).max()))
            if residuals[-1] < 1e-9:
                self.points.remember(stress)
                return residuals
            tangent = stiffness_form.assemble(self.basis, bulk=bulk)
            self.displacement += solve(*condense(tangent, missing, D=self.fixed))
        raise RuntimeError(f"no equilibrium at {pressure:g} MPa: residuals {residuals}")

    def settlement(self) -> float:
        """Settlement of the surface at the plane of symmetry [m]."""
        corner = self.basis.nodal_dofs[1, np.argmin(np.abs(self.basis.mesh.p - [[0.0], [HEIGHT]]).sum(axis=0))]
        return -float(self.displacement[corner])


def draw(footing: Footing, path: list[tuple[float, float]], target: Path) -> None:
    """Settlement against pressure, and the median grain size under the footing."""
    import matplotlib  # noqa: PLC0415

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # noqa: PLC0415

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
    pressures, settlements = zip(*path, strict=True)
    left.plot(pressures, 1000.0 * np.array(settlements), "o-", markersize=2.5)
    left.set(xlabel="pressure of the footing [MPa]", ylabel="settlement [mm]")
    left.invert_yaxis()
    mean = footing.points.largest.mean(axis=1)
    d50 = footing.table.value("d50", mean / FIRST_CRUSH)
    mesh = footing.basis.mesh
    shown = right.tripcolor(*mesh.p, mesh.t.T, facecolors=d50, cmap="viridis")
    figure.colorbar(shown, ax=right, label="D50 [mm]")
    right.plot([0.0, STRIP], [HEIGHT, HEIGHT], color="C3", linewidth=4.0, solid_capstyle="butt")
    right.set(xlabel="from the plane of symmetry [m]", ylabel="height [m]", aspect="equal")
    figure.savefig(target, dpi=200)


def main(out: Path) -> None:
    """Load, unload, and load again, further than before."""
    footing = Footing(sand())
    path, iterations = [(0.0, 0.0)], 0
    for pressure in [*np.arange(2.0, 31.0, 2.0), 20.0, 10.0, 0.0, 10.0, 20.0, *np.arange(30.0, 45.0, 2.0)]:
        residuals = footing.step(float(pressure))
        iterations += len(residuals) - 1
        path.append((float(pressure), footing.settlement()))
    with (out / "footing.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("pressure_MPa", "settlement_m"), *path])
    draw(footing, path, out / "footing.png")
    print(f"{footing.points.largest.size} quadrature points, {len(path) - 1} steps, {iterations} iterations;", end=" ")
    print("residuals of the last step", *(f"{residual:.1e}" for residual in residuals))


if __name__ == "__main__":
    main(Path(sys.argv[1]))

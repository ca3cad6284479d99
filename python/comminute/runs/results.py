"""Results of runs as plain data: one row per load, and what can be read from the rows without a file or a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Fabric,
    Grading,
    LogGrid,
    Material,
    PointMass,
    ResolvedGrid,
    SolveReport,
    StepReport,
    _with_sieves,
    percentile,
)
from comminute.gradings.curves import SizeCurve
from comminute.runs.load_path import fabric_memory
from comminute.runs.recipe import Recipe
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]
Report = SolveReport | StepReport


@dataclass(frozen=True, eq=False, repr=False)
class ResultData:
    """Gradings of a packing along a load path: T loads, N bins; see `Result`, which adds files, plots and `resume`.

    Engines make these fields, files hold them, and every other room reads them.
    """

    material: Material
    grid: LogGrid
    start: Fabric
    unit: str
    stress_ratio: Floats
    stress: Floats | None
    pmf: Floats
    crushes: Floats
    mass_error: Floats
    engine: str
    scheme: str
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    fabrics: tuple[Fabric | None, ...] = field(default=())
    points: tuple[tuple[PointMass, ...], ...] = field(default=())
    reports: tuple[Report, ...] = field(default=())
    recipe: Recipe | None = None
    measured: SizeCurve | None = None

    @property
    def closure(self) -> str:
        """Closure by which neighbours are known: "paper", "resolved", or "none" where a lattice has them all."""
        return "paper"

    @property
    def psi(self) -> Floats:
        """(N,) log sizes, centres of the bins."""
        return self.grid.centres

    @property
    def size(self) -> Floats:
        """(N,) sizes at the centres of the bins."""
        return self.grid.sizes

    @property
    def edge_size(self) -> Floats:
        """(N,) sizes at the upper edges of the bins, where `cdf` is read."""
        return self.grid.edge_sizes[1:]

    @property
    def cdf(self) -> Floats:
        """(T, N) mass fraction finer than `edge_size`."""
        return np.cumsum(self.pmf, axis=1)

    @property
    def fines(self) -> Floats:
        """(T,) share of the mass in the fines bin."""
        return self.pmf[:, 0]

    def percentile(self, percent: float, *, extrapolate: bool = False) -> Floats:
        """Size D_x after each load, such that `percent` of the mass is finer; see `comminute.percentile`.

        Mass in a bin is even in ln d between its edges, in the bin of the largest grain up to that grain. D100 is the
        size of the largest grain as long as its bin holds mass (more than 1e-12 of it), else the upper edge of the
        coarsest bin that does.

        Parameters
        ----------
        percent : float
            Share of the mass that is finer, in per cent, in [0, 100].
        extrapolate : bool
            Whether to continue a curve that ends in the fines bin as a power law.

        Returns
        -------
        ndarray (T,)

        Raises
        ------
        ParameterError
            If D_x lies in the fines bin after some load.
        """
        return np.array([self._percentile(k, percent, extrapolate=extrapolate) for k in range(len(self.pmf))])

    def _percentile(self, k: int, percent: float, *, extrapolate: bool) -> float:
        finer = np.cumsum(self.pmf[k])
        if self.measured is not None and finer[0] < percent / 100.0 <= 1.0:
            return self.curve(k).percentile(percent)
        points, largest = self.points[k] if self.points else (), self.start.largest
        return percentile(self.grid, finer, percent, extrapolate=extrapolate, points=points, largest=largest)

    def curve(self, k: int = -1) -> SizeCurve:
        """Grading curve after load k, for the indices (`comminute.uniformity` and so on).

        Parameters
        ----------
        k : int
            Index of the load.

        Returns
        -------
        SizeCurve
            Curve with its jumps where sizes are exact.

        Examples
        --------
        >>> import comminute as cm
        >>> curve = cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1.0).curve()
        >>> without, including = curve.finer[curve.size == 1.0]
        >>> float((including - without).round(12))
        0.5
        """
        exact = self.points[k] if self.points else ()
        curve = SizeCurve.on_grid(self.grid, np.cumsum(self.pmf[k]), self.unit, exact, self.start.largest)
        return self._with_sieves(curve, self.pmf[k])

    @property
    def start_curve(self) -> SizeCurve:
        """Grading curve before the first load, on the same grid."""
        if self.measured is not None:
            return self.measured
        return SizeCurve.on_grid(self.grid, self.start.cdf(), self.unit, self._start_points, self.start.largest)

    @property
    def _start_points(self) -> Sequence[PointMass]:
        """Exact sizes of the start."""
        return self.start.points

    def _with_sieves(self, curve: SizeCurve, pmf: Floats) -> SizeCurve:
        """Curve that bends at the sieves of a measured start, as far as bins still hold its grains.

        Of the mass in a bin, as much as the start had there is spread as the sieve data are, and the rest, fragments
        that landed there, evenly.
        """
        if self.measured is None:
            return curve
        bent = _with_sieves(curve.numbers, self.grid, pmf, self.start.grainsize(), self.measured.numbers)
        return SizeCurve(bent[0], bent[1], curve.unit, bent[2])

    def fabric(self, k: int) -> Fabric:
        """Fabric after load k (before the remixing, where load k is followed by one).

        Raises
        ------
        ParameterError
            If that fabric was not kept.
        IndexError
            If there is no load k.
        """
        kept = self.fabrics[k]
        if kept is None:
            subject = f"the fabric after load {k}"
            raise parameter_error("k", k, subject=subject, finding="was not kept", remedy="keep_fabric")
        return kept

    def _kept(self) -> str:
        """Tell how many fabrics are kept, and their memory."""
        kept = sum(fabric is not None for fabric in self.fabrics)
        return f", {kept} fabrics ({kept * fabric_memory(self.grid.bins) / 1e6:.3g} MB)"

    def __eq__(self, other: object) -> bool:
        """Equal in every number and setting."""
        if not isinstance(other, ResultData):
            return NotImplemented
        return type(self) is type(other) and same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        loads = f"{self.stress_ratio.size} loads up to {self.stress_ratio.max():g}"
        what = f"engine {self.engine}, {self.crushes[-1]:.3g} crushes a cell{self._kept()}"
        return f"<{type(self).__name__}: {loads}, {self.grid.bins} bins, {what}>"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LatticeData(ResultData):
    """Gradings of a lattice along a load path, with the scatter between its replicas; see `LatticeResult`."""

    cells: int
    replicas: int
    seed: int
    cdf_error: Floats
    crushes_error: Floats
    start_points: tuple[PointMass, ...] = ()

    @property
    def closure(self) -> str:
        """Closure by which neighbours are known; a lattice has none, and needs none."""
        return "none"

    @property
    def _start_points(self) -> Sequence[PointMass]:
        return self.start_points

    def __repr__(self) -> str:
        loads = f"{self.stress_ratio.size} loads up to {self.stress_ratio.max():g}"
        rings = f"{self.replicas} x {self.cells} cells, {self.crushes[-1]:.3g} crushes a cell{self._kept()}"
        return f"<{type(self).__name__}: {loads}, {self.grid.bins} bins, engine {self.engine}, {rings}>"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ResolvedData(ResultData):
    """Gradings by the law of three adjacent cells along a load path; see `ResolvedResult`."""

    grid: ResolvedGrid  # type: ignore[assignment]  # its bins have the names of a LogGrid's, but not one width
    grading: Grading
    avalanches: Floats
    step_error: Floats

    @property
    def closure(self) -> str:
        """Closure by which neighbours are known: two adjacent cells shield what is left of them from what is right."""
        return "resolved"

    @property
    def closure_error(self) -> float:
        """Largest distance to the lattice's curves that was found at this fabric width; see `closure_error`."""
        return closure_error(self.material)

    @property
    def start_curve(self) -> SizeCurve:
        """Grading curve before the first load, as it was given."""
        return SizeCurve.of(self.grading)

    def _percentile(self, k: int, percent: float, *, extrapolate: bool) -> float:
        return self.curve(k).percentile(percent, extrapolate=extrapolate)

    def _with_sieves(self, curve: SizeCurve, pmf: Floats) -> SizeCurve:
        """Curve as it is: sieves are edges of its bins."""
        del pmf
        return curve

    def _kept(self) -> str:
        return ""


# Largest distances of docs/validation/three_cells.md, and of three_cells_scattered.md where strengths scatter, over
# four starts, all laws, both means and nine loads, at each fabric width and those below it.
CLOSURE_ERRORS = {
    False: {0.02: 0.0014, 0.05: 0.0036, 0.1: 0.0036, 0.2: 0.0062, 0.4: 0.0108},
    True: {0.02: 0.0031, 0.05: 0.0116, 0.1: 0.0116, 0.2: 0.0116, 0.4: 0.0132},
}


def closure_error(material: Material) -> float:
    """Largest distance of the resolved closure to the lattice, in the mass finer than a size, found at a fabric width.

    Over equal sizes, a narrow band, two sizes and a wide grading, five fragment laws, both means, Weibull moduli 3 and
    6, and stress ratios up to 10^4. Between the widths tried it is read from a straight line; beyond 0.4 it is NaN.
    """
    found = CLOSURE_ERRORS[material.strength_scatter]
    return float(np.interp(material.fabric_width, list(found), list(found.values()), right=np.nan))

"""Parameters of a material from measured void ratios under known stresses. Needs scipy."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, fitting_grid
from comminute.fitting.models import SPACING
from comminute.fitting.parameters import Parameter, material_with, parameters_of, value_in
from comminute.fitting.search import covariance, profile, search
from comminute.packing.models import COMPACTION, Model, calibrate, void_ratio
from comminute.runs.remarks import ResolutionWarning
from comminute.simulation import Simulation
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords
from comminute.util.optional import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from comminute.result import Result

Floats = npt.NDArray[np.float64]
STEP = 2e-3  # of a parameter, on the scale of the search, over which a derivative is taken
RISE = 3.84  # of the sum of squares at the ends of an interval of 95 %
STARTS = 8  # of the search: below first crush a curve is flat, and says nothing of where it will fall


class CompressionProblem:
    """Void ratios of a specimen as a function of free parameters, for `search`."""

    def __init__(
        self,
        stress: Floats,
        measured: Floats,
        start: Grading,
        material: Material,
        parameters: Sequence[Parameter],
        packing: float,
        model: Model,
        compaction: float,
        error: float,
    ) -> None:
        self.stress, self.measured, self.start, self.material = stress, measured, start, material
        self.parameters = list(parameters)
        self.best: tuple[float, Floats] | None = None
        self._how: dict[str, Any] = {"model": model, "packing": packing, "compaction": compaction}
        self._error = error
        self._grid: LogGrid | None = None

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Ends of the parameters, on the scale of the search."""
        ends = [(one.inner(one.low), one.inner(one.high)) for one in self.parameters]
        return np.array([low for low, _ in ends]), np.array([high for _, high in ends])

    def first(self) -> Floats:
        """(P,) values of the material, on the scale of the search."""
        smallest = float(self.stress.min())
        return np.array([one.inner(value_in(self.material, one.name, smallest)) for one in self.parameters])

    def values(self, vector: Floats) -> dict[str, float]:
        """Values of the parameters by name."""
        return {one.name: one.outer(float(at)) for one, at in zip(self.parameters, vector, strict=True)}

    def material_at(self, vector: Floats) -> Material:
        """Give the material with these values."""
        return material_with(self.material, self.values(vector))

    def prepare(self, vector: Floats) -> None:
        """Size the grid for parameters near these."""
        material = self.material_at(vector)
        largest = float(self.stress.max()) / (material.first_crush_stress or 1.0)
        self._grid = fitting_grid(self.start, material, largest, spacing=SPACING)

    def result(self, material: Material) -> Result:
        """Run a material to the stresses."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResolutionWarning)  # far from the best parameters they mean nothing
            return Simulation(material, self.start, grid=self._grid).run(stress=self.stress, keep_fabrics=[])

    def void_ratios(self, vector: Floats) -> Floats:
        """(M,) void ratios under the stresses."""
        run = self.result(self.material_at(vector))
        return np.array([void_ratio(run.curve(k), **self._how) for k in range(self.stress.size)])

    def residuals(self, vector: Floats) -> Floats:
        """(M,) differences over the error."""
        found = (self.void_ratios(vector) - self.measured) / self._error
        cost = float(found @ found)
        if self.best is None or cost < self.best[0]:
            self.best = cost, vector.copy()
        return found

    def jacobian(self, vector: Floats) -> Floats:
        """(M, P) derivatives of the residuals."""
        columns = []
        for p in range(vector.size):
            side = np.zeros(vector.size)
            side[p] = STEP
            columns.append((self.residuals(vector + side) - self.residuals(vector - side)) / (2.0 * STEP))
        return np.column_stack(columns)


@dataclass(frozen=True, eq=False, repr=False)
class CompressionFit:
    """Parameters that were found from void ratios.

    Attributes
    ----------
    material : Material
    packing : float
        Packing of one size, calibrated to the void ratio at the start.
    values : dict of str to float
        Free parameters.
    intervals : dict of str to (float, float)
        Of 95 %, from the profile of the likelihood; a bound of the parameter where the data do not end it.
    stress, measured, fitted : ndarray (M,)
        Data, and the void ratios of the best parameters.
    initial : float
        Void ratio at the start.
    rms : float
        Root of the mean square of the differences.
    curve_stress, curve : ndarray (Q,)
        Void ratios of the best parameters at many stresses, for pictures.

    Examples
    --------
    >>> import comminute as cm
    >>> sand = cm.lognormal(0.7, 0.2).with_unit("mm")
    >>> grains, stress = cm.Material(reference_size=0.7), [10, 30, 90]
    >>> found = cm.fit_compression(stress, [0.698, 0.591, 0.345], sand, grains, initial=0.734)
    >>> found.rms < 0.04
    True
    """

    material: Material
    packing: float
    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    stress: Floats
    measured: Floats
    fitted: Floats
    initial: float
    rms: float
    curve_stress: Floats
    curve: Floats

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        if not isinstance(other, CompressionFit):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.3g}" for name, value in self.values.items())
        return f"<CompressionFit: {values}; rms {self.rms:.3f} in e over {self.stress.size} points>"

    def table(self) -> str:
        """Values with their intervals, and measured beside fitted void ratios."""
        lines = [f"{'':20}{'value':>10}{'95 % interval':>24}"]
        for name, value in self.values.items():
            low, high = self.intervals[name]
            lines.append(f"{name:20}{value:>10.3g}{f'{low:.3g} to {high:.3g}':>24}")
        lines += ["", f"{'stress':>10}{'measured e':>14}{'model e':>14}"]
        for row in zip(self.stress, self.measured, self.fitted, strict=True):
            lines.append(f"{row[0]:>10.4g}{row[1]:>14.3f}{row[2]:>14.3f}")
        lines.append(f"rms {self.rms:.3f}; virtual packing {self.packing:.4f} from e = {self.initial:g} at the start")
        return "\n".join(lines)

    def plot(self) -> Figure:
        """Draw the void ratio against the stress, measured and fitted; needs matplotlib.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute.plotting.compression import plot_void_ratios  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plot_void_ratios({"model": (self.curve_stress, self.curve)}, {"measured": (self.stress, self.measured)})


@suggests_keywords
def fit_compression(
    stress: Sequence[float] | Floats,
    measured: Sequence[float] | Floats,
    start: Grading,
    material: Material,
    free: Sequence[str] = ("fabric_width", "first_crush_stress"),
    *,
    initial: float,
    error: float = 0.03,
    model: Model = "cpm",
    compaction: float = COMPACTION,
    seed: int = 0,
) -> CompressionFit:
    """Find parameters of a material by least squares on void ratios in compression.

    A packing model stands between grading and void ratio, calibrated to the specimen's void ratio at the start; what is
    found is no better than that. Gradings, where they were measured, tell far more: see `fit`.

    Parameters
    ----------
    stress, measured : sequence of float
        Stresses, greater than 0 and rising, and the void ratio under each.
    start : Grading
    material : Material
        Values of what is not free; its reference_size, in the unit of the start, is needed.
    free : sequence of str
        Any of those of `fit` but "loading_rate".
    initial : float
        Void ratio of the start.
    error : float
        Standard deviation of a void ratio. By default 0.03, which is the packing model's: models of mixed packings
        differ by .02 to .06. It is assumed, not estimated from the misfit, and intervals are no better than it.
    model : {"cpm", "lpm", "linear-mixture"}
        Packing model.
    compaction : float
        K of "cpm".
    seed : int
        Seed of the starts of the search.

    Returns
    -------
    CompressionFit

    Raises
    ------
    ParameterError
        For data or names that it cannot use, or a void ratio at the start that the model does not reach.
    ImportError
        Without scipy, naming the extra to install.

    Examples
    --------
    >>> import comminute as cm
    >>> sand = cm.lognormal(0.7, 0.2).with_unit("mm")
    >>> grains, stress = cm.Material(reference_size=0.7), [10, 30, 90]
    >>> found = cm.fit_compression(stress, [0.698, 0.591, 0.345], sand, grains, initial=0.734)
    >>> sorted(found.values)
    ['fabric_width', 'first_crush_stress']
    """
    try:
        import scipy  # noqa: F401, PLC0415  (scipy is optional)
    except ImportError as error_of_import:
        raise needs("fit", "scipy", "fit_compression") from error_of_import
    loads, ratios = _data(stress, measured)
    if not 0.0 < error < math.inf:
        raise parameter_error("error", error, "it must be greater than 0 and finite")
    if "loading_rate" in free:
        raise parameter_error("free", "'loading_rate'", "void ratios do not tell it", finding="names 'loading_rate'")
    if material.first_crush_stress is None and "first_crush_stress" not in free:
        rule = "free it, or set it on the Material"
        raise parameter_error("first_crush_stress", "None", rule, finding="is neither set nor free")
    parameters = parameters_of(list(free), material, float(loads.max()), "paper", by_ratio=False)
    if loads.size < len(parameters):
        finding = f"has {loads.size} values for {len(parameters)} free parameters"
        raise parameter_error("measured", loads.size, "it must have as many at least", finding=finding)
    packing = calibrate(start, initial, model, compaction=compaction)
    problem = CompressionProblem(loads, ratios, start, material, parameters, packing, model, compaction, error)
    found = search(problem, STARTS, seed)
    deviations = np.sqrt(np.diag(covariance(problem.jacobian(found.vector))))
    ends = profile(problem, found, deviations, RISE)
    fitted = problem.void_ratios(found.vector)
    best = problem.material_at(found.vector)
    many = np.geomspace(0.1 * float(loads.min()), float(loads.max()), 60)
    run = Simulation(best, start).run(stress=many, keep_fabrics=[])
    curve = run.void_ratio(model=model, packing=packing, compaction=compaction)
    return CompressionFit(
        best,
        packing,
        problem.values(found.vector),
        {one.name: (one.outer(low), one.outer(high)) for one, (low, high) in zip(parameters, ends, strict=True)},
        loads,
        ratios,
        fitted,
        initial,
        float(np.sqrt(np.mean((fitted - ratios) ** 2))),
        many,
        curve,
    )


def _data(stress: Sequence[float] | Floats, measured: Sequence[float] | Floats) -> tuple[Floats, Floats]:
    """Check stresses and void ratios."""
    loads, ratios = np.array(stress, dtype=np.float64), np.array(measured, dtype=np.float64)
    if loads.ndim != 1 or loads.size == 0 or loads.shape != ratios.shape:
        finding = f"has {ratios.size} values for {loads.size} stresses"
        raise parameter_error("measured", ratios.size, "it must have one for each", finding=finding)
    if not (loads[0] > 0.0 and np.all(np.diff(loads) > 0.0) and math.isfinite(loads[-1])):
        rule = "they must be greater than 0 and rise; the void ratio under none is `initial`"
        raise parameter_error("stress", float(loads[0]), rule, finding=f"is {loads.tolist()}")
    if not np.all((ratios > 0.0) & np.isfinite(ratios)):
        bad = float(ratios[~((ratios > 0.0) & np.isfinite(ratios))][0])
        raise parameter_error("measured", bad, "void ratios must be greater than 0 and finite")
    return loads, ratios

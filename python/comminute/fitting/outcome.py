"""The outcome of a fit: values, intervals, residuals, and what to do with them."""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, Material
from comminute.fitting.case_text import case_text
from comminute.fitting.measurements import Measurement
from comminute.fitting.models import FitModel, LatticeModel
from comminute.gradings.curves import SizeCurve
from comminute.result import Result
from comminute.runs.remarks import ResolutionWarning, load_text
from comminute.simulation import Simulation
from comminute.util.choices import Closure
from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from comminute.fitting.problem import FitProblem
    from comminute.fitting.search import Found

Floats = npt.NDArray[np.float64]
WITNESS_CELLS = 200_000  # of the lattice that a closure is held against; its noise in F is about .001


class ClosureError(NamedTuple):
    """Distance of the fitted model to the lattice, at the measured sieves and stresses and the parameters found.

    Attributes
    ----------
    rms : float
        Root of the mean square, in mass fraction.
    largest : float
        Largest of all.
    """

    rms: float
    largest: float


@dataclass(frozen=True, eq=False, repr=False)
class FitResult:
    """Parameters found from measured gradings, and how well; see `fit`.

    Attributes
    ----------
    problem : FitProblem
        Data, residuals and likelihood, for samplers.
    closure : str
        Model that was fitted.
    vector : ndarray (P,)
        The best parameters on the scale of the search: logarithms of positive ones.
    values : dict of str to float
        The best parameters by their names.
    intervals : dict of str to (float, float)
        Intervals of 95 %.
    interval_kind : {"covariance", "profile"}
    covariance : ndarray (P, P)
        On the scale of the search; widened where the fit is worse than the stated errors.
    correlation : ndarray (P, P)
        NaN for a parameter of which the data say nothing.
    material : Material
        Material with the values found.
    loading_rate : float
    starts : tuple of Grading
        Start of each group of data, measured or found.
    model : tuple of ndarray
        Mass fraction finer by the model, at the sieves of each measurement.
    residuals : tuple of ndarray
        The same less what was measured.
    rms : float
        Root of the mean square of all residuals, in mass fraction.
    chi2 : float
        Sum of the squares of all residuals over their errors, priors among them.
    freedom : int
        Numbers measured less parameters.
    costs : tuple of float
        `chi2` at the end of each search, first to last start.
    interrupted : bool
        Ctrl-C came before the end.

    Examples
    --------
    >>> import comminute as cm
    >>> start, after = cm.fuller(2.0), cm.Measurement(12.0, [2.0, 1.0, 0.5, 0.25], [1.0, 0.83, 0.66, 0.5])
    >>> known = cm.Material(reference_size=2.0, first_crush_stress=2.0)
    >>> found = cm.fit([after], start, known, free=["fabric_width"], starts=1)
    >>> found.material.fabric_width == found.values["fabric_width"]
    True
    >>> print(found.table().splitlines()[0])
    parameter          value           95 % interval  by covariance
    """

    problem: FitProblem
    closure: FitModel
    vector: Floats
    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    interval_kind: str
    covariance: Floats
    correlation: Floats
    material: Material
    loading_rate: float
    starts: tuple[Grading, ...]
    model: tuple[Floats, ...]
    residuals: tuple[Floats, ...]
    rms: float
    chi2: float
    freedom: int
    costs: tuple[float, ...]
    interrupted: bool

    @classmethod
    def of(
        cls,
        problem: FitProblem,
        found: Found,
        covariance: Floats,
        ends: list[tuple[float, float]],
        interval_kind: str,
        closure: FitModel,
        *,
        interrupted: bool,
    ) -> FitResult:
        """Outcome of a search."""
        deviations = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            correlation = covariance / np.outer(deviations, deviations)
        model = problem.curves(found.vector)
        residuals = [curve - datum.finer for curve, datum in zip(model, problem.data, strict=True)]
        together = np.concatenate(residuals)
        values = problem.values(found.vector)
        return cls(
            problem=problem,
            closure=closure,
            vector=found.vector,
            values=values,
            intervals={
                one.name: (one.outer(low), one.outer(high))
                for one, (low, high) in zip(problem.parameters, ends, strict=True)
            },
            interval_kind=interval_kind,
            covariance=covariance,
            correlation=correlation,
            material=problem.material_at(found.vector),
            loading_rate=values.get("loading_rate", 0.0),
            starts=tuple(problem.starts_at(found.vector)),
            model=tuple(model),
            residuals=tuple(residuals),
            rms=float(np.sqrt(np.mean(together**2))),
            chi2=found.cost,
            freedom=problem.count - len(problem.parameters),
            costs=tuple(found.costs),
            interrupted=interrupted,
        )

    @property
    def data(self) -> tuple[Measurement, ...]:
        """Measurements, in the order in which they were given."""
        return self.problem.data

    def simulation(self, start: int = 0) -> Simulation:
        """Give a simulation with the parameters found; a fit on the lattice gives one by the resolved closure."""
        closure: Closure = "paper" if self.closure == "paper" else "resolved"
        return Simulation(self.material, self.starts[start], closure=closure)

    def predict(self, stress: float | list[float] | Floats, start: int = 0) -> Result:
        """Run with the parameters found, to other loads than those measured.

        Parameters
        ----------
        stress : float or sequence
            Loads of the kind of the data.
        start : int
            Index among `starts`.

        Examples
        --------
        >>> import comminute as cm
        >>> start, sieves = cm.power_law(2.5, 0.02, 2.0), [2.0, 1.0, 0.5, 0.25]
        >>> run = cm.Simulation(cm.Material(reference_size=2.0, fabric_width=0.4), start).run(stress_ratio=20.0)
        >>> data = [cm.Measurement(20.0, sieves, run.curve().finer_than(sieves))]
        >>> material = cm.Material(reference_size=2.0)
        >>> found = cm.fit(data, start, material, free=["fabric_width"], loads="stress_ratio")
        >>> coarse, fine = found.predict([10.0, 50.0]).percentile(50)
        >>> bool(fine < coarse)
        True
        """
        kind = "stress" if self.material.first_crush_stress is not None else "stress_ratio"
        loads: dict[str, Any] = {kind: stress}
        if self.closure == "paper":
            loads["loading_rate"] = self.loading_rate
        return self.simulation(start).run(**loads)

    def curves(self) -> list[SizeCurve]:
        """Fitted curve of each measurement, at all sizes; a fit on the lattice gives those of the resolved closure."""
        found: list[SizeCurve | None] = [None] * len(self.data)
        for k, group in enumerate(self.problem.groups):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ResolutionWarning)  # the sieves decide which sizes matter
                run = self.predict([self.data[index].stress for index in group.data], k)
            for place, index in enumerate(group.data):
                found[index] = run.curve(place)
        return [curve for curve in found if curve is not None]

    @cached_property
    def closure_error(self) -> ClosureError:
        """Distance of the fitted model to the lattice at the parameters found; it runs when it is asked for."""
        lattice = self.problem.curves(self.vector, LatticeModel(cells=WITNESS_CELLS, seed=1))
        gaps = np.concatenate([curve - other for curve, other in zip(self.model, lattice, strict=True)])
        return ClosureError(float(np.sqrt(np.mean(gaps**2))), float(np.abs(gaps).max()))

    def table(self) -> str:
        """Text: values with intervals, fit and closure beside each other, correlations, residuals by stress."""
        names = self.problem.names
        width = max(map(len, names)) + 2
        lines = [f"{'parameter':<{width}}{'value':>10}{'95 % interval':>24}  by {self.interval_kind}"]
        for name in names:
            low, high = self.intervals[name]
            lines.append(f"{name:<{width}}{self.values[name]:>10.4g}{f'{low:.4g} to {high:.4g}':>24}")
        lines += ["", *self._summary(), ""]
        if len(names) > 1:
            lines.append("correlation")
            for p, name in enumerate(names):
                lines.append(f"{name:<{width}}" + "".join(f"{self.correlation[p, q]:8.3f}" for q in range(p + 1)))
            lines.append("")
        lines.append(f"{'load':>10}{'sieves':>8}{'rms':>8}{'largest':>9}{'at size':>10}")
        for datum, residual in zip(self.data, self.residuals, strict=True):
            worst = int(np.argmax(np.abs(residual)))
            lines.append(
                f"{load_text(datum.stress):>10}{residual.size:>8}{np.sqrt(np.mean(residual**2)):>8.4f}"
                f"{residual[worst]:>+9.4f}{datum.size[worst]:>10.4g}"
            )
        return "\n".join(lines)

    def _summary(self) -> list[str]:
        lines = [
            f"fit: rms {self.rms:.4f} of the mass finer, chi2 {self.chi2:.1f} of {self.freedom} degrees of freedom"
        ]
        if self.closure != "lattice":
            error = self.closure_error
            times = error.rms / self.rms if self.rms > 0.0 else float("inf")
            lines.append(
                f"closure '{self.closure}': rms {error.rms:.4f} from the lattice at these parameters "
                f"({times:.2g} times the fit's), largest {error.largest:.4f}"
            )
            if error.rms > self.rms:
                lines.append("the closure's error is larger than the fit's: the values belong to this closure alone")
        if self.interrupted:
            lines.append("interrupted: the best so far")
        return lines

    def rows(self) -> list[dict[str, float]]:
        """One record for each sieve of each measurement: load, size, measured, model, residual, error."""
        return [
            {
                "load": datum.stress,
                "size": float(size),
                "measured": float(measured),
                "model": float(model),
                "residual": float(model - measured),
                "error": float(error),
            }
            for datum, curve in zip(self.data, self.model, strict=True)
            for size, measured, model, error in zip(
                datum.size, datum.finer, curve, np.broadcast_to(np.asarray(datum.error), datum.size.shape), strict=True
            )
        ]

    def to_dict(self) -> dict[str, Any]:
        """Everything in plain numbers, for JSON."""
        return {
            "closure": self.closure,
            "values": self.values,
            "intervals": {name: list(ends) for name, ends in self.intervals.items()},
            "interval_kind": self.interval_kind,
            "correlation": [[None if np.isnan(c) else float(c) for c in row] for row in self.correlation],
            "rms": self.rms,
            "chi2": self.chi2,
            "freedom": self.freedom,
            "unit": self.data[0].unit,
            "interrupted": self.interrupted,
            "residuals": self.rows(),
        }

    def save(self, path: str | os.PathLike[str], start: int = 0, *, stress_unit: str = "") -> Path:
        """Write a case that is ready to run (.toml), or all numbers (.json).

        Parameters
        ----------
        path : path
        start : int
            Index among `starts` of the one that the case has.
        stress_unit : str
            Unit of the stresses, as text for the case; left out, the case says MPa as others do.

        Raises
        ------
        ParameterError
            For another ending, and for a start with exact sizes in a case.
        """
        target = Path(path)
        if target.suffix == ".json":
            target.write_text(json.dumps(self.to_dict(), indent=1) + "\n", encoding="utf-8")
        elif target.suffix == ".toml":
            target.write_text(self._case(start, stress_unit), encoding="utf-8")
        else:
            raise parameter_error("path", f"'{target}'", "it must end in .toml (a case) or .json (all numbers)")
        return target

    def _case(self, start: int, stress_unit: str) -> str:
        remarks = [f"Fitted to {len(self.data)} gradings: rms {self.rms:.4f} of the mass finer."]
        for name, (low, high) in self.intervals.items():
            remarks.append(f"{name} {self.values[name]:.4g}, {low:.4g} to {high:.4g} at 95 %")
        loads = [self.data[index].stress for index in self.problem.groups[start].data]
        units = {"size": self.starts[start].unit, "stress": stress_unit}
        return case_text(self.material, self.starts[start], loads, self.loading_rate, self.closure, units, remarks)

    def plot(self) -> Figure:
        """Draw measured against fitted gradings, residuals, and intervals. Needs matplotlib."""
        from comminute.plotting.fits import plot_fit  # noqa: PLC0415  (matplotlib is optional)

        return plot_fit(self)

    def __eq__(self, other: object) -> bool:
        """Equal in problem and in every number."""
        if not isinstance(other, FitResult):
            return NotImplemented
        return self.problem == other.problem and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        found = ", ".join(f"{name} {value:.4g}" for name, value in self.values.items())
        return f"<FitResult: {found}; rms {self.rms:.2g} over {self.problem.count} sieves>"

"""A fit as a problem of least squares: residuals over the errors of the data, and their derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, Material
from comminute.fitting.measurements import Measurement, Start, UnknownStart
from comminute.fitting.models import Model, Specimen
from comminute.fitting.parameters import Parameter, material_with, value_in
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Group:
    """Data that share a start.

    Attributes
    ----------
    start : Grading or UnknownStart
    data : tuple of int
        Indices of the measurements, by rising stress.
    """

    start: Start
    data: tuple[int, ...]


class FitProblem:
    """Residuals of measured gradings as a function of the free parameters.

    A residual is the model's mass finer than a sieve less the measured one, over the standard deviation of the latter.
    Errors of different sieves count as independent. What is known of an unknown start comes as two more residuals each.

    Samplers of posteriors take `log_likelihood`, which has the same errors and priors; see `fit`, which makes a
    problem and solves it.

    Attributes
    ----------
    names : tuple of str
        Free parameters, those of unknown starts among them, in the order of vectors.
    parameters : tuple of Parameter
        Their bounds.
    data : tuple of Measurement
        All in one unit, each with its start and errors.
    material : Material
        Values of everything that is not free.

    Examples
    --------
    >>> import comminute as cm
    >>> start, after = cm.fuller(2.0), cm.Measurement(12.0, [2.0, 1.0, 0.5, 0.25], [1.0, 0.83, 0.66, 0.5])
    >>> known = cm.Material(reference_size=2.0, first_crush_stress=2.0)
    >>> problem = cm.fit([after], start, known, free=["fabric_width"], starts=1).problem
    >>> problem.names
    ('fabric_width',)
    >>> problem.log_likelihood({"fabric_width": 0.02}) < problem.log_likelihood({"fabric_width": 0.2})
    True
    """

    def __init__(
        self, data: Sequence[Measurement], material: Material, parameters: Sequence[Parameter], model: Model
    ) -> None:
        self.data = tuple(data)
        self.material = material
        self.model = model
        self.groups = _grouped(self.data)
        starts = [_of_start(group.start, k, len(self.groups)) for k, group in enumerate(self.groups)]
        self.parameters = (*parameters, *(one for pair in starts for one in pair))
        self.names = tuple(one.name for one in self.parameters)
        self._starts = {group: pair for group, pair in enumerate(starts) if pair}
        self.evaluations = 0
        self.best: tuple[float, Floats] | None = None
        if len(self.parameters) > self.count:
            rule = f"{self.count} numbers were measured: free fewer"
            raise parameter_error("free", len(self.parameters), rule, finding=f"has {len(self.parameters)} parameters")

    def __eq__(self, other: object) -> bool:
        """Equal in data, material, parameters and model."""
        if not isinstance(other, FitProblem):
            return NotImplemented
        mine, others = ((one.data, one.material, one.parameters, type(one.model)) for one in (self, other))
        return mine == others

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<FitProblem: {', '.join(self.names)}; {len(self.data)} gradings, {self.count} sieves>"

    @property
    def count(self) -> int:
        """Numbers that were measured."""
        return sum(datum.size.size for datum in self.data)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Bounds on the scale of the search."""
        return (
            np.array([one.inner(one.low) for one in self.parameters]),
            np.array([one.inner(one.high) for one in self.parameters]),
        )

    def first(self) -> Floats:
        """Vector from which the search starts: the material's own values."""
        smallest = min(datum.stress for datum in self.data)
        found = []
        for one in self.parameters:
            if one.name.startswith("start_"):
                value = one.usual_low * np.sqrt(one.usual_high / one.usual_low)
            else:
                value = value_in(self.material, one.name, smallest)
            found.append(one.inner(min(max(value, one.low), one.high)))
        return np.array(found)

    def values(self, vector: Floats) -> dict[str, float]:
        """Values of all free parameters by their names."""
        return {one.name: one.outer(float(inner)) for one, inner in zip(self.parameters, vector, strict=True)}

    def vector(self, values: Mapping[str, float]) -> Floats:
        """Vector of values.

        Raises
        ------
        ParameterError
            For a value that is missing or outside its bounds.
        """
        found = []
        for one in self.parameters:
            if one.name not in values:
                raise parameter_error("values", ", ".join(values), f"it must have '{one.name}'")
            value = float(values[one.name])
            if not one.low <= value <= one.high:
                raise parameter_error(one.name, value, f"it must lie between {one.low:g} and {one.high:g}")
            found.append(one.inner(value))
        return np.array(found)

    def material_at(self, vector: Floats) -> Material:
        """Material of a vector."""
        values = self.values(vector)
        return material_with(self.material, {n: v for n, v in values.items() if not n.startswith("start_")})

    def starts_at(self, vector: Floats) -> list[Grading]:
        """Start of each group of data."""
        values = self.values(vector)
        found = []
        for k, group in enumerate(self.groups):
            if isinstance(group.start, UnknownStart):
                median, sd_log = (values[one.name] for one in self._starts[k])
                found.append(group.start.grading(median, sd_log, self.data[0].unit))
            else:
                found.append(group.start)
        return found

    def specimens(self, vector: Floats) -> list[Specimen]:
        """Give the starts with their loads and sieves."""
        made = []
        for start, group in zip(self.starts_at(vector), self.groups, strict=True):
            data = [self.data[index] for index in group.data]
            made.append(Specimen(start, tuple(one.stress for one in data), tuple(one.size for one in data)))
        return made

    def prepare(self, vector: Floats) -> None:
        """Have the model choose its grids for parameters near a vector."""
        self.model.prepare(self.material_at(vector), self.specimens(vector))

    def curves(self, vector: Floats, model: Model | None = None) -> list[Floats]:
        """(M,) mass finer than the sieves of each measurement, by the model of the fit or by another."""
        material, rate = self.material_at(vector), self.values(vector).get("loading_rate", 0.0)
        found: list[Floats] = [np.zeros(0)] * len(self.data)
        for k, (specimen, group) in enumerate(zip(self.specimens(vector), self.groups, strict=True)):
            for index, curve in zip(group.data, (model or self.model).curves(material, k, specimen, rate), strict=True):
                found[index] = curve
        return found

    def differences(self, vector: Floats) -> list[Floats]:
        """(M,) model less measurement, in mass fraction, for each measurement."""
        return [curve - datum.finer for curve, datum in zip(self.curves(vector), self.data, strict=True)]

    def residuals(self, vector: Floats) -> Floats:
        """All differences over their errors, then those of the priors.

        Half the sum of their squares is minus the log of the posterior, but for a constant.
        """
        self.evaluations += 1
        parts = [
            gap / datum.error
            for gap, datum in zip(self.differences(vector), self.data, strict=True)
            if datum.error is not None
        ]
        residuals = np.concatenate([*parts, self._of_priors(vector)])
        cost = float(residuals @ residuals)
        if self.best is None or cost < self.best[0]:
            self.best = (cost, vector.copy())
        return residuals

    def log_likelihood(self, values: Mapping[str, float]) -> float:
        """Log of the likelihood, times the priors of unknown starts, but for a constant; -inf outside the bounds.

        Parameters
        ----------
        values : mapping of str to float
            By `names`.
        """
        for one in self.parameters:
            if not one.low <= float(values[one.name]) <= one.high:
                return -np.inf
        residuals = self.residuals(self.vector(values))
        return -0.5 * float(residuals @ residuals)

    def jacobian(self, vector: Floats) -> Floats:
        """(R, P) derivatives of the residuals by central differences, one-sided at a bound."""
        low, high = self.bounds
        columns = []
        for p in range(vector.size):
            up, down = vector.copy(), vector.copy()
            up[p] = min(vector[p] + self.model.step, high[p])
            down[p] = max(vector[p] - self.model.step, low[p])
            columns.append((self.residuals(up) - self.residuals(down)) / (up[p] - down[p]))
        return np.column_stack(columns)

    def _of_priors(self, vector: Floats) -> Floats:
        values = self.values(vector)
        found = []
        for k, (median, sd_log) in self._starts.items():
            start = self.groups[k].start
            assert isinstance(start, UnknownStart)
            found += [
                np.log(values[median.name] / start.median) / start.median_error,
                np.log(values[sd_log.name] / start.sd_log) / start.sd_log_error,
            ]
        return np.array(found)


def _grouped(data: Sequence[Measurement]) -> list[Group]:
    groups: list[tuple[Start, list[int]]] = []
    for index, datum in enumerate(data):
        assert datum.start is not None  # as `measurements_of` requires
        for start, members in groups:
            if start == datum.start:
                members.append(index)
                break
        else:
            groups.append((datum.start, [index]))
    return [Group(start, tuple(sorted(members, key=lambda index: data[index].stress))) for start, members in groups]


def _of_start(start: Start, group: int, groups: int) -> tuple[Parameter, ...]:
    """Two parameters of an unknown start; none of a known one."""
    if not isinstance(start, UnknownStart):
        return ()
    ending = f"_{group}" if groups > 1 else ""

    def one(name: str, value: float, error: float) -> Parameter:
        most = np.exp(5.0 * error)
        return Parameter(
            f"start_{name}{ending}", value / most, value * most, value / np.exp(error), value * np.exp(error)
        )

    return one("median", start.median, start.median_error), one("sd_log", start.sd_log, start.sd_log_error)

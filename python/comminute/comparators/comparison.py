"""Curves of a result beside those of other models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from comminute._core import Grading
from comminute.gradings.curves import SizeCurve
from comminute.runs.remarks import load_labels
from comminute.runs.results import ResultData
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error
from comminute.util.optional import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class ModelComparison:
    """Curves of a result and of other models at the same loads.

    Attributes
    ----------
    quantity : str
        Name of the loads.
    loads : tuple of str
        Texts of the loads.
    curves : tuple of SizeCurve
        Curves of the result, one for each load.
    others : dict of str to tuple of SizeCurve
        Curves of each model, one for each load.

    Examples
    --------
    >>> import comminute as cm
    >>> start = cm.monodisperse(1.0)
    >>> run = cm.Simulation(cm.Material(fabric_width=0.2), start).run(stress_ratio=[2.0, 20.0])
    >>> compared = run.compare_with({"breakage": cm.comparators.breakage(start, [2.0, 20.0])})
    >>> compared.distance("breakage").shape
    (2,)
    """

    quantity: str
    loads: tuple[str, ...]
    curves: tuple[SizeCurve, ...]
    others: dict[str, tuple[SizeCurve, ...]]

    @classmethod
    def of(
        cls, result: ResultData, others: Mapping[str, SizeCurve | Grading | Sequence[SizeCurve | Grading]]
    ) -> ModelComparison:
        """Lay models beside a result; see `Result.compare_with`."""
        quantity, loads = load_labels(result)
        curves = tuple(result.curve(k) for k in range(len(loads)))
        found = dict[str, tuple[SizeCurve, ...]]()
        for name, given in others.items():
            listed = [given] * len(loads) if isinstance(given, SizeCurve | Grading) else list(given)
            if len(listed) != len(loads):
                finding = f"has {len(listed)} curves"
                raise parameter_error(
                    name, len(listed), f"it must have one for each of the {len(loads)} loads", finding=finding
                )
            found[name] = tuple(SizeCurve.of(one) for one in listed)
            units = {curve.unit for curve in found[name]} | {result.unit}
            if len(units) > 1:
                finding = f"are in {', '.join(sorted(unit or 'no unit' for unit in units))}"
                raise parameter_error(name, subject="the gradings", finding=finding, remedy="use_one_unit")
        return cls(quantity, tuple(loads), curves, found)

    def distance(self, name: str) -> Floats:
        """(T,) largest difference in the mass finer than a size, of a model and the result."""
        if name not in self.others:
            raise parameter_error("name", f"'{name}'", f"it must be one of {', '.join(self.others)}")
        return np.array([largest_difference(*pair) for pair in zip(self.curves, self.others[name], strict=True)])

    def __eq__(self, other: object) -> bool:
        """Equal in every curve."""
        if not isinstance(other, ModelComparison):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<ModelComparison: {len(self.loads)} loads, {', '.join(self.others)}>"

    def table(self) -> str:
        """Distances of all models to the result, by load."""
        names = list(self.others)
        width = max(12, *(len(name) + 2 for name in names))
        rows = [f"{self.quantity:>16}" + "".join(f"{name:>{width}}" for name in names)]
        distances = [self.distance(name) for name in names]
        for k, load in enumerate(self.loads):
            rows.append(f"{load:>16}" + "".join(f"{distance[k]:>{width}.3f}" for distance in distances))
        return "\n".join(rows)

    def plot(self) -> Figure:
        """Draw the curves of all models beside those of the result, load by load; needs matplotlib.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute.plotting.models import plot_models  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plot_models(self.quantity, self.loads, self.curves, self.others)


def largest_difference(one: SizeCurve, other: SizeCurve) -> float:
    """Largest difference in the mass finer than a size, of two curves at all of their points, before jumps and after.

    Examples
    --------
    >>> import comminute as cm
    >>> from comminute.comparators.comparison import largest_difference
    >>> coarse, fine = (cm.SizeCurve.of(cm.monodisperse(size)) for size in (1.0, 0.5))
    >>> largest_difference(coarse, fine)
    1.0
    """
    size = np.union1d(one.size, other.size)
    before = size * (1.0 - 1e-12)
    at = np.concatenate([size, before])
    return float(np.abs(one.finer_than(at) - other.finer_than(at)).max())

"""Measured gradings under stresses: what a fit reads, with the error of each number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, lognormal
from comminute.gradings.curves import SizeCurve
from comminute.gradings.sieves import IN_MM, convert, unit_of
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class UnknownStart:
    """A start that nobody has measured: a lognormal grading, about which a prior says what is known.

    Attributes
    ----------
    median : float
        Prior median of the start's median size by mass, in the unit of the data.
    sd_log : float
        Prior median of its standard deviation of ln(size).
    largest : float
        Size that no grain exceeds, known.
    median_error, sd_log_error : float
        Standard deviations of ln(median) and ln(sd_log) in the prior, > 0; both are normal.

    Examples
    --------
    >>> import comminute as cm
    >>> guess = cm.UnknownStart(median=0.6, sd_log=0.5, largest=2.0)
    >>> round(guess.grading().percentile(50), 2)
    0.6
    """

    median: float
    sd_log: float
    largest: float
    median_error: float = 0.3
    sd_log_error: float = 0.3

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0.0 < value < np.inf:
                raise parameter_error(name, float(value), "it must be greater than 0 and finite")

    def grading(self, median: float | None = None, sd_log: float | None = None, unit: str = "") -> Grading:
        """Start with other values of its two numbers than those of the prior."""
        grading = lognormal(median or self.median, sd_log or self.sd_log, largest=self.largest)
        return grading.with_unit(unit) if unit else grading


Start = Grading | UnknownStart


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Measurement:
    """A grading that was measured under a stress.

    Attributes
    ----------
    stress : float
        Largest stress that the specimen has borne, quoted as the material's first_crush_stress is; or a stress ratio,
        where the fit takes those.
    size : ndarray (M,)
        Sieves, in any order.
    finer : ndarray (M,)
        Mass fraction finer than each, as measured: it may fall, and leave [0, 1] by the error of a measurement.
    unit : str
        Unit of the sieves; empty where they are relative.
    start : Grading, UnknownStart or None
        Start of this specimen; None where it is that of the fit.
    error : float or ndarray (M,) or None
        Standard deviation of `finer`; None where it is that of the fit.

    Raises
    ------
    ParameterError
        For a stress that is not positive, sieves that are not positive or not different, numbers of another length,
        or fractions far outside [0, 1].

    Examples
    --------
    >>> import comminute as cm
    >>> after = cm.Measurement(12.0, [2.0, 1.0, 0.5], [1.0, 0.82, 0.41], unit="mm")
    >>> after.error is None, after.size.size
    (True, 3)
    """

    stress: float
    size: Floats
    finer: Floats
    unit: str
    start: Start | None
    error: float | Floats | None

    def __init__(
        self,
        stress: float,
        size: npt.ArrayLike,
        finer: npt.ArrayLike,
        unit: str = "",
        start: Start | None = None,
        error: float | Floats | None = None,
    ) -> None:
        if isinstance(stress, str):
            raise TypeError(f"stress is '{stress}'; it must be a number")
        size, finer = np.array(size, dtype=np.float64), np.array(finer, dtype=np.float64)
        own = {"stress": float(stress), "size": size, "finer": finer, "unit": unit, "start": start, "error": error}
        for name, value in own.items():
            object.__setattr__(self, name, value)  # a frozen record sets itself up so
        if self.unit and not unit_of(self.unit):
            raise parameter_error("unit", f"'{self.unit}'", f"it must be one of {', '.join(IN_MM)}")
        object.__setattr__(self, "unit", unit_of(self.unit))
        if not 0.0 < self.stress < np.inf:
            raise parameter_error("stress", float(self.stress), "it must be greater than 0 and finite")
        if size.ndim != 1 or size.size == 0 or size.shape != finer.shape:
            rule = "both must be lists of one length, at least 1"
            raise parameter_error("finer", finer.shape, rule, finding=f"has shape {finer.shape}, and size {size.shape}")
        for index in np.flatnonzero(~((size > 0.0) & np.isfinite(size)))[:1]:
            raise parameter_error(f"size[{index}]", float(size[index]), "it must be greater than 0 and finite")
        if np.unique(size).size < size.size:
            raise parameter_error("size", "", "each sieve must be there once", finding="has a sieve twice")
        for index in np.flatnonzero(~((finer >= -0.2) & (finer <= 1.2)))[:1]:
            rule = "it must be a mass fraction, between 0 and 1 but for an error of measurement (12 % is 0.12)"
            raise parameter_error(f"finer[{index}]", float(finer[index]), rule)

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        return (
            same_values(vars(self).values(), vars(other).values()) if isinstance(other, Measurement) else NotImplemented
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        sieves = f"{self.size.size} sieves, {self.size.min():.4g} to {self.size.max():.4g}{unit}"
        return f"<Measurement: {sieves}, load {self.stress:g}>"

    @classmethod
    def of(cls, stress: float, grading: Grading | SizeCurve, start: Start | None = None) -> Measurement:
        """Measurement of a grading at its sieves.

        Raises
        ------
        ParameterError
            For a grading that is no measured one, since a law has no sieves.
        """
        if isinstance(grading, Grading) and not grading.measured:
            rule = "it must be measured: Grading.read, Grading.from_sieves, or a Measurement at sieves of your choice"
            raise parameter_error("grading", "an ideal law", rule, finding="is an ideal law, which has no sieves")
        curve = SizeCurve.of(grading)
        return cls(stress, curve.size, curve.finer, curve.unit, start)


def measurements_of(data: Sequence[Any], start: Start | None, error: float) -> list[Measurement]:
    """Bring all that a fit may be given to one unit, each with its start and its error.

    Parameters
    ----------
    data : sequence
        Each a Measurement, or a pair (stress, Grading), or a triple with the start of the specimen.
    start : Grading, UnknownStart or None
        Start of those that name none.
    error : float
        Standard deviation of those that name none, > 0.

    Raises
    ------
    TypeError
        For a datum of another kind.
    ParameterError
        For no data, a start that is missing, units that do not go together, or an error that is not positive.
    """
    if not data:
        rule = "give (stress, grading) for each measured grading"
        raise parameter_error("data", "[]", rule, finding="is empty")
    made = []
    for index, datum in enumerate(data):
        if not isinstance(datum, Measurement):
            if not isinstance(datum, tuple | list) or len(datum) not in (2, 3):
                raise TypeError(
                    f"data[{index}] is a {type(datum).__name__}; it must be a Measurement, a pair (stress, grading), "
                    "or a triple (stress, grading, start)"
                )
            datum = Measurement.of(*datum)  # noqa: PLW2901
        own = datum.start or start
        if own is None:
            rule = "give start, for all or with this datum; an UnknownStart where nobody measured it"
            raise parameter_error("start", "None", rule, finding=f"is missing for data[{index}]")
        if not isinstance(own, Grading | UnknownStart):
            kind = type(own).__name__
            raise TypeError(f"start is a {kind}; it must be a Grading (Grading.read reads a file) or an UnknownStart")
        sd = np.asarray(error if datum.error is None else datum.error, dtype=np.float64)
        if sd.ndim and sd.shape != datum.size.shape:
            rule = f"give one number, or one for each of the {datum.size.size} sieves"
            raise parameter_error("error", sd.shape, rule, finding=f"of data[{index}] has shape {sd.shape}")
        sd = np.broadcast_to(sd, datum.size.shape)
        if not np.all((sd > 0.0) & np.isfinite(sd)):
            raise parameter_error("error", float(sd[~(sd > 0.0)][0]), "it must be greater than 0 and finite")
        made.append(replace(datum, start=own, error=sd))
    unit = next((datum.unit for datum in made if datum.unit), "")
    return [_in_unit(datum, unit, index) for index, datum in enumerate(made)]


def _in_unit(datum: Measurement, unit: str, index: int) -> Measurement:
    """Take sieves and start of a datum to the unit of the data; a start that has none takes it."""
    start = datum.start
    if isinstance(start, Grading) and unit:
        if not start.unit:
            start = start.with_unit(unit)
        elif start.unit != unit and start.measured:
            curve = SizeCurve.of(start).in_unit(unit)
            start = Grading.from_sieves(curve.size, 100.0 * curve.finer, unit)
        elif start.unit != unit:
            rule = f"the data are in {unit}: make it in {unit} too"
            raise parameter_error("start", start.unit, rule, finding=f"of data[{index}] is in {start.unit}")
    if isinstance(start, Grading) and start.unit and not unit:
        rule = f"name their unit, unit='{start.unit}' for example"
        raise parameter_error("data", "", rule, finding=f"has sieves without a unit, and its start is in {start.unit}")
    if not unit or datum.unit == unit:
        return replace(datum, start=start)
    if not datum.unit:
        rule = f"name its unit, since others are in {unit}"
        raise parameter_error(f"data[{index}]", "", rule, finding="has sieves without a unit")
    size = np.array([convert(float(size), datum.unit, unit) for size in datum.size])
    return replace(datum, start=start, size=size, unit=unit)

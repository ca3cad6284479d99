"""Grading curves as points, measured, ideal or crushed alike; every index is computed from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Grading,
    LogGrid,
    Place,
    PointMass,
    ResolvedGrid,
    _curve_on_grid,
    _finer_than,
    _first_at_least,
)
from comminute.gradings.sieves import convert, sieve_sizes, unit_of
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error

if TYPE_CHECKING:
    from collections.abc import Sequence

Floats = npt.NDArray[np.float64]
ENDS_AT_ONE = 1e-6  # largest distance of the last value of a cdf from 1
ROUNDING = 1e-12  # rounding error of a curve, which is a sum: of its plateaus and of its last value, 1


class SieveTable(NamedTuple):
    """Grading on sieves, coarse to fine; `Grading.from_sieves` takes its first three fields.

    Attributes
    ----------
    size : ndarray (M,)
        Openings, in `unit`.
    percent_finer : ndarray (M,)
        Per cent of the mass that passes each.
    unit : str
        Unit of the openings.
    percent_retained : ndarray (M,)
        Per cent of the mass that stays on each.
    pan : float
        Per cent of the mass that passes all.
    """

    size: Floats
    percent_finer: Floats
    unit: str
    percent_retained: Floats
    pan: float

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        return same_values(self, other) if isinstance(other, SieveTable) else NotImplemented

    def __ne__(self, other: object) -> bool:
        """Different in a number; a tuple's own comparison cannot ask arrays."""
        return not self == other

    def __hash__(self) -> int:
        """Raise TypeError: the table holds arrays, which have no hash."""
        raise TypeError("a SieveTable holds arrays; it has no hash")


@dataclass(frozen=True, eq=False, repr=False)
class SizeCurve:
    """Points of a grading curve F(d), linear in ln d between them.

    Attributes
    ----------
    size : ndarray (M,)
        Sizes > 0 in ascending order; two equal sizes are a jump (a point mass).
    finer : ndarray (M,)
        Mass fraction finer than each size, never falling, the last 1.
    unit : str
        Unit of the sizes; empty where they are relative.
    tail_slope : float
        Exponent of the curve below its finest point, F = finer[0] (d / size[0])**tail_slope; used where finer[0] > 0.

    Examples
    --------
    >>> import comminute as cm
    >>> curve = cm.SizeCurve.of(cm.Grading.from_sieves([2, 1, 0.5], [100, 60, 0]))
    >>> curve.size, curve.finer
    (array([0.5, 1. , 2. ]), array([0. , 0.6, 1. ]))
    """

    size: Floats
    finer: Floats
    unit: str = ""
    tail_slope: float = 0.0

    @classmethod
    def of(cls, grading: Grading | SizeCurve) -> SizeCurve:
        """Curve of a grading: its sieves or point masses as they are, a law at sizes evenly spaced in ln d.

        Raises
        ------
        TypeError
            For any other object; a result gives its curves by `Result.curve`.
        """
        if isinstance(grading, SizeCurve):
            return grading
        if not isinstance(grading, Grading):
            kind = type(grading).__name__
            raise TypeError(f"a {kind} is no grading; give a Grading or a SizeCurve (result.curve(k) makes one)")
        size, finer, tail_slope = grading._points()
        return cls(size, finer, grading.unit, tail_slope)

    @classmethod
    def on_grid(
        cls,
        grid: LogGrid | ResolvedGrid,
        cdf: Floats,
        unit: str = "",
        points: Sequence[PointMass] = (),
        largest: float = 0.0,
    ) -> SizeCurve:
        """Curve of a cdf at the upper edges of a grid's bins.

        The share in the fines bin continues as a power law through the two finest edges.

        Parameters
        ----------
        grid : LogGrid or ResolvedGrid
        cdf : ndarray (N,)
            Fraction finer than the upper edge of each bin.
        unit : str
            Unit of the sizes.
        points : sequence of PointMass
            Exact sizes that are part of `cdf`, fine to coarse: the curve jumps there, inside their bins, or of a
            ResolvedGrid at their upper edges.
        largest : float
            Size that no grain exceeds: the curve ends there where it lies in the coarsest bin that holds mass; 0 where
            it is not known. A ResolvedGrid ends at the largest grain, and needs none.

        Returns
        -------
        SizeCurve

        Raises
        ------
        ParameterError
            For a cdf that falls or does not end at 1.
        """
        falls = np.diff(cdf) < -ROUNDING
        if np.any(falls):
            k = int(np.argmax(falls))
            finding = f"is {cdf[k + 1]:g}, less than {cdf[k]:g} before it"
            place = Place("cdf", [k + 1])
            raise parameter_error("cdf", float(cdf[k + 1]), "a cdf cannot fall", finding=finding, place=place)
        if not abs(cdf[-1] - 1.0) <= ENDS_AT_ONE:
            raise parameter_error("cdf", float(cdf[-1]), "it must be 1", subject="the last cdf")
        if isinstance(grid, ResolvedGrid):
            size, finer, tail_slope = _curve_of_nodes(grid, cdf, points)
        else:
            size, finer, tail_slope = _curve_on_grid(grid, np.ascontiguousarray(cdf), points, largest)
        return cls(size, np.append(finer[:-1], 1.0), unit, tail_slope)

    def __eq__(self, other: object) -> bool:
        """Equal in every point."""
        if not isinstance(other, SizeCurve):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"<SizeCurve: {self.size.size} points, {self.size[0]:.4g} to {self.size[-1]:.4g}{unit}>"

    def in_unit(self, unit: str) -> SizeCurve:
        """Give the same curve with sizes in another unit.

        Raises
        ------
        ParameterError
            For sizes without a unit, and for a unit that is not known.

        Examples
        --------
        >>> import comminute as cm
        >>> cm.SizeCurve.of(cm.Grading.from_sieves([2, 1], [100, 0])).in_unit("um").size
        array([1000., 2000.])
        """
        sizes = np.array([convert(float(size), self.unit, unit) for size in self.size])
        return SizeCurve(sizes, self.finer, unit_of(unit), self.tail_slope)

    def finer_than(self, size: float | Sequence[float] | Floats) -> Floats:
        """Mass fraction of grains no larger than `size`, as an array of its shape."""
        at = np.asarray(size, dtype=np.float64)
        if np.any(~(at > 0.0)):
            raise parameter_error("size", float(at[~(at > 0.0)].flat[0]), "it must be greater than 0")
        return np.asarray(_finer_than(self.numbers, at))

    @property
    def numbers(self) -> tuple[Floats, Floats, float]:
        """Sizes, fractions finer, and slope of the tail, as the core takes them."""
        return self.size, self.finer, self.tail_slope

    def percentile(self, percent: float, *, extrapolate: bool = False) -> float:
        """Size D_x such that `percent` of the mass is finer: inf{d : F(d) >= percent / 100}.

        Where the curve has a plateau at that value, D_x is the plateau's lower end.

        Parameters
        ----------
        percent : float
            Per cent of the mass, in [0, 100].
        extrapolate : bool
            Continue below the finest point, along the tail.

        Returns
        -------
        float
            Size, in `unit`.

        Raises
        ------
        ParameterError
            If D_x lies below the finest point.

        Examples
        --------
        >>> import comminute as cm
        >>> cm.SizeCurve.of(cm.Grading.from_sieves([4, 1], [100, 0])).percentile(50)
        2.0
        """
        if not 0.0 <= percent <= 100.0:
            raise parameter_error("percent", float(percent), "it must be between 0 and 100")
        share = percent / 100.0
        if share >= self.finer[0] - ROUNDING or (extrapolate and share > 0.0 and self.tail_slope > 0.0):
            return _first_at_least(self.numbers, share)
        raise parameter_error(
            "percent",
            float(percent),
            subject=f"D{percent:g}",
            finding=f"lies below {self.finest()}, which {100 * self.finer[0]:.4g} % are finer than",
            rule="the curve is flat there and has no tail to follow" if extrapolate else "",
            remedy="" if extrapolate else "extrapolate",
        )

    def finest(self) -> str:
        """Name the finest size with its number and unit, for errors."""
        unit = f" {self.unit}" if self.unit else ""
        return f"the finest size of the curve, {self.size[0]:.4g}{unit}"

    def to_sieves(self, sieves: str | Sequence[float] | Floats) -> SieveTable:
        """Per cent finer and retained on sieves, coarse to fine; see `Grading.to_sieves`."""
        return on_sieves(self, sieves)

    def number_finer(self, smallest: float | None = None) -> SizeCurve:
        """Convert to a curve by number: fraction of the grains, counted, finer than each size.

        Mass is even in ln d between points, and a grain's mass goes with its size cubed, so that
        N(> s) is proportional to the integral of s**-3 dF.

        Parameters
        ----------
        smallest : float, optional
            Size below which grains are not counted. Needed where the tail has no end, since it holds infinitely many.

        Raises
        ------
        ParameterError
            For a tail without an end where `smallest` is not given.

        Examples
        --------
        >>> import comminute as cm
        >>> cm.SizeCurve.of(cm.gap_graded(1.0, 0.1)).number_finer().finer.round(4)
        array([0.   , 0.999, 0.999, 1.   ])
        """
        size, finer = self.size, self.finer
        if smallest is not None:
            keep = size > smallest
            finer = np.append(self.finer_than(smallest), finer[keep])
            size = np.append(smallest, size[keep])
        elif finer[0] > 0.0:
            raise parameter_error(
                "smallest",
                subject=f"{100 * finer[0]:.4g} % of the mass",
                finding=f"is finer than {size[0]:.4g}, without an end, and so is the number of grains",
                remedy="count_from_smallest",
            )
        relative = size / size[-1]
        counts = np.diff(finer) * mean_power(relative, -3.0)
        number = np.append(0.0, np.cumsum(counts))
        if number.size < 2 or not number[-1] > 0.0:
            raise parameter_error("smallest", smallest, f"it must be below the largest size, {size[-1]:g}")
        return SizeCurve(size, number / number[-1], self.unit)


def _curve_of_nodes(grid: ResolvedGrid, cdf: Floats, points: Sequence[PointMass]) -> tuple[Floats, Floats, float]:
    """Points of a cdf at the edges of uneven bins, up to the first that holds all, and the slope of the tail."""
    edges, finer = grid.edges, np.maximum.accumulate(np.asarray(cdf, dtype=np.float64))
    with np.errstate(divide="ignore"):
        slope = float(np.log(finer[1] / finer[0]) / (edges[2] - edges[1])) if finer[0] > 0.0 else 0.0
    whole = int(np.argmax(finer >= finer[-1] - ROUNDING)) + 1
    size, finer = np.exp(edges[1 : whole + 1]), finer[:whole]
    jumps = [(k, point) for point in points if (k := int(np.argmin(np.abs(edges[1:] - point.psi)))) < whole]
    at = [k for k, _ in jumps]
    below = [finer[k] - point.mass for k, point in jumps]
    size[at] = [point.size for _, point in jumps]
    return np.insert(size, at, size[at]), np.insert(finer, at, below), slope


def mean_power(size: Floats, power: float) -> Floats:
    """Mean of size**power over each interval of a curve, where mass is even in ln(size)."""
    low, high = size[:-1], size[1:]
    span = np.log(high / low)
    exact = np.divide(high**power - low**power, power * span, out=low**power, where=span > 1e-8)
    return np.asarray(exact)


def on_sieves(self: Grading | SizeCurve, sieves: str | Sequence[float] | Floats) -> SieveTable:
    """Per cent finer and retained on sieves, coarse to fine.

    Parameters
    ----------
    sieves : str or sequence of float
        A series, "ISO R20/3", "ISO R40/3" or "ASTM E11" (the part of it that the grading covers), or
        openings in the unit of the curve.

    Returns
    -------
    SieveTable
        Named tuple size, percent_finer, unit, percent_retained, pan.

    Raises
    ------
    ParameterError
        For grains that stay on the coarsest sieve, or a series for sizes without a unit.

    Examples
    --------
    >>> import comminute as cm
    >>> table = cm.fuller(16.0).with_unit("mm").to_sieves([16, 4, 1])
    >>> table.percent_finer, table.pan
    (array([100.,  50.,  25.]), 25.0)
    """
    named = isinstance(sieves, str)
    openings = sieve_sizes(sieves, self.unit) if isinstance(sieves, str) else np.asarray(sieves, dtype=np.float64)
    openings = np.sort(openings)[::-1]
    if openings.ndim != 1 or openings.size == 0 or np.any(np.diff(openings) == 0.0):
        finding = f"has shape {openings.shape}"
        raise parameter_error("sieves", openings.shape, "it must be a list of different openings", finding=finding)
    largest = self.largest if isinstance(self, Grading) else float(self.size[-1])
    unit = f" {self.unit}" if self.unit else ""
    if openings[0] < largest * (1.0 - ROUNDING):
        raise parameter_error(
            "sieves",
            float(openings[0]),
            "take a series that reaches it, or a list of openings" if named else "add a sieve that it passes",
            subject=f"the largest grain, {largest:.6g}{unit},",
            finding=f"stays on the coarsest sieve, {openings[0]:.6g}{unit}",
        )
    finer = 100.0 * np.asarray(self.finer(openings) if isinstance(self, Grading) else self.finer_than(openings))
    finer[openings >= largest * (1.0 - ROUNDING)] = 100.0
    # a whole series is cut to the part that tells something: from one sieve that all pass to one that nothing passes
    first = int(np.flatnonzero(finer == 100.0)[-1]) if named else 0
    nothing = np.flatnonzero(finer == 0.0)
    last = int(nothing[0]) + 1 if named and nothing.size else openings.size
    openings, finer = openings[first:last], finer[first:last]
    retained = np.append(100.0 - finer[0], finer[:-1] - finer[1:])
    return SieveTable(openings, finer, self.unit, retained, float(finer[-1]))

"""Results of a run: plain NumPy, one row per load."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from comminute._core import (
    Fabric,
    LogGrid,
    Material,
    PointMass,
    SolveReport,
    StepReport,
    __version__,
    percentile,
)
from comminute.gradings.curves import SizeCurve
from comminute.runs.recipe import Recipe
from comminute.util.equality import same_values
from comminute.util.errors import parameter_error
from comminute.util.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]


def needs(extra: str, library: str, wanted_for: str) -> ImportError:
    """Exception for an optional library that is missing: what for, and how to get it."""
    return ImportError(f"{wanted_for} needs {library}; install it with: pip install 'comminute[{extra}]'")


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """What a load path did to a grading: T loads, N bins.

    Attributes
    ----------
    material : Material
    grid : LogGrid
    start : Fabric
        Before the first load.
    unit : str
        Of the sizes; empty where they are relative.
    stress_ratio : ndarray (T,)
        Loads.
    stress : ndarray (T,) or None
        The same as stresses, where first_crush_stress is known.
    pmf : ndarray (T, N)
        Mass by bin after each load; exact sizes are in their bins.
    crushes : ndarray (T,)
        Mean number of crushes a cell has been through since the start (crushes in psi; those whose
        fragment stays in its bin are counted).
    mass_error : ndarray (T,)
        Total mass less 1.
    engine : str
        What ran.
    scheme : str
        How the continuum became bins; see `QuasiStatic`.
    notes : tuple of str
        What was assumed or may surprise, in plain words.
    warnings : tuple of str
        Where the curves are not to be trusted.
    fabrics : tuple of Fabric or None
        Kept fabrics, one entry per load; see `fabric`.
    points : tuple of tuple of PointMass
        For each load, what of the mass is still at an exact size, fine to coarse: there the cdf jumps.
    reports : tuple of SolveReport or StepReport
        For each load, what its engine says: of the solve from the last kept fabric, or of the steps.
    recipe : Recipe or None
        What the run was asked for, to resume it or run it again.

    Examples
    --------
    >>> import comminute as cm
    >>> result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8, 100])
    >>> result.cdf.shape == (3, result.psi.size)
    True
    >>> bool(abs(result.mass_error).max() < 1e-13)
    True
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
    reports: tuple[SolveReport | StepReport, ...] = field(default=())
    recipe: Recipe | None = None

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

        Mass in a bin is even in ln d between its edges, so D100 is the upper edge of the coarsest bin that holds
        mass (more than 1e-12 of it): above the largest grain, but by less than a bin. Where only an exact size is
        left there, as in a gap-graded packing before its coarse grains crush, D100 is that size.

        Parameters
        ----------
        percent : float
            In [0, 100].
        extrapolate : bool
            Continue a curve that ends in the fines bin as a power law.

        Returns
        -------
        ndarray (T,)

        Raises
        ------
        ParameterError
            If D_x lies in the fines bin after some load.
        """
        points = self.points or ((),) * len(self.pmf)
        sizes = [
            percentile(self.grid, finer, percent, extrapolate=extrapolate, points=exact)
            for finer, exact in zip(self.cdf, points, strict=True)
        ]
        return np.array(sizes)

    def curve(self, k: int = -1) -> SizeCurve:
        """Grading curve after load k, for the indices (`comminute.uniformity` and so on).

        Parameters
        ----------
        k : int

        Returns
        -------
        SizeCurve
            With its jumps where sizes are exact.

        Examples
        --------
        >>> import comminute as cm
        >>> curve = cm.Simulation(cm.Material(), cm.monodisperse(1.0)).run(stress_ratio=1.0).curve()
        >>> without, including = curve.finer[curve.size == 1.0]
        >>> float((including - without).round(12))
        0.5
        """
        exact = self.points[k] if self.points else ()
        return SizeCurve.on_grid(self.grid, np.cumsum(self.pmf[k]), self.unit, exact)

    @property
    def start_curve(self) -> SizeCurve:
        """Grading curve before the first load, on the same grid."""
        return SizeCurve.on_grid(self.grid, self.start.cdf(), self.unit, self.start.points)

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

    def __eq__(self, other: object) -> bool:
        """Equal in every number and setting."""
        if not isinstance(other, Result):
            return NotImplemented
        return type(self) is type(other) and same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        loads = f"{self.stress_ratio.size} loads up to {self.stress_ratio.max():g}"
        what = f"engine {self.engine}, {self.crushes[-1]:.3g} crushes a cell"
        return f"<Result: {loads}, {self.grid.bins} bins, {what}>"

    def to_xarray(self) -> Any:
        """Dataset with dims load, psi and psibar; needs xarray.

        Returns
        -------
        xarray.Dataset
            Variables pmf, cdf (load, psi), crushes, fines, mass_error (load), start_fabric (psi, psibar),
            fabric (fabric_load, psi, psibar) and settled_at for the kept ones; coordinates stress_ratio,
            stress, psi, psibar, size, edge_size; everything else as attributes.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        from comminute.files import storage  # noqa: PLC0415  (it stands on this module)

        return storage.to_dataset(self)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a file, complete or not at all: NetCDF with all there is, or the arrays alone as .npz.

        Parameters
        ----------
        path : path-like
            Ends in .nc or .npz; an existing file is replaced.

        Returns
        -------
        Path

        Raises
        ------
        ParameterError
            For another ending.
        ImportError
            Naming the extra to install, for .nc.

        Notes
        -----
        From an .nc file `open_result` makes an equal result. An .npz file has the arrays of this class by
        name, the fabric after the last kept load as `fabric` (N, N) with all its mass in bins, and `engine`,
        `scheme`, `unit`, `material` and `version` as text.
        """
        target = Path(path)
        if target.suffix == ".nc":
            from comminute.files import storage  # noqa: PLC0415  (it stands on this module)

            return storage.save_netcdf(self, target)
        if target.suffix != ".npz":
            raise parameter_error("path", f"'{target}'", "it must end in .nc or .npz")
        names = ("stress_ratio", "psi", "size", "edge_size", "pmf", "cdf", "crushes", "fines", "mass_error")
        arrays: dict[str, Any] = {name: getattr(self, name) for name in names}
        if self.stress is not None:
            arrays["stress"] = self.stress
        kept = [fabric for fabric in self.fabrics if fabric is not None]
        if kept:
            arrays["fabric"] = kept[-1].binned().probability
        texts = {"engine": self.engine, "scheme": self.scheme, "unit": self.unit}
        texts |= {"material": repr(self.material), "version": __version__}
        arrays |= {name: np.array(text) for name, text in texts.items()}

        def write(file: Path) -> None:
            with file.open("wb") as stream:  # given a name, NumPy would add its own ending
                np.savez_compressed(stream, **arrays)

        return write_whole(target, write)

    def resume(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: float | Iterable[float] | None = None,
        loading_rate: float | Iterable[float] = 0.0,
        remix_after: Iterable[int] = (),
        keep_fabrics: Literal["all", "last"] | Sequence[int] = "all",
        on_load: Callable[[int], object] | None = None,
    ) -> Result:
        """Go on from the last load, on the same grid and with the same engine and scheme.

        Parameters
        ----------
        stress_ratio, stress, loading_rate, keep_fabrics, on_load
            As for `Simulation.run`, of the loads to come.
        remix_after : sequence of int
            Indices of the loads to come, from 0.

        Returns
        -------
        Result
            All loads, the old and the new: equal to one run through all of them on this grid, in every bit where
            that run and this result keep all fabrics, so that every load starts from the fabric after the one
            before. A run that keeps fewer solves from the last one that it kept: equal to rounding, some 1e-15.

        Raises
        ------
        ParameterError
            If the last fabric was not kept, or for loads outside their range.
        Interrupted
            On Ctrl-C; its `result` has the finished loads.

        Examples
        --------
        >>> import comminute as cm
        >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0), grid=cm.LogGrid(-6.0, 0.0, 121))
        >>> sim.run(stress_ratio=[1, 2]).resume(stress_ratio=[8]) == sim.run(stress_ratio=[1, 2, 8])
        True
        """
        from comminute.runs import continuing  # noqa: PLC0415  (it stands on this module)

        return continuing.resume(
            self,
            stress_ratio,
            stress=stress,
            loading_rate=loading_rate,
            remix_after=remix_after,
            keep_fabrics=keep_fabrics,
            on_load=on_load,
        )

    def slider(self) -> Any:
        """Grading curves and fabric with a slider over the kept loads, for notebooks; needs ipywidgets.

        Returns
        -------
        ipywidgets.VBox

        Raises
        ------
        ImportError
            Naming the extra to install.
        ParameterError
            If no fabric was kept.
        """
        try:
            from comminute.plotting import everyday as everyday_plots  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("notebook", "matplotlib and ipywidgets", "slider") from error
        return everyday_plots.slider(self)

    def plot(self, load: int = -1) -> Figure:
        """Grading curves of all loads beside the fabric after one of them; needs matplotlib.

        Parameters
        ----------
        load : int
            Index of the load whose fabric is drawn.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute import plotting  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plotting.plot_result(self, load)

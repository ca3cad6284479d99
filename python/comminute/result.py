"""Results as their users meet them: the data of a run, with files, plots, and the way to go on or run again."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self, TypeVar, Unpack

from comminute._core import Fabric, ResolvedGrid
from comminute.files.arrays import save_npz
from comminute.files.storage import save_netcdf, to_dataset
from comminute.files.tables import INDICES, Table, grading_table, load_table, result_curves, write_workbook
from comminute.result_views import ResultViews
from comminute.runs.continuing import again, fabric_after, resumed
from comminute.runs.load_path import AxialStress, Keep, Stress, load_path, wanted_fabrics
from comminute.runs.outcomes import Outcome
from comminute.runs.path_run import PathRun
from comminute.runs.results import LatticeData, ResolvedData
from comminute.util.errors import parameter_error
from comminute.util.keywords import suggests_keywords

R = TypeVar("R", bound="Result")
O = TypeVar("O", bound=Outcome)  # noqa: E741  (an outcome, with what its engine adds)

WRITERS = {".nc": save_netcdf, ".npz": save_npz}


@dataclass(frozen=True, eq=False, repr=False)
class Result(ResultViews):
    """Gradings of a packing along a load path: T loads, N bins.

    Attributes
    ----------
    material : Material
    grid : LogGrid
    start : Fabric
        Fabric before the first load.
    unit : str
        Unit of the sizes; empty where they are relative.
    stress_ratio : ndarray (T,)
        Loads.
    stress : ndarray (T,) or None
        Loads as stresses that are quoted as first_crush_stress is, where that is known.
    pmf : ndarray (T, N)
        Mass by bin after each load; exact sizes are in their bins.
    crushes : ndarray (T,)
        Mean number of crushes a cell has been through since the start (crushes in psi; those whose
        fragment stays in its bin are counted).
    mass_error : ndarray (T,)
        Total mass less 1.
    engine : str
        Engines that ran.
    scheme : str
        Scheme by which the continuum became bins; see `QuasiStatic`.
    notes : tuple of str
        Assumptions that were made and loads that may surprise, in plain words.
    warnings : tuple of str
        Sizes at which the curves are not to be trusted, and why.
    fabrics : tuple of Fabric or None
        Kept fabrics, one entry per load; see `fabric`.
    points : tuple of tuple of PointMass
        For each load, the mass that still has an exact size, fine to coarse: there the cdf jumps.
    reports : tuple of SolveReport or StepReport
        For each load, the account of its engine: of the solve from the start or the last remixing, or of the steps.
    recipe : Recipe or None
        Settings of the run, to resume it or run it again.
    measured : SizeCurve or None
        Sieve data of the start; the curve of a load bends at its sieves wherever no grain has crushed.

    Examples
    --------
    >>> import comminute as cm
    >>> result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8, 100])
    >>> result.cdf.shape == (3, result.psi.size)
    True
    >>> bool(abs(result.mass_error).max() < 1e-13)
    True
    """

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
        return to_dataset(self)

    def grading_table(self, sieves: str | Sequence[float] | None = None) -> Table:
        """Tabulate the per cent finer on sieves, at the start and after each load.

        Parameters
        ----------
        sieves : str or sequence of float, optional
            Series by name ("ISO R20/3"), or openings. Left out, those of a measured start, else the edges of the bins.

        Raises
        ------
        ParameterError
            For sieves that are none.
        """
        if sieves is None:
            sieves = list(self.measured.size if self.measured is not None else self.edge_size)
        return grading_table(result_curves(self), sieves)

    def load_table(self, indices: Sequence[str] = INDICES) -> Table:
        """Tabulate indices by load: sizes such as "D90", "Cu", "Cc", "B", "Br", "fines", "crushes".

        Raises
        ------
        ParameterError
            For a name it does not know.

        Examples
        --------
        >>> import comminute as cm
        >>> sand = cm.fuller(2.0).with_unit("mm")
        >>> run = cm.Simulation(cm.Material(reference_size=2.0, fabric_width=0.3), sand).run(stress_ratio=20.0)
        >>> run.load_table(["D50", "Br"]).columns
        ('stress ratio', 'D50 (mm)', 'Br')
        """
        return load_table(self, indices)

    def to_pandas(self, indices: Sequence[str] = INDICES) -> Any:
        """DataFrame of `load_table`, by load; `grading_table().to_pandas()` has the gradings. Needs pandas.

        Raises
        ------
        ParameterError
            For a name it does not know.
        ImportError
            Naming the extra to install.
        """
        return self.load_table(indices).to_pandas()

    def to_csv(self, path: str | os.PathLike[str], sieves: str | Sequence[float] | None = None) -> Path:
        """Write `grading_table` to a file with commas, complete or not at all.

        Raises
        ------
        ParameterError
            For sieves that are none.
        """
        return self.grading_table(sieves).to_csv(path)

    def to_excel(
        self,
        path: str | os.PathLike[str],
        sieves: str | Sequence[float] | None = None,
        indices: Sequence[str] = INDICES,
    ) -> Path:
        """Write a workbook with the sheets "gradings" and "loads", complete or not at all; needs openpyxl.

        Raises
        ------
        ParameterError
            For sieves or a name that are none.
        ImportError
            Naming the extra to install.
        """
        return write_workbook({"gradings": self.grading_table(sieves), "loads": self.load_table(indices)}, path)

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
            For a path with another ending.
        ImportError
            Naming the extra to install, for .nc.

        Notes
        -----
        An .nc file gives back an equal result, through `open_result`. An .npz file has the arrays of this class by
        name, the fabric after the last kept load as `fabric` (N, N) with all its mass in bins, and `engine`,
        `scheme`, `unit`, `material` and `version` as text.
        """
        target = Path(path)
        if target.suffix not in WRITERS:
            raise parameter_error("path", f"'{target}'", "it must end in .nc or .npz")
        return WRITERS[target.suffix](self, target)

    @suggests_keywords
    def resume(
        self,
        stress_ratio: float | Iterable[float] | None = None,
        *,
        stress: Stress | None = None,
        loading_rate: float | Iterable[float] = 0.0,
        remix_after: Iterable[int] = (),
        keep_fabrics: Keep = "auto",
        on_load: Callable[[int], object] | None = None,
        **axial: Unpack[AxialStress],
    ) -> Self:
        """Go on from the last load, on the same grid and with the same engine and scheme.

        Parameters
        ----------
        stress_ratio, stress, p, q, vertical, k0, loading_rate, keep_fabrics, on_load
            Loads to come; see `Simulation.run`.
        remix_after : sequence of int
            Indices of the loads to come, from 0.

        Returns
        -------
        Result
            All loads, the old and the new: equal in every bit to one run through all of them on this grid, whichever
            fabrics are kept.

        Raises
        ------
        ParameterError
            For loads outside their range, or a result that does not say how it was made.
        Interrupted
            On Ctrl-C; its `result` has the finished loads.

        Examples
        --------
        >>> import comminute as cm
        >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0), grid=cm.LogGrid(-6.0, 0.0, 121))
        >>> sim.run(stress_ratio=[1, 2]).resume(stress_ratio=[8]) == sim.run(stress_ratio=[1, 2, 8])
        True
        """
        later = load_path(self.material, stress_ratio, stress, loading_rate, remix_after, **axial)
        wanted = wanted_fabrics(keep_fabrics, later.stress_ratio.size, self.grid.bins)
        return finished(resumed(self, later, wanted), on_load)

    def fabric(self, k: int) -> Fabric:
        """Fabric after load k (before the remixing, where load k is followed by one).

        One that was not kept is computed again, to the same bits; see `keep_fabrics` of `Simulation.run`.

        Parameters
        ----------
        k : int
            Index of the load.

        Returns
        -------
        Fabric

        Raises
        ------
        ParameterError
            If that fabric was not kept, and this is the result of a lattice or does not say how it was made.
        IndexError
            If there is no load k.

        Examples
        --------
        >>> import comminute as cm
        >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0), grid=cm.LogGrid(-6.0, 0.0, 61))
        >>> lean, full = (sim.run([1, 8], keep_fabrics=keep) for keep in ([], "all"))
        >>> lean.fabrics, lean.fabric(0) == full.fabric(0)
        ((None, None), True)
        """
        if self.fabrics[k] is None and self.recipe is not None:
            return fabric_after(self, range(len(self.fabrics))[k])
        return super().fabric(k)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LatticeResult(Result, LatticeData):
    """Gradings of a lattice along a load path: a `Result` whose numbers are means over replicas.

    Attributes
    ----------
    cells, replicas, seed : int
        Size of a ring, number of rings, and seed of their random number generator.
    cdf_error : ndarray (T, N)
        Standard error of `cdf` from the scatter of the replicas; NaN with a single one.
    crushes_error : ndarray (T,)
        Standard error of `crushes`.
    start_points : tuple of PointMass
        Mass at the exact sizes of the start, where these are few, fine to coarse.

    Examples
    --------
    >>> import comminute as cm
    >>> lattice = cm.Lattice(10_000, cm.Material(), cm.gap_graded(1.0, 0.1), replicas=4)
    >>> result = lattice.run(stress_ratio=[1, 100])
    >>> result.cdf.shape == result.cdf_error.shape
    True
    """


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ResolvedResult(Result, ResolvedData):
    """Gradings by the law of three adjacent cells along a load path: a `Result` on bins of uneven width.

    Its `fabric` is computed when it is asked for, on even bins, and none is kept.

    Attributes
    ----------
    grid : ResolvedGrid
        Sizes that the law tells apart; `pmf` has a column for each of its bins, an exact size being part of the bin
        that ends there.
    grading : Grading
        Start, of which the packing was a random mixture.
    start : Fabric
        That mixture, on even bins.
    avalanches : ndarray (T,)
        Avalanches a cell has begun since the start: crushes by the load, not by a neighbour's crush.
    step_error : ndarray (T,)
        Largest difference of the coarse and the fine curve, several times the error of `cdf` by the steps.

    Examples
    --------
    >>> import comminute as cm
    >>> sim = cm.Simulation(cm.Material(), cm.monodisperse(1.0), closure="resolved")
    >>> result = sim.run(stress_ratio=[1, 8])
    >>> result.points[0][0].mass.__round__(4)  # random sequential adsorption: (1 + exp(-2)) / 2
    0.5677
    >>> result.closure, result.closure_error
    ('resolved', 0.0036)
    """

    grid: ResolvedGrid  # type: ignore[assignment]  # as of `ResolvedData`


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `result` has the loads that were finished (None if there are none)."""

    def __init__(self, result: Result | None) -> None:
        done = 0 if result is None else len(result.stress_ratio)
        super().__init__(f"interrupted after {done} finished loads; they are in .result")
        self.result = result

    def __reduce__(self) -> tuple[type[Interrupted], tuple[Result | None]]:
        """Pickle by the result; an exception's own pickle has its message alone."""
        return Interrupted, (self.result,)


def finished(run: PathRun[O, R], on_load: Callable[[int], object] | None = None) -> R:
    """Take a run to its end, and give its result.

    Parameters
    ----------
    run : PathRun
    on_load : callable, optional
        Called with the index of each load that is finished, counted from the first one of this run.

    Returns
    -------
    Result

    Raises
    ------
    Interrupted
        On Ctrl-C; its `result` has the finished loads.
    """
    try:
        for index, _ in enumerate(run):
            if on_load is not None:
                on_load(index)
    except KeyboardInterrupt:
        raise Interrupted(run.result()) from None
    result = run.result()
    assert result is not None  # a path has at least one load
    return result


def run_again(result: R) -> R:
    """Run a result again from its start, material and recipe.

    Parameters
    ----------
    result : Result

    Returns
    -------
    Result
        Equal to it in every bit, on the same machine and build.

    Raises
    ------
    ParameterError
        If the result does not say how it was made.

    Examples
    --------
    >>> import comminute as cm
    >>> result = cm.Simulation(cm.Material(), cm.gap_graded(1.0, 0.1)).run(stress_ratio=[1, 8])
    >>> cm.run_again(result) == result
    True
    """
    return replace(finished(again(result)), notes=result.notes, warnings=result.warnings)

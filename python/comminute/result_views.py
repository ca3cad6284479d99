"""Results looked at beside something else, or in pictures: void ratios, other models, plots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from comminute._core import Grading
from comminute.comparators.comparison import ModelComparison
from comminute.gradings.curves import SizeCurve
from comminute.packing.models import Model as PackingModel
from comminute.packing.models import PackingOptions, calibrate, void_ratio
from comminute.runs.results import Floats, ResultData
from comminute.util.errors import parameter_error
from comminute.util.optional import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class ResultViews(ResultData):
    """Void ratios, comparisons and pictures of a result; see `Result`."""

    def void_ratio(
        self,
        initial: float | None = None,
        model: PackingModel = "cpm",
        **how: Unpack[PackingOptions],
    ) -> Floats:
        """Void ratio of the mixed packing after each load: crushing-induced densification.

        Parameters
        ----------
        initial : float, optional
            Measured void ratio of the start, to which the packing of single sizes is calibrated.
        model : {"cpm", "lpm", "linear-mixture", "rods"}
            Packing model; see `comminute.packing.solid_fraction`.
        **how
            `packing`, in place of a calibration, `compaction`, `classes` and `rods`, as
            `comminute.packing.solid_fraction` takes them. With neither a void ratio nor a packing it is the mere
            default of the model.

        Returns
        -------
        ndarray (T,)

        Raises
        ------
        ParameterError
            For a void ratio that no packing gives, or both of a void ratio and a packing.

        Examples
        --------
        >>> import comminute as cm
        >>> sand = cm.Material(fabric_width=0.2)
        >>> run = cm.Simulation(sand, cm.monodisperse(1.0)).run(stress_ratio=[1.0, 10.0, 100.0])
        >>> run.void_ratio(initial=2 / 3).round(3)
        array([0.366, 0.311, 0.287])
        """
        if initial is not None:
            if "packing" in how:
                finding = "initial or packing, which is calibrated to it"
                raise parameter_error("packing", subject="give one of", finding=finding)
            how["packing"] = calibrate(self.start_curve, initial, model, **how)
        return np.array([void_ratio(self.curve(k), model, **how) for k in range(self.stress_ratio.size)])

    def plot_compression(
        self,
        initial: float | None = None,
        model: PackingModel = "cpm",
        *,
        measured: tuple[Sequence[float], Sequence[float]] | None = None,
        log_void_ratio: bool = False,
        **how: Unpack[PackingOptions],
    ) -> Figure:
        """Draw the void ratio against the load on a log scale, with measured points over it; needs matplotlib.

        Parameters
        ----------
        initial, model, **how
            As for `void_ratio`.
        measured : (loads, void ratios), optional
            Points to lay over it, their loads in the stresses of the result, or stress ratios where it has none.
        log_void_ratio : bool
            Draw the void ratio on a log scale too, on which a normal compression line is straight.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute.plotting.compression import plot_compression  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot_compression") from error
        found = self.void_ratio(initial, model, **how)
        start = initial if initial is not None else void_ratio(self.start_curve, model, **how)
        return plot_compression(self, start, found, model, measured=measured, log_void_ratio=log_void_ratio)

    def compare_with(
        self, others: Mapping[str, SizeCurve | Grading | Sequence[SizeCurve | Grading]]
    ) -> ModelComparison:
        """Lay curves of other models beside those of the loads.

        Parameters
        ----------
        others : mapping of str to sequence of SizeCurve
            Curves by name, one for each load, or one for all; `comminute.comparators` has older models.

        Returns
        -------
        ModelComparison
            Distances, and `plot`.

        Raises
        ------
        ParameterError
            For another number of curves, or another unit.

        Examples
        --------
        >>> import comminute as cm
        >>> start, loads = cm.fuller(1.0), [2.0, 20.0]
        >>> run = cm.Simulation(cm.Material(fabric_width=0.3), start).run(stress_ratio=loads)
        >>> models = {"size alone": cm.comparators.size_threshold(start, run.material, loads)}
        >>> bool(run.compare_with(models).distance("size alone")[1] > 0.3)
        True
        """
        return ModelComparison.of(self, others)

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
            from comminute.plotting.sliders import slider  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("notebook", "matplotlib and ipywidgets", "slider") from error
        return slider(self)

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
            from comminute.plotting.fabrics import plot_result  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plot_result(self, load)

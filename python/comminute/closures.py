"""The closures beside each other: the paper's two sizes, the resolved law of three cells, and the lattice of both."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from comminute._core import Grading, LogGrid, Material, Resolved
from comminute.gradings.curves import SizeCurve
from comminute.lattice.comparison import Comparison
from comminute.lattice.statistics import mean_and_error
from comminute.lattices import Lattice
from comminute.runs.load_path import Stress, load_path
from comminute.runs.remarks import load_text
from comminute.simulation import Simulation
from comminute.util.choices import Mean, Scheme
from comminute.util.equality import same_values

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]

NEAR = 0.01  # distance of the paper's closure to the lattice that few tests of a laboratory could tell
BESIDE = 1e-12  # distance in ln(size) to either side of an exact size


@dataclass(frozen=True, eq=False, repr=False)
class ClosureComparison:
    """Gradings of the two closures and of the lattice under the same loads; see `compare_closures`.

    Attributes
    ----------
    stress_ratio : ndarray (T,)
        Loads.
    size : ndarray (M,)
        Sizes of the curves, fine to coarse; of an exact size its left side comes before it.
    start : ndarray (M,)
        Mass fraction finer at the start.
    paper, resolved, lattice : ndarray (T, M)
        Mass fraction finer after each load.
    lattice_error : ndarray (T, M)
        Standard error of the lattice's curves.
    replicas : int
        Rings of the lattice.
    step_error : ndarray (T,)
        Difference of the coarse and the fine state of the resolved closure, which bounds its error by steps.
    unit : str
        Unit of the sizes, as text.

    Examples
    --------
    >>> import comminute as cm
    >>> found = cm.compare_closures(cm.Material(), cm.monodisperse(1.0), stress_ratio=1.0, cells=5_000)
    >>> found.paper.shape == found.resolved.shape == found.lattice.shape == (1, found.size.size)
    True
    >>> round(float(found.resolved[0, -2]), 4)  # the share of equal grains that has crushed
    0.4323
    """

    stress_ratio: Floats
    size: Floats
    start: Floats
    paper: Floats
    resolved: Floats
    lattice: Floats
    lattice_error: Floats
    replicas: int
    step_error: Floats
    unit: str = ""

    @property
    def distances(self) -> dict[str, Comparison]:
        """Distance of either closure to the lattice, by its name, with the noise and where it is largest."""
        none = np.zeros_like(self.lattice_error)
        return {
            name: Comparison.of(
                self.stress_ratio,
                self.size,
                (curves, self.lattice),
                (none, self.lattice_error),
                (1, self.replicas),
            )
            for name, curves in (("paper", self.paper), ("resolved", self.resolved))
        }

    @property
    def advice(self) -> str:
        """One sentence on which of the two to take."""
        found = self.distances
        paper, resolved = found["paper"], found["resolved"]
        far, worst = int(np.argmax(paper.distance)), float(resolved.distance.max())
        off = f"{paper.distance[far]:.2g} from the lattice at stress ratio {load_text(self.stress_ratio[far])}"
        noise = f"(noise {resolved.standard_error.max():.1g})"
        if paper.distance[far] <= NEAR:
            return f"The paper's closure will do: at most {off}, in a millisecond; the resolved {worst:.2g} {noise}."
        if worst >= paper.distance[far]:
            return f"Neither closure is near: the paper's is {off}, the resolved {worst:.2g} {noise}; take the lattice."
        return f"Take the resolved closure: it is {worst:.2g} from the lattice at most {noise}, the paper's {off}."

    def table(self) -> str:
        """Text with a line for each load: the distances of both closures, the noise, and the sizes they are at."""
        found = self.distances
        paper, resolved = found["paper"], found["resolved"]
        unit = f" {self.unit}" if self.unit else ""
        lines = [
            f"{'stress ratio':>12}{'paper':>9}{'at' + unit:>10}{'resolved':>10}{'at' + unit:>10}{'noise':>9}"
            f"{'step error':>12}"
        ]
        for k, load in enumerate(self.stress_ratio):
            lines.append(
                f"{load_text(load):>12}{paper.distance[k]:9.4f}{paper.size[k]:10.4g}{resolved.distance[k]:10.4f}"
                f"{resolved.size[k]:10.4g}{resolved.standard_error[k]:9.1e}{self.step_error[k]:12.1e}"
            )
        return "\n".join(lines)

    def plot(self) -> Figure:
        """Draw curves and distances; see `comminute.plotting.plot_closures`. Needs matplotlib."""
        from comminute.plotting import plot_closures  # noqa: PLC0415  (matplotlib is optional)

        return plot_closures(self)

    def __repr__(self) -> str:
        worst = {name: float(found.distance.max()) for name, found in self.distances.items()}
        return (
            f"<ClosureComparison: {self.stress_ratio.size} loads up to {load_text(self.stress_ratio.max())}, paper "
            f"{worst['paper']:.2g} and resolved {worst['resolved']:.2g} from the lattice>"
        )

    def __eq__(self, other: object) -> bool:
        """Equal in every number."""
        if not isinstance(other, ClosureComparison):
            return NotImplemented
        return same_values(vars(self).values(), vars(other).values())

    __hash__ = None  # type: ignore[assignment]


def compare_closures(
    material: Material,
    start: Grading,
    *,
    stress_ratio: float | Iterable[float] | None = None,
    stress: Stress | None = None,
    remix_after: Iterable[int] = (),
    mean: Mean = "arithmetic",
    grid: LogGrid | None = None,
    scheme: Scheme = "conservative",
    cells: int = 100_000,
    replicas: int = 4,
    seed: int = 0,
    threads: int = 1,
) -> ClosureComparison:
    """Take one packing through the same loads by the paper's closure, by the resolved one, and on the lattice.

    Parameters
    ----------
    material : Material
        With a finite fabric width.
    start : Grading
    stress_ratio, stress
        Loads, one of the two; see `Simulation.run`.
    remix_after : iterable of int
        Indices of the loads after which the packing is mixed anew.
    mean : {"arithmetic", "geometric"}
        How two neighbours make a neighbourhood grainsize.
    grid : LogGrid, optional
        Bins of the paper's closure; see `Simulation`.
    scheme : {"conservative", "paper"}
        Scheme of the paper's closure; see `Simulation`.
    cells, replicas, seed, threads : int
        The lattice has `cells` times `replicas` grains, and noise of about .5 / sqrt of that number.

    Returns
    -------
    ClosureComparison

    Raises
    ------
    ParameterError
        For loads, a material or a lattice that one of them cannot take.

    Examples
    --------
    >>> import comminute as cm
    >>> found = cm.compare_closures(cm.Material(), cm.monodisperse(1.0), stress_ratio=[1.0, 8.0], cells=20_000)
    >>> bool((found.distances["paper"].distance > 0.05).all())
    True
    >>> print(found.advice[:25])
    Take the resolved closure
    """
    path = load_path(material, stress_ratio, stress, 0.0, remix_after)
    law = Resolved(material, start, mean=mean)
    rings = Lattice(cells, material, start, replicas=replicas, seed=seed, threads=threads, mean=mean)
    simulation = Simulation(material, start, grid=grid, mean=mean, scheme=scheme)
    run = simulation.run(stress_ratio=path.stress_ratio, remix_after=sorted(path.remix_after), keep_fabrics=[])

    ends, next_exact = law.grid.upper, np.append(law.grid.exact[1:], False)
    log_size = np.where(next_exact, ends - BESIDE, ends + BESIDE)
    paper, resolved, lattice, lattice_error, step_error = [], [], [], [], []
    for load in path.loads():
        law.load_to(load.stress_ratio)
        rings.load_to(load.stress_ratio)
        sampled = np.array([np.searchsorted(np.sort(ring), log_size, side="right") for ring in rings.psi]) / cells
        mean_curve, error = mean_and_error(sampled)
        paper.append(run.curve(load.place).finer_than(np.exp(log_size)))
        resolved.append(law.cdf())
        lattice.append(mean_curve)
        lattice_error.append(error)
        step_error.append(law.step_error)
        if load.remixed:
            law.remix()
            rings.remix()
    return ClosureComparison(
        stress_ratio=path.stress_ratio,
        size=np.exp(log_size),
        start=SizeCurve.of(start).finer_than(np.exp(log_size)),
        paper=np.array(paper),
        resolved=np.array(resolved),
        lattice=np.array(lattice),
        lattice_error=np.array(lattice_error),
        replicas=replicas,
        step_error=np.array(step_error),
        unit=start.unit,
    )

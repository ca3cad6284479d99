"""Pictures for the command line. Needs matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from comminute import plotting
from comminute._core import ParameterError
from comminute.cli.messages import WORDS
from comminute.cli.stats import read_sieve_table, require_no_options
from comminute.opening import open_result
from comminute.plotting import everyday as everyday_plots
from comminute.util.errors import parameter_error, reworded
from comminute.util.whole_files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENDINGS = (".png", ".pdf", ".svg")
PLOT_WORDS = WORDS | {"extrapolate": "comminute stats --extrapolate follows the tail"}
INDICES = ("D50", "Cu", "B", "crushes")


def draw(file: Path, target: Path, *, what: str, load: int, table: dict[str, Any], **axes: Any) -> None:
    """Draw a sieve table or a result to a picture file, whole or not at all."""
    if what not in ("gradings", "fabric", "index"):
        raise parameter_error("--what", f"'{what}'", "it must be one of gradings, fabric, index")
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    if file.suffix != ".nc":
        if what != "gradings":
            finding = f"is '{what}', but {file.name} is a sieve table"
            raise parameter_error("--what", what, "it has gradings alone", finding=finding)
        everyday_plots.plot_curves({file.name: read_sieve_table(file, **table)[0]}, figure.add_subplot(), **axes)
    else:
        require_no_options(file, table)
        result = open_result(file)
        if what == "gradings":
            everyday_plots.plot_curves(result, figure.add_subplot(), **axes)
        elif what == "fabric":
            if not -result.stress_ratio.size <= load < result.stress_ratio.size:
                rule = f"it must be an index of a load, 0 to {result.stress_ratio.size - 1}"
                raise parameter_error("--load", load, rule)
            figure = plotting.plot_result(result, load)
        else:
            _indices(result, figure)
    save(figure, target)


def save(figure: Figure, target: Path) -> None:
    """Write a picture file, whole or not at all."""
    write_whole(target, lambda path: figure.savefig(path, format=target.suffix[1:], dpi=150))


def _indices(result: Any, figure: Figure) -> None:
    """Four indices against stress; the reason stands in the place of one that the curves do not have."""
    ax: Axes
    for ax, index in zip(figure.subplots(2, 2).flat, INDICES, strict=True):
        try:
            everyday_plots.plot_index(result, index, ax)
        except ParameterError as error:
            reason = str(reworded(error, words=PLOT_WORDS))
            ax.text(0.5, 0.5, reason, ha="center", va="center", wrap=True, fontsize="x-small", transform=ax.transAxes)
            ax.set_axis_off()

"""Pictures for the command line. Needs matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from comminute import plotting
from comminute._core import ParameterError
from comminute.cli.measured import Measured, measured_of, one_unit
from comminute.cli.messages import WORDS
from comminute.cli.stats import read_sieve_table, require_no_options
from comminute.files.tables import result_curves
from comminute.gradings.curves import SizeCurve
from comminute.opening import open_result
from comminute.plotting import everyday as everyday_plots
from comminute.runs.remarks import load_labels, load_text
from comminute.runs.results import ResultData
from comminute.util.errors import parameter_error, reworded
from comminute.util.whole_files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENDINGS = (".png", ".pdf", ".svg")
PLOT_WORDS = WORDS | {"extrapolate": "comminute stats --extrapolate follows the tail"}
INDICES = ("D50", "Cu", "B", "crushes")


def draw(
    files: list[Path], target: Path, *, what: str, load: int, table: dict[str, Any], measured: list[str], **axes: Any
) -> None:
    """Draw sieve tables and results to a picture file, whole or not at all."""
    if what not in ("gradings", "fabric", "index"):
        raise parameter_error("--what", f"'{what}'", "it must be one of gradings, fabric, index")
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    results = [file for file in files if file.suffix == ".nc"]
    if what == "gradings":
        if len(results) == len(files) == 1:
            require_no_options(files[0], {} if measured else table)
            shown: Any = open_result(files[0])
            everyday_plots.plot_curves(shown, figure.add_subplot(), **axes)
        else:
            shown = _named_curves(files, table)
            everyday_plots.plot_curves(shown, figure.add_subplot(), **axes)
        _lay_over(figure.axes[0], shown, [measured_of(text, table) for text in measured], axes)
        save(figure, target)
        return
    if len(files) > 1 or not results:
        finding = f"is '{what}', but {files[0].name} is a sieve table" if not results else f"is '{what}'"
        rule = "it has gradings alone" if not results else "it takes one result"
        raise parameter_error("--what", what, rule, finding=finding)
    if measured:
        raise parameter_error("--measured", measured[0], f"it goes with gradings, not with {what}")
    require_no_options(files[0], table)
    result = open_result(files[0])
    if what == "fabric":
        if not -result.stress_ratio.size <= load < result.stress_ratio.size:
            rule = f"it must be an index of a load, 0 to {result.stress_ratio.size - 1}"
            raise parameter_error("--load", load, rule)
        figure = plotting.plot_result(result, load)
    else:
        _indices(result, figure)
    save(figure, target)


def _named_curves(files: list[Path], table: dict[str, Any]) -> dict[str, Any]:
    """Curves of several files: of sieve tables by the file, of results by file and load."""
    found: dict[str, Any] = {}
    for file in files:
        if file.suffix == ".nc":
            found |= result_curves(open_result(file), f"{file.stem}: ")
        else:
            found[file.name] = read_sieve_table(file, **table)[0]
    return found


def _lay_over(ax: Axes, shown: Any, measured: list[Measured], axes: dict[str, Any]) -> None:
    """Draw measured points over the curves, in the colour of the load that they were measured at."""
    if not measured:
        return
    if axes["phi"] or axes["axes"] == "rosin-rammler":
        raise parameter_error("--measured", "", "points go over semilog and loglog axes in sizes", finding="is given")
    unit = one_unit(measured)
    result = shown if isinstance(shown, ResultData) else None
    quantity, names = load_labels(result) if result is not None else ("", [])
    stress_unit = quantity.partition("(")[2].rstrip(")")
    if unit and stress_unit and unit != stress_unit:
        rule = f"write it in {stress_unit}, as the result is"
        raise parameter_error("--measured", unit, rule, finding=f"is in {unit}")
    lines = {line.get_label(): line.get_color() for line in ax.get_lines()}
    to = result.unit if result is not None else SizeCurve.of(next(iter(shown.values()))).unit
    for number, one in enumerate(measured):
        curve = SizeCurve.of(one.grading)
        curve = curve.in_unit(to) if curve.unit != to else curve
        colour = next((lines[name] for name in names if name in lines and name == load_text(one.stress)), "k")
        label = f"{one.file.stem}, {load_text(one.stress)} {unit}".strip()
        ax.plot(
            curve.size, 100.0 * curve.finer, "osD^v"[number % 5], ms=4, color=colour, mfc="none", label=label, ls=""
        )
    legend = ax.get_legend()
    title = legend.get_title().get_text() if legend is not None else ""
    ax.legend(title=title, fontsize="small", title_fontsize="small")


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

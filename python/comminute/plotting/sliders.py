"""A slider over the loads of a result, for notebooks. Needs matplotlib and ipywidgets."""

from __future__ import annotations

from typing import Any

from comminute.plotting.fabrics import plot_result
from comminute.runs.remarks import load_labels
from comminute.runs.results import ResolvedData, ResultData
from comminute.util.errors import parameter_error
from comminute.util.optional import needs


def slider(result: ResultData) -> Any:
    """Grading and fabric with a slider over the loads, for notebooks; see `Result.slider`."""
    try:
        import ipywidgets  # noqa: PLC0415  (optional)
    except ImportError as error:
        raise needs("notebook", "ipywidgets", "slider") from error
    loads = range(result.stress_ratio.size)
    computed = isinstance(result, ResolvedData)  # in less time than a drag takes
    kept = [k for k in loads if computed or result.fabrics[k] is not None]
    if not kept:
        finding, rule = "was kept, so there is nothing to slide over", "run with keep_fabrics = 'all'"
        raise parameter_error("keep_fabrics", rule=rule, subject="no fabric", finding=finding)
    quantity, names = load_labels(result)
    options = [(names[k], k) for k in kept]
    control = ipywidgets.SelectionSlider(
        options=options,
        value=kept[-1],
        description=quantity,
        continuous_update=False,  # a picture takes longer than a drag over many loads
        style={"description_width": "initial"},
    )
    picture = ipywidgets.Image(format="png")

    def draw(change: Any) -> None:
        del change
        picture.value = plot_result(result, control.value).png()

    control.observe(draw, names="value")
    draw(None)
    return ipywidgets.VBox([control, picture])

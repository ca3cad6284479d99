"""A slider over the loads of a result, for notebooks. Needs matplotlib and ipywidgets."""

from __future__ import annotations

from typing import Any

from comminute._core import ParameterError
from comminute.plotting.fabrics import plot_result
from comminute.runs.remarks import load_labels
from comminute.runs.results import ResultData
from comminute.util.optional import needs


def slider(result: ResultData) -> Any:
    """Grading and fabric with a slider over the loads, for notebooks; see `Result.slider`."""
    try:
        import ipywidgets  # noqa: PLC0415  (optional)
    except ImportError as error:
        raise needs("notebook", "ipywidgets", "slider") from error
    kept = [k for k, fabric in enumerate(result.fabrics) if fabric is not None]
    if not kept:
        raise ParameterError("no fabric was kept, so there is nothing to slide over; run with keep_fabrics = 'all'")
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

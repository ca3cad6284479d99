"""The command `compare-closures`."""

from __future__ import annotations

from typing import Any

from comminute._core import __version__
from comminute.cases.reading import ReadyCase
from comminute.closures import ClosureComparison, compare_closures
from comminute.runs.resolved_run import require_quasi_static
from comminute.util.errors import parameter_error


def compared(cases: list[ReadyCase], *, cells: int, threads: int) -> ClosureComparison:
    """Compare the closures at the loads of one case.

    Raises
    ------
    ParameterError
        For a sweep, or a case whose loads the resolved closure does not know: at a rate, or by time steps.
    """
    if len(cases) > 1:
        rule = "closures are compared for one case: leave its sweep out"
        raise parameter_error("sweep", len(cases), rule, subject="the case", finding=f"makes {len(cases)} runs")
    (ready,) = cases
    load, engine = ready.resolved.load, ready.resolved.engine
    require_quasi_static(ready.recipe())
    return compare_closures(
        ready.material,
        ready.grading,
        stress_ratio=ready.path().stress_ratio,
        remix_after=load.remix_after,
        mean=engine.mean,
        grid=ready.even_grid,
        scheme=engine.scheme,
        cells=cells,
        replicas=4,
        threads=threads,
    )


def record(found: ClosureComparison) -> dict[str, Any]:
    """Give the numbers of the table, for JSON."""
    return {
        "version": __version__,
        "stress_ratio": found.stress_ratio.tolist(),
        **{
            name: {
                "distance": one.distance.tolist(),
                "size": one.size.tolist(),
                "standard_error": one.standard_error.tolist(),
                "p_value": one.p_value.tolist(),
            }
            for name, one in found.distances.items()
        },
        "step_error": found.step_error.tolist(),
        "advice": found.advice,
    }

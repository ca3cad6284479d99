"""Plots with matplotlib, each on an `Axes` of the caller's choice; nothing here opens a window."""

from comminute.plotting.closures import plot_closures
from comminute.plotting.comparison import (
    plot_cdf_families,
    plot_comparison,
    plot_distances,
    plot_evolution,
    plot_state,
)
from comminute.plotting.compression import plot_compression
from comminute.plotting.everyday import plot_curves, plot_index
from comminute.plotting.fabrics import plot_fabric, plot_result
from comminute.plotting.models import plot_models
from comminute.plotting.paper import (
    PRINT_STYLE,
    figure_size,
    plot_fragment_kernel,
    plot_stress_contours,
    plot_zones,
)

__all__ = [
    "PRINT_STYLE",
    "figure_size",
    "plot_cdf_families",
    "plot_closures",
    "plot_comparison",
    "plot_compression",
    "plot_curves",
    "plot_distances",
    "plot_evolution",
    "plot_fabric",
    "plot_fragment_kernel",
    "plot_index",
    "plot_models",
    "plot_result",
    "plot_state",
    "plot_stress_contours",
    "plot_zones",
]

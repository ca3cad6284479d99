"""Sizes over height and time, of whatever rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from comminute.util.optional import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]


class Profiles:
    """Results by height and time that can be drawn."""

    z: Floats
    time: Floats
    unit: str

    def percentile(self, percent: float) -> Floats:
        """(T, Z) size D_x that `percent` of the mass is no larger than."""
        raise NotImplementedError

    def plot(self, percent: float = 50.0) -> Figure:
        """Draw a size D_x over height and time; needs matplotlib.

        Raises
        ------
        ImportError
            Naming the extra to install.
        """
        try:
            from comminute.plotting.columns import plot_column  # noqa: PLC0415  (matplotlib is optional)
        except ImportError as error:
            raise needs("plot", "matplotlib", "plot") from error
        return plot_column(self.time, self.z, self.percentile(percent), f"D{percent:g}", self.unit)

"""Options by which a caller says what a sieve table leaves open."""

from __future__ import annotations

from dataclasses import dataclass

from comminute.gradings.sieves import require_mesh
from comminute.util.errors import parameter_error

EDGES = ("lower", "upper")


@dataclass(frozen=True)
class Reading:
    """How a table is to be read, where the table itself leaves a choice; each is refused where it does not apply.

    Attributes
    ----------
    sheet : str or int, optional
        Sheet of a workbook, by name or by its number from 1.
    sample : str, optional
        Sample of a table of several.
    mesh : {"astm", "tyler"}, optional
        Series of sieve numbers.
    total_mass_g : float, optional
        Dry mass before washing.
    edges : {"lower", "upper"}, optional
        Edge of a class that its size is.
    """

    sheet: str | int | None = None
    sample: str | int | None = None
    mesh: str | None = None
    total_mass_g: float | None = None
    edges: str | None = None

    def require_valid(self) -> None:
        """Raise ParameterError for a value that no table could take."""
        if self.mesh is not None:
            require_mesh(self.mesh)
        if self.edges is not None and self.edges not in EDGES:
            raise parameter_error("edges", f"'{self.edges}'", "it must be one of 'lower', 'upper'")
        if self.total_mass_g is not None and not 0.0 < self.total_mass_g < float("inf"):
            raise parameter_error("total_mass_g", float(self.total_mass_g), "it must be greater than 0 and finite")

"""Error of a largest stress by the mesh, by Richardson's extrapolation from two meshes."""

from __future__ import annotations

from dataclasses import dataclass

ORDER = 1
"""Order in the element size that the estimate assumes. The largest stresses sit on the surface, to
where those of the elements are extrapolated: docs/verification/data/accuracy_elements.csv has
orders of 0.8 to 1 there."""


@dataclass(frozen=True)
class Estimate:
    """Extrapolation from two meshes. converged : value without discretisation error;  error : its
    distance."""

    converged: float
    error: float


def estimate(
    coarse: float, fine: float, n_coarse: int, n_fine: int, dimensions: int
) -> Estimate | None:
    """Richardson's extrapolation from element counts, h ~ n^(-1/dimensions); None unless the second
    is finer."""
    if n_fine <= n_coarse:
        return None
    ratio = (n_fine / n_coarse) ** (1.0 / dimensions)
    converged = fine + (fine - coarse) / (ratio**ORDER - 1.0)
    return Estimate(converged, abs(converged - fine))

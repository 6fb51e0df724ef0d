"""What a contact of flanks asks of the kernel: gaps, foot points and forces of slave faces."""

from __future__ import annotations

from typing import Any

import numpy as np

from swgpar.contact.flank_pairs import Faces, FlankPairs
from swgpar.contact.friction import Friction
from swgpar.fem.sparse import BlockRows
from swgpar.kernel import contact_flanks


class FlankKernel:
    """Calls `swgpar.kernel.contact_flanks` for the pairs of the last search.

    max_gap : mm, largest |gap| at which a foot point is looked for
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term

    Attributes
    ----------
    pairs : of the last search, None before the first one
    ring_rotation : rad, of the ring gear in the present state
    """

    def __init__(self, max_gap: float, pressure_limit: float) -> None:
        self.max_gap, self.pressure_limit = max_gap, pressure_limit
        self.pairs: FlankPairs | None = None
        self.ring_rotation = 0.0

    def gaps(
        self,
        faces: Faces,
        u: np.ndarray,
        beyond: float | None,
        clearance: float,
        rotation: float | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (n, n_q) mm, inf without a foot, and foot points (n, n_q, 2) mm.

        beyond : facets by which foot points may lie past the ends of the flank, None for none
        clearance : mm, added to the gaps;  rotation : rad, of the ring gear, None for that of now
        """
        more: dict[str, Any] = {} if beyond is None else {"beyond": beyond}
        zero = np.zeros_like(faces.weight)
        gap, _, foot_point, _ = self(faces, u, zero, clearance, rotation=rotation, **more)
        return gap, foot_point

    def __call__(
        self,
        faces: Faces,
        u: np.ndarray,
        pressure: np.ndarray,
        clearance: float,
        residual: np.ndarray | None = None,
        rows: BlockRows | None = None,
        law: Friction | None = None,
        rotation: float | None = None,
        **more: Any,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        """Gaps, pressures, foot points and the number of missing blocks."""
        settings = (
            0.0,  # the pressures are given
            clearance,
            self.max_gap,
            self.pressure_limit,
            residual,
            rows,
            law,
            self.ring_rotation if rotation is None else rotation,
        )
        return contact_flanks(self.pairs.masters, faces, u, pressure, *settings, **more)

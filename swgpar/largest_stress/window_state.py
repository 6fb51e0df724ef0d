"""The equilibrium of a window, from which finer ones begin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.meshing.sector import SectorMesh


@dataclass(frozen=True)
class WindowState:
    """The equilibrium of a window, from which a finer one around the same tooth begins.

    mesh : sector of the window;  first_tooth : of its sectors
    displacement : (n_teeth, n_node, 3) mm
    """

    mesh: SectorMesh
    first_tooth: int
    displacement: np.ndarray

    def of(self, first: int, count: int) -> np.ndarray:
        """Displacement (count, n_node, 3) mm of the sectors from a tooth on."""
        begin = first - self.first_tooth
        return self.displacement[begin : begin + count]

"""Distance of the flanks that are to carry the load, and the rotation of the output that closes
it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.contact.contact import largest
from swgpar.contact.flanks import FlankContact

LOADED_SIDE = -1
"""Side of the flanks that carry a load that rotates the flexible spline counter-clockwise against
the ring gear."""

LARGEST_STEP, MEETING_DEPTH = 0.05, 2e-4
"""Largest travel (modules) of the teeth in a Newton step under torque control, and the depth at
which they meet."""


@dataclass(frozen=True, eq=False)
class FlankClearance:
    """Clearance of the loaded flanks in the last evaluation of their contact; all methods are
    collective.

    They take the side of the flanks that carry: `LOADED_SIDE`, or the other one where the torque
    acts in reverse.

    Parameters
    ----------
    flanks : contact of the flanks;  comm : communicator
    module : mm;  outer_radius : mm, radius that no tooth is farther out than
    """

    flanks: FlankContact
    comm: MPI.Comm
    module: float
    outer_radius: float

    def gap(self, side: int) -> float:
        """Smallest gap (mm) of the loaded flanks; inf where none is near."""
        return -largest(self.comm, -self.flanks.smallest_gap(side))

    def largest_rotation(self, side: int) -> float:
        """Bound (rad) of the output's rotation in a Newton step under torque control.

        Flanks close no faster than their radius times the rotation: up to contact there is no
        overshoot.
        """
        gap = self.gap(side) / self.module
        return (
            self.module
            * (min(gap, LARGEST_STEP) + MEETING_DEPTH if gap > 0.0 else LARGEST_STEP)
            / self.outer_radius
        )

    def closing_rotation(self, side: int) -> float:
        """Rotation (rad) that brings the flanks together.

        0 where they are so close that a Newton step does the rest, or where none is near.
        """
        gap = self.gap(side)
        return gap / self.outer_radius if MEETING_DEPTH * self.module < gap < np.inf else 0.0

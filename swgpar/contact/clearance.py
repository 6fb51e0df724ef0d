"""How far the flanks that are to carry are apart, and how far the output may turn for it."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.contact.flanks import FlankContact
from swgpar.contact.search import largest
from swgpar.design.drive_design import DriveDesign

LOADED_SIDE = -1
"""Flanks that carry: the load turns the flexible spline counter-clockwise against the ring gear."""

LONGEST, MEETING = 0.05, 2e-4
"""Largest way (modules) of the teeth in a Newton step under torque control, and how deep they meet when apart."""


class Clearance:
    """Of the last evaluation of the teeth's contact; all methods are collective."""

    def __init__(self, design: DriveDesign, teeth: FlankContact, comm: MPI.Comm) -> None:
        self.design, self.teeth, self.comm, self.module = design, teeth, comm, design.drive.module

    @property
    def reach(self) -> float:
        """Radius (mm) that no tooth is farther out than."""
        return 0.5 * self.design.drive.teeth_rg * self.module + self.design.deflection

    def gap(self) -> float:
        """Smallest gap (mm) of the loaded flanks; inf where none is near."""
        return -largest(self.comm, -self.teeth.clearance(LOADED_SIDE))

    def longest_turn(self) -> float:
        """Bound (rad) of the output's turn in a Newton step under torque control.

        Flanks close no faster than their radius times the turn: up to contact there is no overshoot.
        """
        gap = self.gap() / self.module
        return self.module * (min(gap, LONGEST) + MEETING if gap > 0.0 else LONGEST) / self.reach

    def closing_turn(self) -> float:
        """Turn (rad) by which the flanks do not meet yet.

        0 where they are so close that a Newton step does the rest, or where none is near.
        """
        gap = self.gap()
        return gap / self.reach if MEETING * self.module < gap < np.inf else 0.0

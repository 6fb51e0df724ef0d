"""The cells of a contact of flanks: placed anew in every evaluation, until they are frozen near the
solution. The tangent does not contain the motion of the cuts between them."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

import numpy as np

from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.cell_forces import CellForces
from swgpar.contact.cell_placement import ACROSS, NARROW, RESOLVED, CellPlacement, Gaps
from swgpar.contact.cells import Stations
from swgpar.contact.flank_kernel import FlankKernel
from swgpar.contact.friction_history import FrictionHistory
from swgpar.contact.pressed_lines import PressedLine
from swgpar.contact.search import FlankPair
from swgpar.contact.tangential_stiffness import tangential_stiffness

SLIDING = 0.5
"""Facets by which frozen cells may slide past the ends of the master's flank: their forces then
change continuously."""


class LineCells:
    """Cells on the faces that a search has found near.

    kernel : gives gaps;  law : gives forces;  stations : lines on a layer
    history : gives the friction that begins on cells

    Attributes
    ----------
    near : (n,) faces that can meet, of all pairs
    active : the present cells, None before an evaluation
    frozen : whether they stay;  share : of the contact's stiffness that acts
    """

    def __init__(
        self, kernel: FlankKernel, law: CellForces, stations: Stations, history: FrictionHistory
    ) -> None:
        self.kernel, self.law, self.stations, self.history = kernel, law, stations, history
        self.near = np.zeros(0, dtype=np.int64)
        self.share = 1.0
        self.active: ActiveCells | None = None
        self.frozen = False
        self._placement: CellPlacement | None = None
        # displacements where unfrozen cells were placed, and where the cells were pressed
        self._placed_at: np.ndarray | None = None
        self._pressed_at: np.ndarray | None = None

    def reset(self) -> None:
        """Forget the cells."""
        self._placement = self.active = self._placed_at = self._pressed_at = None
        self.frozen = False

    def scale(self, share: float) -> None:
        """Use this share of the stiffness."""
        if share != self.share:
            self.share, self._placed_at, self._pressed_at = share, None, None

    def pressed(self, u: np.ndarray, clearance: float) -> ActiveCells:
        """The cells with their forces at displacement u (n_local, 3) mm, placed there unless they
        are frozen. clearance : mm

        A residual and the tangent at the same displacement have the same cells and forces.
        """
        if not self.frozen and not _is_at(u, self._placed_at):
            self.active = self._placed(u, clearance, ACROSS)
            self._placed_at = self._pressed_at = u.copy()
        elif not _is_at(u, self._pressed_at):
            gap, _ = self.kernel.gaps(self.active.faces, u, SLIDING, clearance)
            self.law.press(self.active, gap, self.share)
            self._pressed_at = u.copy()
        return self.active

    def pressed_lines(
        self, u: np.ndarray, clearance: float, narrow: Collection[FlankPair] | None = None
    ) -> list[PressedLine]:
        """Pressures of the pairs whose flexible-spline tooth this rank owns at displacement u
        (n_local, 3) mm, on finer cells than those of a solve.

        In the plane they carry the forces of the present cells, which are in equilibrium: at the
        same displacement other cells have up to some percent more or less.

        narrow : pairs whose pressure has narrow peaks: these alone, on still finer cells; None for
        all pairs
        """
        if narrow is None:
            fine = self._placed(u, clearance, RESOLVED)
        else:
            pair = self.kernel.pairs.faces.patch[self.near]
            wanted = [k for k, one in enumerate(self.kernel.pairs.pairs) if one in narrow]
            placement = self._placement_on(self.near[np.isin(pair, wanted)])
            fine = self._placed(u, clearance, NARROW, placement)
        if self.active is not None and self.law.n_line == 1:
            self.law.carry(fine, self.share, self.active)
        return self.law.pressed_lines(fine)

    def least_gaps(self, u: np.ndarray, clearance: float) -> np.ndarray:
        """Smallest gap (n_pair,) mm of each pair at displacement u (n_local, 3) mm, as far as its
        faces are near; else inf. clearance : mm"""
        return self._place().least_gaps(u, self._gaps(clearance))

    def misses_lines(self, u: np.ndarray, clearance: float) -> bool:
        """Whether lines touch at u that have no frozen cells."""
        if not self.frozen or not len(self.near):
            return False
        touching = self._place().overlapping(u, self._gaps(clearance))
        return bool(np.isin(touching, self.active.placed.line, invert=True).any())

    def _placed(
        self, u: np.ndarray, clearance: float, across: int, placement: CellPlacement | None = None
    ) -> ActiveCells:
        """Cells that are placed and pressed at displacement u, with the friction that begins on
        them.

        across : least number of cells in an overlap;  placement : None for that of all near faces
        """
        pairs = self.kernel.pairs
        placed = (placement or self._place()).place(u, self._gaps(clearance), across)
        gap, foot = self.kernel.gaps(placed.faces, u, SLIDING, clearance)
        active = self.law.measured(pairs, placed, foot)
        self.law.press(active, gap, self.share)
        slave = self.law.missing[0]
        facet = float(np.diff(slave.s).mean())
        stiffness = tangential_stiffness(active, slave.modulus, facet)
        active.friction = self.history.on_cells(active, stiffness, self.kernel)
        return active

    def _gaps(self, clearance: float) -> Gaps:
        return partial(self.kernel.gaps, clearance=clearance)

    def _place(self) -> CellPlacement:
        """What places cells, made once for a search."""
        if self._placement is None:
            self._placement = self._placement_on(self.near)
        return self._placement

    def _placement_on(self, near: np.ndarray) -> CellPlacement:
        return CellPlacement(
            self.kernel.pairs,
            near,
            n_face=self.law.n_face,
            n_layer=self.law.n_layer,
            stations=self.stations,
        )

    # -- frozen cells ------------------------------------------------------------------------------

    def freeze(self) -> None:
        """Freeze the cells of the last evaluation until `release` or the next search."""
        self.frozen, self._placed_at = self.active is not None, None

    def release(self) -> None:
        """Place the cells anew in every evaluation again."""
        self.frozen = False

    def restore(self, saved: ActiveCells | None) -> None:
        """Freeze cells of the last search again; friction follows the pressure on them.

        Raises ValueError for cells of an earlier search: their local nodes are others.
        """
        if saved is not None and saved.flank_pairs is not self.kernel.pairs:
            raise ValueError("the cells belong to an earlier contact search")
        self.active, self._pressed_at = saved, None
        if saved is not None and saved.friction is not None:
            saved.friction.lagged = None
        self.freeze()

    def freeze_friction_bound(self) -> tuple[float, float]:
        """Let the pressures of the last evaluation bound the friction, on frozen cells.

        Returns the largest change of these pressures and the largest of them (MPa) on this rank; 0
        without friction.
        """
        if not self.frozen or self.active.friction is None:
            return 0.0, 0.0
        law, pressure = self.active.friction, self.active.pressure
        before, law.lagged = law.lagged, pressure.copy()
        top = float(pressure.max(initial=0.0))
        return top if before is None else float(np.abs(pressure - before).max(initial=0.0)), top


def _is_at(u: np.ndarray, place: np.ndarray | None) -> bool:
    """Whether u is the displacement `place`, if there is one."""
    return place is not None and np.array_equal(u, place)

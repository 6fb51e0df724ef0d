"""Work of the friction between the flanks, from the tangential forces and the slip of consecutive
states."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from mpi4py import MPI

from swgpar.analysis.load_stepping import LoadStepper
from swgpar.contact.cells import Cells
from swgpar.contact.flank_pairs import Faces
from swgpar.contact.flanks import FlankContact
from swgpar.fem.body import RING_GEAR
from swgpar.kernel import contact_flanks


@dataclass
class Forces:
    """Tangential forces (N) on the points of the cells of a state, and where these are on the
    master (mm).

    keys : of the pairs then;  depth : mm, pressure over the tangential stiffness
    """

    keys: list
    cells: Cells
    force: np.ndarray
    foot_point: np.ndarray
    depth: np.ndarray


NO_FORCES = Forces(
    [],
    Cells(np.zeros(0, dtype=np.int64), *np.zeros((4, 0))),
    *np.zeros((2, 0, 2, 2)),
    np.zeros((0, 2)),
)


def on_master(flanks: FlankContact, faces: Faces, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gaps (n_face, n_q) mm and foot points (n_face, n_q, 2) mm, arc length and z on the master, at
    displacement u (n_local, 3) mm."""
    rotation = flanks.ring_motion.ring_rotation(u)
    settings = (
        0.0,
        0.0,
        flanks.kernel.max_gap,
        flanks.kernel.pressure_limit,
        None,
        None,
        None,
        rotation,
    )
    gap, _, foot_point, _ = contact_flanks(
        flanks.flank_pairs.masters, faces, u, np.zeros_like(faces.weight), *settings
    )
    return gap, foot_point


def touching(gap: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Part of an increment in which a point touches that does at one end of it: the law's own rule
    (kernel/friction.hpp). gap : mm, at the other end"""
    apart = np.maximum(gap, 0.0)
    return np.divide(depth, apart + depth, out=np.ones_like(depth), where=apart > 0.0)[..., None]


def forces(stepper: LoadStepper) -> tuple[Forces, float]:
    """Forces of the present state, and their work over the slip since the one before; metric taken
    as one."""
    flanks, u = stepper.problem.flanks_of(RING_GEAR), stepper.problem.displacement()
    active = flanks.cells.active
    if active is None or active.friction is None:
        return NO_FORCES, 0.0
    _, place = on_master(flanks, active.faces, u)
    law, keys = active.friction, [p.key for p in flanks.pairs]
    force = active.faces.weight[..., None] * law.current
    force[~flanks.flank_pairs.owned[active.faces.patch]] = 0.0
    depth = active.pressure / law.stiffness
    slip = touching(law.gap, depth) * (place - law.foot_point)
    work = float(np.nansum(force * slip))
    return Forces(keys, active.placed.cells, force, place, depth), work


def onward(stepper: LoadStepper, old: Forces) -> float:
    """Work of the forces of the state before over the slip since then."""
    flanks, u = stepper.problem.flanks_of(RING_GEAR), stepper.problem.displacement()
    now = {p.key: k for k, p in enumerate(flanks.pairs)}
    pair, local = np.divmod(old.cells.parent, flanks.n_face)
    new = np.array([now.get(key, -1) for key in old.keys], dtype=np.int64)[pair]
    keep = np.flatnonzero((new >= 0) & (np.abs(old.force).sum(axis=(1, 2)) > 0.0))
    if not len(keep):
        return 0.0
    others = (getattr(old.cells, f.name)[keep] for f in fields(Cells) if f.name != "parent")
    part = Cells(new[keep] * flanks.n_face + local[keep], *others)
    gap, place = on_master(flanks, flanks.flank_pairs.faces.of_cells(part), u)
    slip = touching(gap, old.depth[keep]) * (place - old.foot_point[keep])
    return float(np.nansum(old.force[keep] * slip))


class FrictionWork:
    """Sums up the work over all solves of a stepper, those of cut-backs too, by the trapezoidal
    rule."""

    def __init__(self, stepper: LoadStepper) -> None:
        self.stepper, self.problem, self.total = stepper, stepper.problem, 0.0
        self.old, _ = forces(stepper)
        self.accept = self.problem.accept
        self.problem.accept = self._measure

    def _measure(self) -> None:
        after = onward(self.stepper, self.old)
        self.old, before = forces(self.stepper)
        self.total += 0.5 * (after + before) / self.problem.supports.share
        self.accept()

    def whole(self) -> float:
        """N mm, of all ranks; collective."""
        return self.problem.partition.comm.allreduce(self.total, op=MPI.SUM)

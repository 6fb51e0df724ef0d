"""Work of the friction between the flanks, from the tangential forces and the slip of consecutive
states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.analysis.load_stepping import LoadStepper
from swgpar.contact.flank_pairs import Faces
from swgpar.contact.flanks import FlankContact
from swgpar.contact.segments import Segments
from swgpar.fem.body import RING_GEAR
from swgpar.kernel import contact_flanks


@dataclass
class Forces:
    """Tangential forces (N) on the points of the flanks of a state, and where these are on the
    master (mm)."""

    keys: list
    segments: Segments
    force: np.ndarray
    foot_point: np.ndarray


def foot_points(flanks: FlankContact, faces: Faces, u: np.ndarray) -> np.ndarray:
    """Foot points (n_face, n_q, 2) mm, arc length and z on the master, at displacement u (n_local,
    3) mm."""
    rotation = flanks.ring_motion.ring_rotation(u)
    settings = (
        flanks.penalty,
        0.0,
        flanks.max_gap,
        flanks.pressure_limit,
        None,
        None,
        None,
        rotation,
    )
    return contact_flanks(
        flanks.flank_pairs.masters, faces, u, np.zeros_like(faces.weight), *settings
    )[2]


def forces(stepper: LoadStepper) -> tuple[Forces, float]:
    """Forces of the present state, and their work over the slip since the one before; metric taken
    as one."""
    flanks, u = stepper.problem.flanks_of(RING_GEAR), stepper.problem.displacement()
    active = flanks.saved_segments()
    if active is None or active.friction is None:
        none = np.zeros((0, 4, 2))
        return Forces(
            [], Segments(np.zeros(0, dtype=np.int64), *np.zeros((3, 0, 4))), none, none
        ), 0.0
    place = foot_points(flanks, active.faces, u)
    force = active.faces.weight[..., None] * active.friction.current
    force[~flanks.flank_pairs.owned[active.faces.patch]] = 0.0
    work = float(np.nansum(force * (place - active.friction.foot_point)))
    return Forces([p.key for p in flanks.pairs], active.segments, force, place), work


def onward(stepper: LoadStepper, old: Forces) -> float:
    """Work of the forces of the state before over the slip since then."""
    flanks, u = stepper.problem.flanks_of(RING_GEAR), stepper.problem.displacement()
    now = {p.key: k for k, p in enumerate(flanks.pairs)}
    pair, local = np.divmod(old.segments.parent, flanks.n_face)
    new = np.array([now.get(key, -1) for key in old.keys], dtype=np.int64)[pair]
    keep = np.flatnonzero((new >= 0) & (np.abs(old.force).sum(axis=(1, 2)) > 0.0))
    if not len(keep):
        return 0.0
    part = Segments(
        np.arange(len(keep)), *(getattr(old.segments, n)[keep] for n in ("a", "b", "share"))
    )
    place = foot_points(
        flanks, flanks.flank_pairs.faces.cut(new[keep] * flanks.n_face + local[keep], part), u
    )
    return float(np.nansum(old.force[keep] * (place - old.foot_point[keep])))


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

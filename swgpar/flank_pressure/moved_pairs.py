"""The flanks of a pair of teeth as their displacement moves them, and the gap between them."""

from __future__ import annotations

import numpy as np

from swgpar.contact.flanks import FlankContact
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.vectors import read_field
from swgpar.flank_pressure.indentation import indentation
from swgpar.flank_pressure.moved_teeth import MovedTooth
from swgpar.geometry.rotation import SIXTHS
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc

ALONG, BETWEEN = 65, (17, 9)
"""Points along a profile among which that of the least gap is looked for, and then twice between
its neighbours: in the end they are a 2,048th of the profile apart."""

Neighbours = tuple[MovedTooth, MovedTooth, MovedTooth]
"""A tooth between its neighbours, clockwise first."""


def moved_teeth(
    model: DriveModel, pairs: list[FlankPair], flanks: FlankContact, forces: PETSc.Vec | None = None
) -> tuple[list[Neighbours], list[Neighbours]]:
    """The teeth of every pair, of the flexible spline and of the ring gear, between their
    neighbours; collective.

    forces : of the flanks' contact on all nodes, N; the teeth of the pairs then move without the
    indentation by these forces
    """
    spline, ring = model.partition.layouts[FLEXIBLE_SPLINE], flanks.ring.layout
    around, gears = np.arange(-1, 2), model.design.geometry.gears
    crowned, ring_crowned = (gears[body.name].crowning for body in (spline, ring))
    u, ring_u = (
        _displacements(model, flanks, pairs, body, forces) for body in (FLEXIBLE_SPLINE, ring.name)
    )
    moved, facing = [], []
    for k, pair in enumerate(pairs):
        tooth = spline.first_tooth + pair.sector + around
        before, middle, after = (
            MovedTooth(spline, n, pair.side, u[k, i], crowned) for i, n in enumerate(tooth)
        )
        moved.append((before, middle, after))
        turned = ring_u[k] @ SIXTHS[pair.ring_sixths].T
        tooth = pair.ring_tooth + around
        before, middle, after = (
            MovedTooth(ring, n, -pair.side, turned[i], ring_crowned) for i, n in enumerate(tooth)
        )
        facing.append((before, middle, after))
    return moved, facing


def _displacements(
    model: DriveModel,
    flanks: FlankContact,
    pairs: list[FlankPair],
    body: str,
    forces: PETSc.Vec | None,
) -> np.ndarray:
    """Displacements (n_pair, 3, n_node, 3) mm of the sectors of the pairs and their neighbours;
    collective."""
    is_spline, partition = body == FLEXIBLE_SPLINE, model.partition
    sectors = np.array([p.sector if is_spline else p.ring for p in pairs], dtype=np.int64)
    every = (sectors[:, None] + np.arange(-1, 2)).ravel()
    mesh = partition.layouts[body].mesh
    u = read_field(partition, body, every, model.problem.x)
    u = u.reshape(len(pairs), 3, len(mesh.coords), 3)
    if forces is None:
        return u
    loads = read_field(partition, body, sectors, forces)
    grids = {grid.side: grid for grid in mesh.flanks}
    missing = flanks.law.missing[0 if is_spline else 1]
    for k, pair in enumerate(pairs):
        grid = grids[pair.side if is_spline else -pair.side]
        load = loads[k, grid.nodes]
        direction = load.sum(axis=(0, 1))
        direction /= np.linalg.norm(direction)
        into = indentation(missing, grid.z, load @ direction)
        u[k, 1, grid.nodes] -= into[..., None] * direction
    return u


class FlankGap:
    """Gap between two moved teeth over the arc length on the first one and the face width."""

    def __init__(self, tooth: MovedTooth, facing: MovedTooth) -> None:
        self.tooth, self.facing = tooth, facing

    def _distance(self, s: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.facing.sections(z).distance(self.tooth.sections(z).from_profile(s))

    def __call__(self, s: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Gap (m, n) mm at s (m, n) and z (n,) mm, infinite beyond the ends of the profile."""
        inside = (s >= 0.0) & (s <= self.tooth.profile.length)
        return np.where(inside, self._distance(np.where(inside, s, 0.0), z)[0], np.inf)

    def foot(self, s: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Arc length (m, n) mm on the facing flank at s (m, n) and z (n,) mm."""
        return self._distance(s, z)[1]

    def least_at(self, z: np.ndarray) -> np.ndarray:
        """Arc length (n,) mm of the least gap at z (n,) mm."""
        every, apart = np.arange(len(z)), self.tooth.profile.length / (ALONG - 1)
        s = np.tile(apart * np.arange(ALONG)[:, None], len(z))
        s = s[self(s, z).argmin(axis=0), every]
        for count in BETWEEN:
            around = s + apart * np.linspace(-1.0, 1.0, count)[:, None]
            s = around[self(around, z).argmin(axis=0), every]
            apart *= 2.0 / (count - 1)
        return s

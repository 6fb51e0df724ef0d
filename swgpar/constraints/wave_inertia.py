"""Forces of inertia of a body through which the wave of the cam travels, in its steady state.

A tooth sector moves as the one before it did, a pitch of its own gear earlier. In coordinates that
rotate by a pitch from sector to sector a node of the sectors has the places p. With the speeds r of
the body and w of the wave generator in space, c = r - w and derivatives by the angle around,

    a = c² p'' + 2 c r e_z x p' - r² p.

A body at rest under the wave has the first term alone; a circle that rotates the last one. The
derivatives are differences of three sectors, exact for a wave of n lobes. The forces -m a of one
body have no moment about the axis: their sum over the sectors vanishes term by term.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.contact import NO_KEYS
from swgpar.fem.elements import BodyElements
from swgpar.fem.masses import sector_masses
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import rotated
from swgpar.load.load_states import LoadState


class WaveInertia:
    """Forces of inertia on the nodes of a body; meets the protocol `ForceTerm`.

    They follow from the displacement, and the tangent does not have them: it is that of the elastic
    forces, beside which they are small.

    body : elements of the body, whose sectors are all unknowns;  lobes : of the wave
    speed, wave : rad/s, of the body and of the wave generator in space
    """

    def __init__(self, body: BodyElements, lobes: int, speed: float, wave: float) -> None:
        self.body, self.speed, self.passing = body, speed, speed - wave
        layout, mesh = body.layout, body.layout.mesh
        masses = sector_masses(layout.body)
        # nodes between two sectors belong to the second one, with the masses of both
        masses[mesh.cw_nodes] += masses[mesh.ccw_nodes]
        masses[mesh.ccw_nodes] = 0.0
        self._nodes = np.flatnonzero(masses)
        self.masses = masses[self._nodes]
        self._first = lobes / (2.0 * np.sin(lobes * mesh.pitch))
        self._second = (0.5 * lobes / np.sin(0.5 * lobes * mesh.pitch)) ** 2
        self._angle = layout.chain_angle(body.sectors)[:, None]

    def is_active(self, state: LoadState) -> bool:
        """With the cam."""
        return state.cam_clearance is not None

    def forces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Local nodes (n,) that this rank owns, each once, and the forces (n, 3) N on them at u
        (n_local, 3) mm."""
        owned = self.body.owned
        local = self.body.local[owned][:, self._nodes]
        moved = rotated(self.body.displacement(u)[:, self._nodes], -self._angle)
        places = self.body.layout.mesh.coords[self._nodes] + moved
        here = places[owned]
        before = places[owned.start - 1 : owned.stop - 1]
        after = places[owned.start + 1 : owned.stop + 1]
        first = self._first * (after - before)
        acceleration = self.passing**2 * self._second * (after - 2.0 * here + before)
        across = np.stack([-first[..., 1], first[..., 0]], axis=-1)
        acceleration[..., :2] += 2.0 * self.passing * self.speed * across
        acceleration[..., :2] -= self.speed**2 * here[..., :2]
        forces = rotated(-self.masses[:, None] * acceleration, self._angle[owned])
        return local.ravel(), forces.reshape(-1, 3)

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces to the residual; see `ForceTerm`."""
        if residual is not None and self.is_active(state) and len(self.body.sectors):
            nodes, forces = self.forces(u)
            residual[nodes] -= forces
        return NO_KEYS

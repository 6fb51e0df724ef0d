"""Two elastic blocks pressed together: kernel and flank contact alone, solved by a dense-free
Newton iteration."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import block_diag, csr_matrix
from scipy.sparse.linalg import spsolve

from support.element_mesh import ElementMesh
from swgpar.contact import friction
from swgpar.contact.flank_pairs import Faces, MasterFlanks, PlacedFaces
from swgpar.contact.flanks import CONTINUATION
from swgpar.contact.segments import Segments, cut_faces
from swgpar.kernel import contact_flanks
from swgpar.materials import Material

ORDERING = "MMD_AT_PLUS_A"
"""Of SuperLU, for matrices with a symmetric pattern."""


class Rows:
    """All blocks among the first n of n_local nodes (None: n), of a symmetric matrix the upper
    triangle."""

    def __init__(self, n: int, symmetric: bool = True, n_local: int | None = None) -> None:
        first = np.arange(n) if symmetric else np.zeros(n, dtype=np.int64)
        self.start = np.concatenate([[0], np.cumsum(n - first)]).astype(np.int64)
        self.column = np.concatenate([np.arange(k, n) for k in first]).astype(np.int32)
        self.values = np.zeros((len(self.column), 3, 3))
        self.number, self.n_own, self.symmetric = (
            np.arange(n_local or n, dtype=np.int32),
            n,
            symmetric,
        )

    def matrix(self) -> np.ndarray:
        full = np.zeros((self.n_own, 3, self.n_own, 3))
        row = np.repeat(np.arange(self.n_own), np.diff(self.start))
        for r, c, v in zip(row, self.column, self.values):
            full[r, :, c] = v.T
            if self.symmetric:
                full[c, :, r] = v
        return full.reshape(3 * self.n_own, -1)


def master(
    points: np.ndarray, tangents: np.ndarray, s: np.ndarray, z: np.ndarray, first: int
) -> MasterFlanks:
    """One flank whose nodes are numbered from `first`; the tangent runs to +x, the outward normal
    to +y."""
    n = len(s) * len(z)
    return MasterFlanks(
        s,
        z,
        points[None].copy(),
        tangents[None].copy(),
        np.array([-1.0]),  # x cross z points to -y
        np.array([[1.0, 0.0]]),
        (first + np.arange(n, dtype=np.int32)).reshape(1, len(s), len(z)),
        np.zeros((1, len(s), len(z)), dtype=np.uint8),
    )


def block(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3), hexahedra (m, 8) and the numbers (n_x, n_y, n_z) of the nodes of a grid."""
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1)
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    corner = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
    ]
    n = np.array(number.shape) - 1
    hexes = [number[a : a + n[0], b : b + n[1], c : c + n[2]].ravel() for a, b, c in corner]
    return points.reshape(-1, 3), np.stack(hexes, axis=1), number


@dataclass
class Blocks:
    """The flank of the lower block is the master, the faces of the upper one are the slaves.

    points (n, 3) mm, hexes (m, 8), the nodes of both contact surfaces among the first n_surface
    ones fixed (n, 3) : components with a given displacement;  order : Gauss points per direction of
    a segment
    coefficient : of friction, on the way from the displacement `before` (n, 3) with the tractions
    `history`
    incompatible : elements with incompatible modes
    """

    points: np.ndarray
    hexes: np.ndarray
    n_surface: int
    flanks: MasterFlanks
    placed: PlacedFaces
    fixed: np.ndarray
    material: Material
    penalty: float
    order: int
    coefficient: float = 0.0
    before: np.ndarray | None = None
    history: np.ndarray | None = None
    incompatible: bool = True

    def press(
        self, u: np.ndarray, force: np.ndarray, augmentations: int = 0
    ) -> tuple[Faces, np.ndarray, np.ndarray]:
        """Equilibrium from u (n, 3), which is changed; its fixed components stay. Segments,
        pressure, contact force."""
        mesh = ElementMesh(self.points, self.hexes, self.material, incompatible=self.incompatible)
        rest = 3 * (len(self.points) - self.n_surface)
        free, pick = np.flatnonzero(~self.fixed.ravel()), np.arange(len(self.placed.conn))
        settings, law = (self.penalty, 0.0, 0.2, np.inf), None
        for augmentation in range(augmentations + 1):
            for _ in range(40):
                r = mesh.residual(u) - force
                rows = Rows(self.n_surface, self.coefficient == 0.0, len(u))
                if augmentation == 0:
                    corners = self.placed.corners(pick)
                    zero = np.zeros((len(pick), 4))
                    foot = contact_flanks(
                        self.flanks, corners, u, zero, *settings, None, None, beyond=CONTINUATION
                    )[2]
                    segments = cut_faces(
                        foot, self.placed.size, self.flanks.s, self.flanks.z, self.order
                    )
                    faces = self.placed.cut(pick, segments)
                    multiplier = np.zeros(faces.weight.shape)
                    if self.coefficient > 0.0:
                        law = self._friction(faces, segments, multiplier)
                contact = np.zeros_like(r)
                _, pressure, _, _ = contact_flanks(
                    self.flanks, faces, u, multiplier, *settings, contact, rows, law
                )
                r += contact
                residual = np.abs(r.ravel()[free]).max() / np.abs(contact).max()
                if residual < 1e-9:
                    break
                stiffness = mesh.tangent(u) + block_diag(
                    [csr_matrix(rows.matrix()), csr_matrix((rest, rest))]
                )
                u.ravel()[free] -= spsolve(
                    stiffness.tocsc()[free][:, free], r.ravel()[free], ORDERING
                )
            assert residual < 1e-7, (augmentation, residual)
            multiplier = pressure.copy()
        if law is not None:
            self.before, self.traction = u.copy(), law.current
            self.history = np.stack([friction.sampled(segments, law.current, k) for k in pick])
        return faces, pressure, contact

    def _friction(self, faces: Faces, segments: Segments, zero: np.ndarray) -> friction.Friction:
        settings = (self.penalty, 0.0, 0.2, np.inf)
        gap, _, place, _ = contact_flanks(
            self.flanks, faces, self.before, zero, *settings, None, None
        )
        law = friction.begin(
            self.coefficient, place, gap, friction.interpolated(self.history, segments)
        )
        return replace(law, stiffness=friction.STIFFNESS * self.penalty)

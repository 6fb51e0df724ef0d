"""The faces of the inner surface as unknowns of a linear model: each presses on the cam or not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from swgpar.contact.rigid_surface import RigidContact
from swgpar.geometry.rotation import to_owners
from swgpar.load.load_states import LoadState


@dataclass(frozen=True)
class CamFaces:
    """Faces of the inner surface against the cam in a linear model around one state.

    The tangent of the model holds the springs of the faces that press in that state. A face that
    leaves its state gets a correcting force: minus that of its spring where it no longer presses,
    and its own where it begins to.

    motions : (n_face, n) mean normal displacement of each face per unknown
    pressing : (n_face,) bool, in the state of the model;  stiffness : (n_face,) N/mm
    depth : (n_face,) mm, mean penetration in that state; negative is a gap
    compliance : (n_face, n_face) mm/N, motions of the faces by unit forces on them
    """

    motions: csr_matrix
    pressing: np.ndarray
    stiffness: np.ndarray
    depth: np.ndarray
    compliance: np.ndarray

    def left(self, depth: np.ndarray) -> np.ndarray:
        """Numbers (n,) of the faces that are not in their state at depths (n_face,) mm."""
        return np.flatnonzero(self.pressing != (depth > 0.0))

    def softness(self, faces: np.ndarray) -> np.ndarray:
        """Matrix (n, n) mm/N from the correcting forces of faces (n,) to their depths without
        them."""
        sign = np.where(self.pressing[faces], -1.0, 1.0)
        return np.diag(sign / self.stiffness[faces]) + self.compliance[np.ix_(faces, faces)]

    def corrected(self, depth: np.ndarray, faces: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Depths (n_face,) mm with correcting forces (n,) N on faces (n,)."""
        return depth - forces @ self.compliance[faces]


def cam_faces(
    cam: RigidContact,
    u: np.ndarray,
    state: LoadState,
    n_own: int,
    response: Callable[[np.ndarray], np.ndarray],
) -> CamFaces:
    """The faces of a rank that owns all of the drive.

    u : (n_local, 3) mm, of the state of the model;  n_own : nodes
    response : displacement (n_own * 3,) mm by nodal forces (n_own * 3,) N, with the tangent of the
    model
    """
    cam.reset()
    normal, presses = cam.normals(u, state), cam.pressure > 0.0
    # of a face that presses in part, that part
    counts = presses | ~presses.any(axis=1, keepdims=True)
    weight = np.where(np.isfinite(cam.gap) & counts, cam.weight, 0.0)
    near = np.flatnonzero(weight.sum(axis=1) > 0.0)
    weight = weight[near]
    share = weight / weight.sum(axis=1, keepdims=True)
    nodal = np.einsum("fq,qa,fqi->fai", share, cam.shape, normal[near])
    nodal = to_owners(nodal, cam.sixths[near])
    face, corner = np.nonzero(cam.conn[near] >= 0)
    column = 3 * cam.conn[near][face, corner][:, None] + np.arange(3)
    entries = nodal[face, corner].ravel(), (np.repeat(face, 3), column.ravel())
    motions = coo_matrix(entries, shape=(len(near), 3 * n_own)).tocsr()
    depth = -(share * np.where(weight > 0.0, cam.gap[near], 0.0)).sum(axis=1)
    compliance = np.array([motions @ response(row.toarray()[0]) for row in motions])
    return CamFaces(motions, depth > 0.0, cam.penalty * weight.sum(axis=1), depth, compliance)

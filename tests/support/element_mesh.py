"""Small meshes of single elements, assembled and solved by SciPy: for tests of the element
kernels."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.linalg import spsolve

from swgpar.fem.element_matrices import element_matrices
from swgpar.kernel import assemble_elements, recover_stress
from swgpar.materials import Material


def pinch(mesh: ElementMesh, angle: np.ndarray) -> tuple[float, float]:
    """Quarter of a pinched thin ring, R = 58, t = b = 1, E = 210e3: changes of the diameters along
    and across the load.

    angle : (n,) rad of the nodes, 0 under the force. In units of P R^3 / (E I).
    """
    top, side = angle < 1e-9, angle > 0.5 * np.pi - 1e-9
    fixed = np.zeros_like(mesh.points, dtype=bool)
    fixed[top, 0] = fixed[side, 1] = True
    fixed[0, 2] = True
    load, p = np.zeros_like(mesh.points), 1e-3
    load[top, 1] = 0.5 * p / top.sum()
    u = mesh.solve(fixed, np.zeros_like(load), load)
    unit = p * 58.0**3 / (210e3 / 12.0)
    return 2.0 * float(u[top, 1].mean()) / unit, -2.0 * float(u[side, 0].mean()) / unit


class ElementMesh:
    """Hexahedra (n, 8), or quadrilaterals (n, 4) with a thickness; every element its own
    reference."""

    def __init__(
        self,
        points: np.ndarray,
        elements: np.ndarray,
        material: Material,
        thickness: float = 1.0,
        incompatible: bool = True,
    ) -> None:
        self.points, self.elements = points, np.ascontiguousarray(elements, dtype=np.int32)
        n, self.m = elements.shape
        self.reference = element_matrices(points[elements], material, thickness, incompatible)
        self.arrays = (
            np.arange(n, dtype=np.int32),
            np.tile([1.0, 0.0], (n, 1)),
            self.elements,
            np.zeros((n, self.m), np.uint8),
        )
        row, col = np.repeat(self.elements, self.m, axis=1), np.tile(self.elements, (1, self.m))
        keys, slot = np.unique(
            row.ravel().astype(np.int64) * len(points) + col.ravel(), return_inverse=True
        )
        self.slot = slot.reshape(n, self.m**2)
        row, self.column = np.divmod(keys, len(points))
        self.start = np.searchsorted(row, np.arange(len(points) + 1))

    def residual(self, u: np.ndarray) -> np.ndarray:
        out = np.zeros_like(u)
        assemble_elements(self.reference, *self.arrays, u, out, None, None)
        return out

    def blocks(self, u: np.ndarray) -> np.ndarray:
        """The tangent's blocks (n_blocks, 3, 3) N/mm, row by row as `start` and `column` say."""
        values = np.zeros((len(self.column), 3, 3))
        assemble_elements(self.reference, *self.arrays, u, None, self.slot, values)
        return values.transpose(0, 2, 1)

    def tangent(self, u: np.ndarray) -> csr_matrix:
        """(3 n, 3 n) N/mm; rows and columns of z are zero in the plane."""
        return bsr_matrix((self.blocks(u), self.column, self.start), shape=(u.size, u.size)).tocsr()

    def stress(self, u: np.ndarray) -> np.ndarray:
        return recover_stress(self.reference, *self.arrays, u)

    def solve(
        self, fixed: np.ndarray, value: np.ndarray, load: np.ndarray, iterations: int = 1
    ) -> np.ndarray:
        """Newton's iteration; `fixed` (n, 3) bool, prescribed `value`, `load` (n, 3)."""
        u = np.where(fixed, value, 0.0)
        held = fixed.copy()
        if self.m == 4:
            held[:, 2] = True
        free = np.flatnonzero(~held.ravel())
        for _ in range(iterations):
            r = (load - self.residual(u)).ravel()[free]
            u.ravel()[free] += spsolve(self.tangent(u)[free][:, free].tocsc(), r)
        return u

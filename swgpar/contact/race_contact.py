"""Frictionless contact of the outer race of a bearing with the inner surface of the flexible
spline.

The gap of a point x of the spline is its distance from the smooth curve X(lambda) of the race's
outer surface at the same z, in the plane across the axis: g = n . (x - X) where x - X is normal to
the curve. With dr = dx - dX, a = dr . X', b = n . dX', m = X' . X' and k = n . X'' its
differentials are

    dg = n . dr,    d²g = -(k a² + 2 m a b + m g b²) / (m (m - g k)).

Race and spline slide on each other by some hundredths of a millimetre. A point of the spline
therefore stays with the piece of the curve that it touches in the undeformed state, which is
continued beyond its ends.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from swgpar.contact.contact import NO_KEYS, FacePressure
from swgpar.contact.enforcement import PressedPoints
from swgpar.contact.face_quadrature import FaceQuadrature
from swgpar.contact.smooth_curve import NODES, curve_nodes, foot_points, smooth_curve
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import to_images, to_owners
from swgpar.kernel import add_face_blocks
from swgpar.load.load_states import LoadState

LAYERS = 2
"""Nodes of the race along z that a point of the spline touches."""


class RaceContact(PressedPoints):
    """Face quadrature of the spline's inner surface against the race's outer one; meets
    `PenaltyContact`.

    Parameters
    ----------
    spline, race : elements of both bodies, bound to local nodes; their sectors are opposite each
    other
    grid : (n_around + 1, n_z) nodes of a race's sector on its outer surface, clockwise side first
    column, layer : (n_face,) places in the grid of the cells opposite the spline's faces ``inner``;
    layer -1 where the race does not reach
    half_width : mm, of the race;  radius : mm, of the surface
    relief : gives the gap (n,) mm at z (n,) mm in the undeformed state
    n_quadrature : Gauss points per direction;  penalty : MPa / mm
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term

    Attributes
    ----------
    conn : (n_face, 12) local nodes of the spline's face and of the race's curve on two layers
    """

    def __init__(
        self,
        spline: BodyElements,
        race: BodyElements,
        *,
        grid: np.ndarray,
        column: np.ndarray,
        layer: np.ndarray,
        half_width: float,
        radius: float,
        relief: Callable[[np.ndarray], np.ndarray],
        n_quadrature: int,
        penalty: float,
        pressure_limit: float,
    ) -> None:
        self.pressure_limit = pressure_limit
        sectors = (
            np.arange(len(spline.sectors))
            if spline.preceding.any()
            else np.arange(len(spline.sectors))[spline.owned]
        )
        points = FaceQuadrature(spline, "inner", radius, n_quadrature, sectors)
        sector, column, layer = (
            np.repeat(sectors, len(column)),
            np.tile(column, len(sectors)),
            np.tile(layer, len(sectors)),
        )
        chosen = (layer >= 0) & self._reach_owned_nodes(spline, sector, column, len(grid) - 1)
        sector, column, layer = sector[chosen], column[chosen], layer[chosen]
        self.owned = (sector >= spline.owned.start) & (sector < spline.owned.stop)
        sector, nodes = curve_nodes(grid, sector, column)
        nodes = np.stack(
            [np.take_along_axis(nodes, (layer + k)[:, None, None], axis=2)[..., 0] for k in (0, 1)],
            axis=2,
        )
        sector, shape = sector[..., None], (len(sector), NODES * LAYERS)
        self.conn = np.hstack([points.conn[chosen], race.local[sector, nodes].reshape(shape)])
        self.sixths = np.hstack([points.sixths[chosen], race.sixths[sector, nodes].reshape(shape)])
        of_race = race.positions()[sector, nodes]
        self.coords = np.concatenate([points.coords[chosen], of_race.reshape(*shape, 3)], axis=1)
        self.shape, position = points.shape, points.position[chosen]
        self.inside = np.abs(position[..., 2]) <= half_width
        self.weight = points.weight[chosen]
        super().__init__(self.weight.shape, penalty)
        self.offset = points.offset[chosen] + relief(position[..., 2].ravel()).reshape(
            self.weight.shape
        )
        self.polynomials = smooth_curve(of_race[:, :, 0, :2])
        low, high = of_race[:, 1, 0, 2], of_race[:, 1, 1, 2]
        upper = (position[..., 2] - low[:, None]) / (high - low)[:, None]
        self.layers = np.stack([1.0 - upper, upper], axis=-1)
        start, end = of_race[:, 1, 0, None, :2], of_race[:, 2, 0, None, :2]
        self.first_place = np.sum((position[..., :2] - start) * (end - start), axis=-1) / np.sum(
            (end - start) ** 2, axis=-1
        )

    @staticmethod
    def _reach_owned_nodes(
        spline: BodyElements, sector: np.ndarray, column: np.ndarray, n: int
    ) -> np.ndarray:
        """Which faces reach nodes of this rank: its own, two columns before them and one behind."""
        first, end = spline.owned.start, spline.owned.stop
        own = (sector >= first) & (sector < end)
        return own | ((sector == first - 1) & (column >= n - 2)) | ((sector == end) & (column == 0))

    def is_active(self, state: LoadState) -> bool:
        """With the cam."""
        return state.cam_clearance is not None

    def owned_pressure(self) -> FacePressure:
        """Pressures of the last evaluation on owned faces of the flexible spline."""
        own = self.owned
        return FacePressure(self.conn[own, :4], self.shape, self.weight[own], self.pressure[own])

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Compute gaps and pressures at u (n_local, 3) mm; add to residual (n_local, 3) N and to
        the tangent's rows.

        Returns no keys: the problem has room for all faces.
        """
        if not self.is_active(state):
            return NO_KEYS
        touching, vectors, curvature = self._find_gaps(u)
        if residual is not None:
            self._add_forces(vectors, touching, residual)
        if rows is not None:
            self._add_blocks(vectors, curvature, touching, rows)
        return NO_KEYS

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the faces that this rank owns to residual (n_local, 3) N."""
        if self.is_active(state):
            touching, vectors, _ = self._find_gaps(u)
            own = self.owned[touching]
            self._add_forces(vectors[own], touching[own], residual)

    def _find_gaps(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Set gaps and pressures.

        Returns the faces (n,) that touch, and of these dg, a and b (n, n_q, 12, 2, 3) by the nodes'
        displacements, and the factors (n, n_q, 3, 3) of their products in d²g.
        """
        x = (self.coords + to_images(u[self.conn], self.sixths))[..., :2]
        point = np.einsum("qa,fai->fqi", self.shape, x[:, :4])
        curve = np.einsum("fqk,fnki->fqni", self.layers, x[:, 4:].reshape(len(x), NODES, LAYERS, 2))
        foot = foot_points(self.polynomials[:, None], curve, point, self.first_place)
        self.set_gap(np.sum(foot.normal * foot.away, axis=-1) + self.offset, self.inside)
        touching = self.touching_faces()
        foot, layers = foot[touching], self.layers[touching]
        value, rate = foot.shape_functions()
        tangent, normal = foot.tangent, foot.normal
        length = np.sum(tangent * tangent, axis=-1)
        distance, k = (np.sum(normal * one, axis=-1) for one in (foot.away, foot.bend))

        def on_race(weights: np.ndarray) -> np.ndarray:
            return (weights[..., None] * layers[:, :, None]).reshape(
                *weights.shape[:2], NODES * LAYERS
            )

        own = np.broadcast_to(self.shape, (len(touching), *self.shape.shape))
        relative = np.concatenate([own, -on_race(value)], axis=2)
        turn = np.concatenate([np.zeros_like(own), on_race(rate)], axis=2)
        vectors = np.stack(
            [
                relative[..., None] * normal[:, :, None],
                relative[..., None] * tangent[:, :, None],
                turn[..., None] * normal[:, :, None],
            ],
            axis=-1,
        )
        factors = np.zeros((*length.shape, 3, 3))
        factors[..., 1, 1], factors[..., 2, 2] = k, length * distance
        factors[..., 1, 2] = factors[..., 2, 1] = length
        return touching, vectors, -factors / (length * (length - distance * k))[..., None, None]

    def _add_forces(self, vectors: np.ndarray, faces: np.ndarray, residual: np.ndarray) -> None:
        force = (self.pressure * self.weight)[faces]
        nodal = np.zeros((*self.conn[faces].shape, 3))
        nodal[..., :2] = -np.einsum("fq,fqai->fai", force, vectors[..., 0])
        np.add.at(residual, self.conn[faces], to_owners(nodal, self.sixths[faces]))

    def _add_blocks(
        self, vectors: np.ndarray, curvature: np.ndarray, faces: np.ndarray, rows: BlockRows
    ) -> None:
        """Add the tangent: penalty times dg times dg, less the pressure times d²g."""
        force = (self.pressure * self.weight)[faces]
        factors = (
            -np.minimum(force, self.pressure_limit * self.weight[faces])[..., None, None]
            * curvature
        )
        factors[..., 0, 0] = np.where(
            self.pressure[faces] > 0.0, self.penalty * self.weight[faces], 0.0
        )
        n, n_nodes = self.conn[faces].shape
        flat = vectors.reshape(*vectors.shape[:2], 2 * n_nodes, 3)
        plane = np.einsum("fqmk,fqkl,fqnl->fmn", flat, factors, flat, optimize=True)
        blocks = np.zeros((n, n_nodes, n_nodes, 3, 3))
        blocks[..., :2, :2] = plane.reshape(n, n_nodes, 2, n_nodes, 2).transpose(0, 1, 3, 2, 4)
        add_face_blocks(self.conn[faces], self.sixths[faces], blocks, rows)

"""Balls between the rigid inner race on the cam and the elastic outer race; Hertz's springs, see
`point_contact`.

A ball lies on the line through its centre along the normals of the grooves. Where this line meets
the outer race's inner surface, nu is the height of the surface above its place when the race's
outer surface is on the cam's curve. The ball's approach is delta = max(0, -nu - clearance), its
energy 2/5 K delta^2.5. The forces on the race and the tangent are the derivatives of that energy,
so that the forces are normal to the race's surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.contact import NO_KEYS
from swgpar.contact.point_contact import BallSpring
from swgpar.contact.smooth_curve import NODES, STEPS, shape_functions, smooth_curve
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.bearing import BallLines
from swgpar.geometry.rotation import rotated, to_images, to_owners
from swgpar.kernel import add_face_blocks
from swgpar.load.load_states import LoadState

TIE = 1e-7
"""Share of a piece of the race by which its ends are shifted, so that a ball on a node belongs to
one piece only."""

POINTS, KERNEL_MOMENT = 8, 0.2
"""Gauss points over the reach; second moment of its weight 3/4 (1 - s²), -1 <= s <= 1."""

LARGEST_REACH = 0.35
"""Largest reach over a sector: a rank sees one sector beyond its own, in which windows of two
balls' reach must end."""


@dataclass(frozen=True)
class BallSet:
    """The balls of a bearing.

    number : of balls;  diameter, clearance : mm;  first_angle : rad, from +y, of ball 0 before the
    rotation; the clearance is below 0 of balls with a preload and of those that have grown
    cage_speed : of the cage over that of the wave generator
    lines : places of the balls;  spring : of a ball
    """

    number: int
    diameter: float
    clearance: float
    first_angle: float
    cage_speed: float
    lines: BallLines
    spring: BallSpring

    def angles(self, rotation: float) -> np.ndarray:
        """Angles (number,) rad of all balls from +y, counter-clockwise, at a rotation (rad) of the
        wave generator."""
        spacing = 2.0 * np.pi / self.number
        return self.first_angle + self.cage_speed * rotation + spacing * np.arange(self.number)


@dataclass(frozen=True)
class _Touch:
    """Balls on the race as this rank sees it: n of them, each on m nodes around.

    ball, first : (n,) indices of the balls, and of the first of their nodes;  owned : (n,) bool, of
    this rank
    approach : (n,) mm, negative with a gap
    gradient : (n, m, 2) of nu by the nodes, in the plane;  place_gradient : (n, m, 2) of the ball's
    place phi
    bend : (n, m, 2) of the rise of nu by phi;  curvature : (n,) mm, of nu by phi twice
    """

    ball: np.ndarray
    first: np.ndarray
    owned: np.ndarray
    approach: np.ndarray
    gradient: np.ndarray
    place_gradient: np.ndarray
    bend: np.ndarray
    curvature: np.ndarray


class BallContact:
    """All balls on the inner surface of the outer race; meets the protocol `Contact`.

    Hertz's approach includes what the surface yields right below the ball. So the race carries the
    force like a beam, spread over a `reach` around the ball, on the smooth curve through its nodes
    (`smooth_curve`).

    Parameters
    ----------
    body : elements of the outer race, bound to local nodes
    balls : of the bearing
    groove : (n_around + 1, n_z) nodes of a sector's inner surface, clockwise side first
    spread : (n_z,) share of a ball's force by z
    reach : mm, up to `LARGEST_REACH` of a sector

    Attributes
    ----------
    windows : (n_window, m n_z) local nodes that a ball may touch at once
    """

    def __init__(
        self,
        body: BodyElements,
        balls: BallSet,
        *,
        groove: np.ndarray,
        spread: np.ndarray,
        reach: float,
    ) -> None:
        self.balls, self.spread, self.reach = balls, spread, reach
        n, n_sectors = len(groove) - 1, len(body.sectors)
        column = np.arange(n * n_sectors + 1 if n_sectors else 0)
        sector = np.minimum(column // n, n_sectors - 1)
        nodes = groove[column - n * sector]
        sector = sector[:, None]
        self.conn, self.sixths = body.local[sector, nodes], body.sixths[sector, nodes]
        self.coords = body.positions()[sector, nodes]
        layout, local = body.layout, body.layout.mesh.coords[groove[:, 0]]
        pitch, at = layout.mesh.pitch, np.arctan2(-local[:, 0], local[:, 1])
        origin = layout.chain_angle(body.sectors[0]) if n_sectors else 0.0
        self.angle = origin + (column // n) * pitch + np.where(column % n, at[column % n], at[0])
        self.own_range = n * body.owned.start, n * body.owned.stop
        self.alone = not body.preceding.any()
        radius = float(np.hypot(*local[0, :2]))
        point, weight = np.polynomial.legendre.leggauss(POINTS)
        weight = weight * (1.0 - point**2)
        self.kernel_weight, self.kernel_angle = weight / weight.sum(), point * reach / radius
        pieces = np.arange(max(len(column) - 3, 0))[:, None] + np.arange(NODES)
        self.polynomials = smooth_curve(
            np.einsum("fnzi,z->fni", self.coords[pieces], spread)[..., :2]
        )
        span = 2.0 * reach / radius / np.diff(at).min()
        self.n_nodes = min(int(np.ceil(span)) + NODES, len(column))
        windows = np.arange(len(column) - self.n_nodes + 1 if n_sectors else 0)[
            :, None
        ] + np.arange(self.n_nodes)
        self.windows = self.conn[windows].reshape(len(windows), self.n_nodes * len(spread))
        self.touch: _Touch | None = None

    def is_active(self, state: LoadState) -> bool:
        """With the cam."""
        return state.cam_clearance is not None

    def active_sets(self) -> list[np.ndarray]:
        """Balls that carry in the last evaluation on this rank."""
        carries = np.zeros(self.balls.number, dtype=bool)
        if self.touch is not None:
            carries[self.touch.ball[self.touch.approach > 0.0]] = True
        return [carries]

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces and the stiffness of the balls; see `Contact`.

        Raises FloatingPointError where the race has passed the centre of a ball.
        """
        if not self.is_active(state):
            return NO_KEYS
        self.touch = touch = self._find(u, state)
        if (touch.approach > 0.5 * self.balls.diameter).any():
            raise FloatingPointError("the outer race has passed the centre of a ball")
        carries = np.flatnonzero(touch.approach > 0.0)
        if residual is not None:
            self._add_forces(touch, carries, residual)
        if rows is not None:
            self._add_blocks(touch, carries, rows)
        return NO_KEYS

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the balls that this rank owns."""
        if self.is_active(state):
            touch = self._find(u, state)
            self._add_forces(touch, np.flatnonzero((touch.approach > 0.0) & touch.owned), residual)

    def _find(self, u: np.ndarray, state: LoadState) -> _Touch:
        """Balls on the race at u (n_local, 3)."""
        field = to_images(u[self.conn], self.sixths)
        nodes = np.einsum("nzi,z->ni", self.coords + field, self.spread)[:, :2]
        centre, normal, curvature = self.balls.lines(self.balls.angles(state.angle) - state.angle)
        centre, normal = rotated(centre, state.angle), rotated(normal, state.angle)
        along = np.column_stack([-normal[:, 1], normal[:, 0]])
        away = nodes[None] - centre[:, None]
        tau, nu = np.einsum("bni,bi->bn", away, along), np.einsum("bni,bi->bn", away, normal)
        from_axis = nu + np.einsum("bi,bi->b", centre, normal)[:, None]
        ball, piece = self._crossed(tau, from_axis)
        tau = tau[ball]
        nu = nu[ball]
        n = normal[ball]
        t = along[ball]
        place = self.angle[piece]
        for _ in range(STEPS):
            value, rate, _ = self._shape_functions(place)
            place = place - np.sum(value * tau, axis=1) / np.sum(rate * tau, axis=1)
        value, rate, second = self._shape_functions(place)
        along_rate = np.sum(rate * tau, axis=1)
        slope = np.sum(rate * nu, axis=1) / along_rate
        # the mean over the reach lies inside of the race's surface, which is curved as the groove
        # is
        inner = curvature[ball] / (1.0 + 0.5 * curvature[ball] * self.balls.diameter)
        surface = np.sum(value * nu, axis=1) + 0.5 * inner * self.reach**2 * KERNEL_MOMENT
        first = np.minimum((value != 0.0).argmax(axis=1), len(self.angle) - self.n_nodes)
        window = first[:, None] + np.arange(self.n_nodes)
        value, rate = (
            np.take_along_axis(weights, window, axis=1)[..., None] for weights in (value, rate)
        )
        tilted = (n - slope[:, None] * t)[:, None]
        return _Touch(
            ball=ball,
            first=first,
            owned=(piece >= self.own_range[0]) & (piece < self.own_range[1]),
            approach=0.5 * self.balls.diameter
            - surface
            - self.balls.clearance
            - state.cam_clearance,
            gradient=value * tilted,
            place_gradient=-(value / along_rate[:, None, None]) * t[:, None],
            bend=rate * tilted,
            curvature=np.sum(second * (nu - slope[:, None] * tau), axis=1),
        )

    def _crossed(self, tau: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Balls (n,) and the pieces (n,) of the race between two nodes that their lines cross.

        tau, height : (n_ball, n_node) mm, of the nodes across the lines, and along them from the
        axis
        """
        shift = TIE * np.diff(tau, axis=1)
        crossed = (tau[:, :-1] <= shift) & (tau[:, 1:] > shift) & (height[:, 1:] > 0.0)
        # without neighbours every ball is this rank's; with them those that reach its nodes come
        # along
        more = 0 if self.alone else self.n_nodes // 2 + 1
        outside = np.ones(crossed.shape[1], dtype=bool)
        outside[max(self.own_range[0] - more, 0) : self.own_range[1] + more] = False
        crossed[:, outside] = False
        ball, piece = np.nonzero(crossed)
        return ball, piece

    def _shape_functions(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Weights (n, n_node) of all nodes in the means around places (n,) rad, and their
        derivatives by the place."""
        value, rate, second = np.zeros((3, len(place), len(self.angle)))
        ball = np.arange(len(place))
        at = place + self.kernel_angle[:, None]
        piece = np.clip(np.searchsorted(self.angle, at, side="right") - 1, 1, len(self.angle) - 3)
        length = self.angle[piece + 1] - self.angle[piece]
        at_place = shape_functions(self.polynomials[piece - 1], (at - self.angle[piece]) / length)
        for order, (total, weights) in enumerate(zip((value, rate, second), at_place)):
            weights = weights * (self.kernel_weight[:, None] / length**order)[..., None]
            for k in range(NODES):
                np.add.at(total, (ball, piece - 1 + k), weights[..., k])
        return value, rate, second

    def _nodes(self, touch: _Touch, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Local nodes and image flags (n, m n_z) of chosen balls."""
        window, size = (
            touch.first[chosen][:, None] + np.arange(self.n_nodes),
            self.n_nodes * len(self.spread),
        )
        conn, sixths = (
            values[window].reshape(len(chosen), size) for values in (self.conn, self.sixths)
        )
        return np.ascontiguousarray(conn), np.ascontiguousarray(sixths)

    def _add_forces(self, touch: _Touch, chosen: np.ndarray, residual: np.ndarray) -> None:
        force = self.balls.spring.force(touch.approach[chosen])
        nodes = -force[:, None, None] * touch.gradient[chosen]
        conn, sixths = self._nodes(touch, chosen)
        nodal = np.zeros((len(chosen), self.n_nodes, len(self.spread), 3))
        nodal[..., :2] = nodes[:, :, None] * self.spread[:, None]
        np.add.at(residual, conn, to_owners(nodal.reshape(*conn.shape, 3), sixths))

    def _add_blocks(self, touch: _Touch, chosen: np.ndarray, rows: BlockRows) -> None:
        """The Hessian of the energy: F' grad grad^T - F Hessian of nu."""
        approach, k = touch.approach[chosen], self.balls.spring.stiffness
        force, rate = k * approach**1.5, 1.5 * k * np.sqrt(approach)
        gradient, shift, bend = (
            touch.gradient[chosen],
            touch.place_gradient[chosen],
            touch.bend[chosen],
        )

        def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return np.einsum("nai,nbj->nabij", a, b)

        hessian = outer(shift, bend) + outer(bend, shift)
        hessian += touch.curvature[chosen][:, None, None, None, None] * outer(shift, shift)
        core = rate[:, None, None, None, None] * outer(gradient, gradient)
        core -= force[:, None, None, None, None] * hessian
        conn, sixths = self._nodes(touch, chosen)
        n, m, n_z = len(chosen), self.n_nodes, len(self.spread)
        blocks = np.zeros((n, m, n_z, m, n_z, 3, 3))
        blocks[..., :2, :2] = np.einsum("nabij,y,z->naybzij", core, self.spread, self.spread)
        add_face_blocks(
            conn, sixths, np.ascontiguousarray(blocks.reshape(n, m * n_z, m * n_z, 3, 3)), rows
        )

    def owned_forces(self) -> np.ndarray:
        """Forces (n,) N of the balls of this rank in the last evaluation."""
        return self.balls.spring.force(self.owned_loads()[1])

    def owned_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Indices (n,) of the balls of this rank in the last evaluation, and their approaches (n,)
        mm."""
        if self.touch is None:
            return np.zeros(0, dtype=np.int64), np.zeros(0)
        return self.touch.ball[self.touch.owned], self.touch.approach[self.touch.owned]

"""Balls between the rigid inner race on the cam and the elastic outer race; Hertz's springs, see `point_contact`.

A ball lies on the line through its centre along the normals of the grooves. Where this line meets the outer race's inner
surface, the surface is at the height nu above the place that it has when the race's outer surface is on the cam's curve.
The ball's approach is delta = max(0, -nu - clearance), its energy 2/5 K delta^2.5. The forces on the race and the
tangent are the derivatives of that energy, so that the forces are normal to the race's surface.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.contact.contact import NO_KEYS
from swgpar.contact.point_contact import BallSpring
from swgpar.contact.smooth_curve import NODES, STEPS, curve_nodes, shape_functions, smooth_curve
from swgpar.design.load_states import LoadState
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import HALF_TURN, rotated
from swgpar.kernel import add_face_blocks

TIE = 1e-7
"""Share of a facet by which the ends of facets are shifted, so that a ball on a node belongs to one facet on all ranks."""

BallLines = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Gives centres (n, 2) mm and groove normals (n, 2) in the cam's frame at angles (n,) rad from the major axis."""


@dataclass(frozen=True)
class BallSet:
    """The balls of a bearing.

    number : of balls;  diameter, clearance : mm;  first_angle : rad, from +y, of ball 0 before the rotation
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
        """Angles (number,) rad of all balls from +y, counter-clockwise, at a rotation (rad) of the wave generator."""
        spacing = 2.0 * np.pi / self.number
        return self.first_angle + self.cage_speed * rotation + spacing * np.arange(self.number)


@dataclass(frozen=True)
class _Touch:
    """Balls on facets of this rank: n of them.

    ball, facet : (n,) indices;  approach : (n,) mm, negative with a gap
    gradient : (n, 4, 2) of nu by the nodes of the facet and the next ones, in the plane
    share_gradient : (n, 4, 2) of the ball's place lambda on the facet
    bend : (n, 4, 2) of the rise of nu along the facet, at the ball's place;  curvature : (n,) mm, of nu by lambda twice
    """

    ball: np.ndarray
    facet: np.ndarray
    approach: np.ndarray
    gradient: np.ndarray
    share_gradient: np.ndarray
    bend: np.ndarray
    curvature: np.ndarray


class BallContact:
    """All balls on the inner surface of the outer race; meets the protocol `Contact`.

    The surface is the smooth curve through the nodes (`smooth_curve`).

    Parameters
    ----------
    body : elements of the outer race, bound to local nodes
    balls : of the bearing
    groove : (n_around + 1, n_z) nodes of a sector's inner surface, clockwise side first
    spread : (n_z,) share of a ball's force by z

    Attributes
    ----------
    conn : (n_facet, 4 n_z) local nodes of the facets and the next ones on either side
    """

    def __init__(self, body: BodyElements, balls: BallSet, *, groove: np.ndarray, spread: np.ndarray) -> None:
        self.balls, self.spread = balls, spread
        first, end, n = body.owned.start, body.owned.stop, len(groove) - 1
        # facets count from the first sector seen; those of other ranks that reach nodes of this one come along
        alone = not body.preceding.any()
        facets = np.arange(n * first, n * end) if alone else np.arange(n * first - 2, n * end + 1)
        facets = facets if end > first else np.zeros(0, dtype=np.int64)
        self.owned = (facets >= n * first) & (facets < n * end)
        sector, nodes = curve_nodes(groove, *np.divmod(facets, n))
        shape = (len(facets), NODES * len(spread))
        self.conn = np.ascontiguousarray(body.local[sector[..., None], nodes].reshape(shape))
        self.flip = np.ascontiguousarray(body.flip[sector[..., None], nodes].reshape(shape))
        self.coords = body.positions()[sector[..., None], nodes].reshape(*shape, 3)
        self.polynomials = smooth_curve(self._mean(self.coords))
        self.multiplier = np.zeros((0, 1))
        self.touch: _Touch | None = None

    def _mean(self, field: np.ndarray) -> np.ndarray:
        """Means (n, 4, 2) over z, in the plane, of values (n, 4 n_z, 3) at the nodes of facets."""
        return np.einsum("fnzi,z->fni", field.reshape(len(field), NODES, len(self.spread), 3), self.spread)[..., :2]

    def is_active(self, state: LoadState) -> bool:
        """With the cam."""
        return state.cam_clearance is not None

    def reset(self) -> None:
        """Nothing is to be forgotten."""

    def scale_penalty(self, share: float) -> None:
        """Balls are no penalty."""

    def augment(self) -> None:
        """There are no multipliers."""

    def penetration(self) -> float:
        """Zero: the approach of a ball is elastic."""
        return 0.0

    def active_sets(self) -> list[np.ndarray]:
        """Balls that carry in the last evaluation on this rank."""
        carries = np.zeros(self.balls.number, dtype=bool)
        if self.touch is not None:
            carries[self.touch.ball[self.touch.approach > 0.0]] = True
        return [carries]

    def owned_pressure(self) -> None:
        """None on the flexible spline."""

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces and the stiffness of the balls; see `Contact`."""
        if not self.is_active(state):
            return NO_KEYS
        self.touch = touch = self._find(u, state)
        carries = np.flatnonzero(touch.approach > 0.0)
        if residual is not None:
            self._add_forces(touch, carries, residual)
        if rows is not None:
            self._add_blocks(touch, carries, rows)
        return NO_KEYS

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces on the facets that this rank owns."""
        if self.is_active(state):
            touch = self._find(u, state)
            self._add_forces(touch, np.flatnonzero((touch.approach > 0.0) & self.owned[touch.facet]), residual)

    def _find(self, u: np.ndarray, state: LoadState) -> _Touch:
        """Balls on the facets of this rank at u (n_local, 3)."""
        field = u[self.conn]
        field[self.flip == 1] *= HALF_TURN
        nodes = self._mean(self.coords + field)
        centre, normal = self.balls.lines(self.balls.angles(state.angle) - state.angle)
        centre, normal = rotated(centre, state.angle), rotated(normal, state.angle)
        along = np.column_stack([-normal[:, 1], normal[:, 0]])
        away = nodes[None, :, 1:3] - centre[:, None, None]  # (ball, facet, end, 2)
        tau, nu = np.einsum("bfei,bi->bfe", away, along), np.einsum("bfei,bi->bfe", away, normal)
        shift = TIE * (tau[..., 1] - tau[..., 0])
        ball, facet = np.nonzero((tau[..., 0] <= shift) & (tau[..., 1] > shift) & (nu.sum(axis=2) > 0.0))
        away, n, t = nodes[facet] - centre[ball][:, None], normal[ball], along[ball]
        tau, nu = np.einsum("mni,mi->mn", away, t), np.einsum("mni,mi->mn", away, n)
        polynomials = self.polynomials[facet]
        share = _place(np.einsum("mnp,mn->mp", polynomials, tau))
        value, rate, second = shape_functions(polynomials, share)
        along_rate, rise = np.sum(rate * tau, axis=1), np.sum(rate * nu, axis=1)
        slope = rise / along_rate
        tilted = n - slope[:, None] * t
        return _Touch(
            ball=ball,
            facet=facet,
            approach=0.5 * self.balls.diameter - np.sum(value * nu, axis=1) - self.balls.clearance - state.cam_clearance,
            gradient=value[..., None] * tilted[:, None],
            share_gradient=-(value / along_rate[:, None])[..., None] * t[:, None],
            bend=rate[..., None] * tilted[:, None],
            curvature=np.sum(second * (nu - slope[:, None] * tau), axis=1),
        )

    def _add_forces(self, touch: _Touch, chosen: np.ndarray, residual: np.ndarray) -> None:
        force = self.balls.spring.force(touch.approach[chosen])
        nodes = -force[:, None, None] * touch.gradient[chosen]
        nodal = np.zeros((len(chosen), NODES, len(self.spread), 3))
        nodal[..., :2] = nodes[:, :, None] * self.spread[:, None]
        nodal = nodal.reshape(len(chosen), NODES * len(self.spread), 3)
        conn = self.conn[touch.facet[chosen]]
        nodal[self.flip[touch.facet[chosen]] == 1] *= HALF_TURN
        np.add.at(residual, conn, nodal)

    def _add_blocks(self, touch: _Touch, chosen: np.ndarray, rows: BlockRows) -> None:
        """The Hessian of the energy: F' grad grad^T - F Hessian of nu."""
        approach, k = touch.approach[chosen], self.balls.spring.stiffness
        force, rate = k * approach**1.5, 1.5 * k * np.sqrt(approach)
        gradient, shift, bend = touch.gradient[chosen], touch.share_gradient[chosen], touch.bend[chosen]

        def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return np.einsum("nai,nbj->nabij", a, b)

        hessian = outer(shift, bend) + outer(bend, shift)
        hessian += touch.curvature[chosen][:, None, None, None, None] * outer(shift, shift)
        core = rate[:, None, None, None, None] * outer(gradient, gradient)
        core -= force[:, None, None, None, None] * hessian
        n, n_z = len(chosen), len(self.spread)
        blocks = np.zeros((n, NODES, n_z, NODES, n_z, 3, 3))
        blocks[..., :2, :2] = np.einsum("nabij,y,z->naybzij", core, self.spread, self.spread)
        facet = touch.facet[chosen]
        blocks = np.ascontiguousarray(blocks.reshape(n, NODES * n_z, NODES * n_z, 3, 3))
        add_face_blocks(self.conn[facet], self.flip[facet], blocks, rows)

    def owned_loads(self) -> tuple[np.ndarray, np.ndarray]:
        """Indices (n,) of the balls on facets of this rank in the last evaluation, and their approaches (n,) mm."""
        if self.touch is None:
            return np.zeros(0, dtype=np.int64), np.zeros(0)
        own = self.owned[self.touch.facet]
        return self.touch.ball[own], self.touch.approach[own]


def _place(cubic: np.ndarray) -> np.ndarray:
    """Root lambda (n,), in 0 to 1, of nearly straight cubics (n, 4)."""
    place = -cubic[:, 0] / cubic[:, 1:].sum(axis=1)
    for _ in range(STEPS):
        value = cubic[:, 0] + place * (cubic[:, 1] + place * (cubic[:, 2] + place * cubic[:, 3]))
        place = place - value / (cubic[:, 1] + place * (2.0 * cubic[:, 2] + 3.0 * place * cubic[:, 3]))
    return place

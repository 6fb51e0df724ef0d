"""Friction between flanks: tangent, frame indifference, blocks that stick and slip."""

from __future__ import annotations

import numpy as np
import pytest

from support.contact_blocks import Blocks, Rows, block, master
from swgpar.contact import friction
from swgpar.contact.flank_pairs import Faces, PlacedFaces
from swgpar.contact.segments import SAMPLES, Segments, bilinear, face_corners
from swgpar.kernel import contact_flanks
from swgpar.materials import Isotropic

PENALTY = 4e6
NO_MULTIPLIER = np.zeros((1, 9))
SETTINGS = (NO_MULTIPLIER, PENALTY, 0.0, 1.0, np.inf)


class Arc:
    """One tilted face pressed into an arc of radius 2 with random nodal displacements, and a random
    history."""

    def __init__(self, coefficient: float, gap_before: float) -> None:
        rng = np.random.default_rng(4)
        angle = np.linspace(-0.4, 0.4, 5)
        points = 2.0 * np.column_stack([np.sin(angle), np.cos(angle)])
        tangents = np.column_stack([np.cos(angle), -np.sin(angle)])
        s, z = 2.0 * (angle + 0.4), np.linspace(-0.5, 0.5, 4)
        self.flanks = master(points, tangents, s, z, 4)
        corners = np.array(
            [[-0.15, 2.0, -0.2], [0.15, 1.98, -0.2], [0.15, 1.99, 0.2], [-0.15, 1.98, 0.2]]
        )
        t, w = np.polynomial.legendre.leggauss(3)
        a, b = (v.ravel() for v in np.meshgrid(0.5 * (t + 1.0), 0.5 * (t + 1.0), indexing="ij"))
        self.faces = Faces(
            np.arange(4, dtype=np.int32)[None],
            np.zeros((1, 4), np.uint8),
            corners[None].copy(),
            np.array([[0.0, -1.0, 0.0]]),
            bilinear(a, b)[None],
            0.03 * np.outer(w, w).reshape(1, 9),
            np.zeros((1, 9)),
            np.zeros(1, np.int32),
        )
        grid = np.column_stack([np.repeat(points, len(z), axis=0), np.tile(z, len(s))])
        self.points = np.vstack([corners, grid])
        self.u = rng.uniform(-0.01, 0.01, self.points.shape)
        self.u[:4, 1] -= 0.03
        place = contact_flanks(self.flanks, self.faces, self.u, *SETTINGS, None, None)[2]
        way, old = rng.uniform(-0.02, 0.02, place.shape), rng.uniform(-1e3, 1e3, place.shape)
        self.law = friction.begin(coefficient, place - way, np.full((1, 9), gap_before), old)
        self.law.stiffness = PENALTY

    def force(self, u: np.ndarray, rows: Rows | None = None) -> np.ndarray:
        r = np.zeros_like(u)
        contact_flanks(self.flanks, self.faces, u, *SETTINGS, r, rows, self.law)
        return r


def checked_tangent(arc: Arc) -> tuple[np.ndarray, np.ndarray]:
    """Forces and tangent, which is that of differences of the forces."""
    rows, h = Rows(len(arc.u), symmetric=False), 1e-7
    r = arc.force(arc.u, rows)
    tangent = rows.matrix()
    difference = np.zeros_like(tangent)
    for k in range(arc.u.size):
        step = np.zeros(arc.u.size)
        step[k] = h
        step = step.reshape(arc.u.shape)
        difference[:, k] = (arc.force(arc.u + step) - arc.force(arc.u - step)).ravel() / (2 * h)
    assert np.abs(difference - tangent).max() < 1e-6 * np.abs(tangent).max()
    return r, tangent


@pytest.mark.parametrize("coefficient", [0.3, 1e3])
@pytest.mark.parametrize("gap_before", [-0.01, 0.02])
def test_tangent_in_slip_and_stick(coefficient: float, gap_before: float) -> None:
    r, tangent = checked_tangent(Arc(coefficient, gap_before))
    # unlike the tangent without friction this one is not symmetric: the test above sees the
    # friction
    assert np.abs(tangent - tangent.T).max() > 0.02 * np.abs(tangent).max()
    assert np.abs(r.sum(axis=0)).max() < 1e-9 * np.abs(r).max()


def test_points_that_had_no_foot_carry_no_friction() -> None:
    """Neither in the forces nor in the tangent, which kept an increment from converging when it
    did."""
    arc = Arc(0.3, 0.02)
    arc.law.foot_point[0, 4:] = np.nan
    arc.law.gap[0, 4:] = np.inf
    checked_tangent(arc)
    assert not arc.law.current[0, 4:].any() and arc.law.current[0, :4].any()
    arc.law.foot_point[:] = np.nan
    _, tangent = checked_tangent(arc)
    assert np.abs(tangent - tangent.T).max() < 1e-9 * np.abs(tangent).max()


@pytest.mark.parametrize("coefficient", [0.3, 1e3])
def test_given_pressures_in_the_law(coefficient: float) -> None:
    """They bound the tractions, also where the surfaces have parted."""
    arc = Arc(coefficient, 0.02)
    r, _ = checked_tangent(arc)
    pressure = contact_flanks(arc.flanks, arc.faces, arc.u, *SETTINGS, None, None)[1]
    traction = arc.law.current.copy()
    arc.law.lagged = pressure
    again, _ = checked_tangent(arc)
    assert np.abs(again - r).max() < 1e-12 * np.abs(r).max()
    arc.law.lagged = 0.5 * pressure
    checked_tangent(arc)
    if coefficient == 0.3:
        slips = np.linalg.norm(traction, axis=2) > 0.99 * 0.3 * pressure
        assert slips.any()
        np.testing.assert_allclose(arc.law.current[slips], 0.5 * traction[slips], rtol=0.02)
    arc.u[:4, 1] += 0.1
    parted, _ = checked_tangent(arc)
    assert not contact_flanks(arc.flanks, arc.faces, arc.u, *SETTINGS, None, None)[1].any()
    assert np.abs(parted).max() > 0.01 * np.abs(r).max()


@pytest.mark.parametrize("coefficient", [0.3, 1e3])
def test_rotation_changes_no_traction(coefficient: float) -> None:
    """Everything turned by 0.7 rad since the last converged state: the same tractions, forces
    turned alike."""
    arc = Arc(coefficient, -0.01)
    before = arc.force(arc.u)
    traction = arc.law.current.copy()
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    # the arc's exact curve does not turn with its nodes: its patch does
    arc.flanks.rotation[0] = c, s
    arc.faces.coords[:] = arc.faces.coords @ turn.T
    arc.faces.normal[:] = arc.faces.normal @ turn.T
    after = arc.force(arc.u @ turn.T)
    assert np.abs(traction).max() > 100.0
    assert np.abs(arc.law.current - traction).max() < 1e-9 * np.abs(traction).max()
    assert np.abs(after - before @ turn.T).max() < 1e-9 * np.abs(before).max()


def test_history_moves_between_cuts() -> None:
    """A linear field of tractions on one cut arrives unchanged on another one, up to the samples at
    the rim."""

    def cut(ends: list[float]) -> Segments:
        t = np.array([0.2113248654, 0.7886751346])
        low, size = np.array(ends[:-1]), np.diff(ends)
        i, j = (v.ravel() for v in np.meshgrid(range(len(low)), range(len(low)), indexing="ij"))
        ta, tb = (v.ravel() for v in np.meshgrid(t, t, indexing="ij"))
        a, b = low[i, None] + size[i, None] * ta, low[j, None] + size[j, None] * tb
        return Segments(np.zeros(len(i), dtype=np.int64), a, b, np.ones_like(a))

    def field(segments: Segments) -> np.ndarray:
        return np.stack([3.0 + segments.a - 2.0 * segments.b, segments.b], axis=-1)

    first, second = cut([0.0, 0.3, 0.5, 1.0]), cut([0.0, 0.5, 0.83, 1.0])
    samples = friction.sampled(first, field(first), 0)[None]
    error = np.abs(friction.interpolated(samples, second) - field(second)).max(axis=2)
    inside = (np.abs(second.a - 0.5) < 0.3) & (np.abs(second.b - 0.5) < 0.3)
    assert inside.sum() == 9 and error[inside].max() < 1e-12
    # the outermost points lie 0.1 from the rim, beyond which the field is constant
    assert error.max() < 0.3


class Stack:
    """A block of 3 x 3 elements on one of 4 x 4, 1 mm each, half as high; uniform pressure and
    shear in both.

    The shear's complementary tractions act on the sides, so that stresses are uniform and surfaces
    stay flat.
    """

    YOUNG, COEFFICIENT, PRESSURE = 210e3, 0.2, 1.0

    def __init__(self, slave: int = 3) -> None:
        line, fine = np.linspace(0, 1, 5), np.linspace(0, 1, slave + 1)
        self.lower, lower_hexes, lower_grid = block(line, np.linspace(0.0, 0.5, 3), line)
        self.upper, upper_hexes, self.grid = block(fine, np.linspace(0.5, 1.0, 3), fine)
        self.first = len(self.lower)
        self.points = np.vstack([self.lower, self.upper])
        self.hexes = np.vstack([lower_hexes, upper_hexes + self.first])
        flanks = master(
            np.column_stack([line, np.full(5, 0.5)]), np.tile([1.0, 0.0], (5, 1)), line, line, 0
        )
        flanks.conn[0] = lower_grid[:, -1]
        conn = face_corners(self.first + self.grid[:, 0]).astype(np.int32)
        placed = PlacedFaces(
            conn,
            np.zeros_like(conn, dtype=np.uint8),
            self.points[conn],
            np.tile([0.0, -1.0, 0.0], (slave**2, 1)),
            np.full((slave**2, 2), 1.0 / slave),
            np.zeros((slave**2, len(SAMPLES), len(SAMPLES))),
            np.zeros(slave**2, np.int32),
        )
        fixed = np.zeros(self.points.shape, dtype=bool)
        fixed[self.points[:, 1] < 1e-12] = True
        fixed[np.abs(self.points[:, 2]) < 1e-12, 2] = True
        self.u = np.zeros_like(self.points)
        self.u[self.first :, 1] = -1e-7
        self.blocks = Blocks(
            self.points,
            self.hexes,
            len(self.points),
            flanks,
            placed,
            fixed,
            Isotropic(E=self.YOUNG, nu=0.0),
            PENALTY,
            2,
            self.COEFFICIENT,
            self.u.copy(),
            np.zeros((slave**2, friction.SAMPLES, friction.SAMPLES, 2)),
        )

    def load(self, shear: float) -> np.ndarray:
        """Forces of the pressure on top, of the shear on top and sides, consistent with the
        elements' faces."""
        force = np.zeros_like(self.points)
        for axis, end, traction in (
            (1, 1.0, (shear, -self.PRESSURE, 0.0)),
            (0, 1.0, (0.0, shear, 0.0)),
            (0, 0.0, (0.0, -shear, 0.0)),
        ):
            on_side = np.abs(self.points[:, axis] - end) < 1e-12
            for corners in (self.hexes[:, f] for f in ((0, 3, 7, 4), (1, 2, 6, 5), (3, 2, 6, 7))):
                for face in corners[on_side[corners].all(axis=1)]:
                    across = self.points[face[2]] - self.points[face[0]]
                    force[face] += 0.25 * np.prod(np.delete(across, axis)) * np.array(traction)
        return force

    def shear(self, value: float) -> np.ndarray:
        """Contact force on the upper block under this shear (MPa)."""
        _, _, contact = self.blocks.press(self.u, self.load(value))
        return -contact[self.first :].sum(axis=0)


def test_blocks_stick_below_the_limit() -> None:
    """Shear up to 0.9 mu p in two increments: the displacement of one piece, but for the jump of
    the penalty."""
    stack = Stack()
    limit = stack.COEFFICIENT * stack.PRESSURE
    for share in (0.0, 0.5, 0.9):
        shear = share * limit
        force = stack.shear(shear)
        assert force == pytest.approx([-shear, stack.PRESSURE, 0.0], abs=1e-7 * stack.PRESSURE)
        jump = np.where(np.arange(len(stack.points)) < stack.first, 0.0, 1.0 / PENALTY)
        y = stack.points[:, 1]
        tied = np.column_stack(
            [shear * y / (0.5 * stack.YOUNG), -stack.PRESSURE * y / stack.YOUNG, 0.0 * y]
        )
        # the stuck jump of every increment adds up to the traction over the tangential stiffness
        tied += jump[:, None] * np.array([shear / friction.STIFFNESS, -stack.PRESSURE, 0.0])
        assert np.abs(stack.u - tied).max() < 1e-5 * np.abs(tied).max()


def test_blocks_slip_above_the_limit() -> None:
    """The top is displaced far enough to slip, then back: the tangential force is mu times the
    normal one."""
    stack = Stack()
    limit = stack.COEFFICIENT * stack.PRESSURE
    stack.shear(0.0)
    top = np.abs(stack.points[:, 1] - 1.0) < 1e-12
    stack.blocks.fixed[top, 0] = True
    for way, sign in ((1e-5, 1.0), (2e-5, 1.0), (0.0, -1.0)):
        stack.u[top, 0] = way
        force = stack.shear(sign * limit)
        assert -sign * force[0] == pytest.approx(stack.COEFFICIENT * force[1], rel=1e-8)
        assert np.abs(stack.blocks.traction[..., 0] - sign * limit).max() < 1e-3 * limit

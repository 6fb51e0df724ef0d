"""Friction between flanks: tangent, frame indifference, blocks that stick and slip."""

from __future__ import annotations

import numpy as np
import pytest

from support.contact_blocks import PAIR, Blocks, Rows, Surface, arc_block, master
from swgpar.contact import friction
from swgpar.contact.flank_faces import bilinear
from swgpar.contact.flank_pairs import Faces
from swgpar.contact.friction import CellTractions
from swgpar.contact.tangential_stiffness import ELLIPTICAL
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
        self.flanks.bulge = np.random.default_rng(1).uniform(-0.05, 0.05, self.flanks.bulge.shape)
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
        stiffness = PENALTY * rng.uniform(1.0, 1.5, (1, 9))
        gap = np.full((1, 9), gap_before)
        self.law = friction.begin(coefficient, stiffness, place - way, gap, old)

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


def tractions(ends: list[float], line: int, factor: float) -> CellTractions:
    """Cells between these ends (mm) on a line, with the means of factor (3 + s, s²)."""
    low, high = np.array(ends[:-1]), np.array(ends[1:])
    means = [3.0 + 0.5 * (low + high), (high**3 - low**3) / (3.0 * (high - low))]
    numbers = np.full(len(low), line)
    return CellTractions(numbers, low, high, factor * np.column_stack(means))


def joined(*parts: CellTractions) -> CellTractions:
    names = ("line", "low", "high", "traction")
    return CellTractions(*(np.concatenate([getattr(p, n) for p in parts]) for n in names))


def integral(cells: CellTractions, line: int) -> np.ndarray:
    of_line = cells.line == line
    return ((cells.high - cells.low)[:, None] * cells.traction)[of_line].sum(axis=0)


def test_history_moves_between_cuts() -> None:
    """Means over other cells have the same integrals, line by line; the same cells have the same
    tractions."""
    old = joined(
        tractions([0.2, 0.3, 0.5, 1.0], 1, 1.0),
        tractions([0.1, 0.4, 0.6], 3, -2.0),
    )
    new = joined(
        tractions([0.0, 0.25, 0.5, 0.83, 1.1], 1, 0.0),
        tractions([0.0, 0.35, 0.8], 3, 0.0),
        tractions([0.0, 1.0], 2, 0.0),
    )
    moved = CellTractions(new.line, new.low, new.high, old.means(new.line, new.low, new.high))
    for line in (1, 3):
        np.testing.assert_allclose(integral(moved, line), integral(old, line), rtol=1e-12)
    # a cell in the middle of an old one has its traction, one without a line none
    np.testing.assert_allclose(moved.traction[2], old.traction[2], rtol=1e-12)
    assert not moved.traction[new.line == 2].any()
    np.testing.assert_allclose(old.means(old.line, old.low, old.high), old.traction, rtol=1e-12)


class Stack:
    """A block of 3 x 4 elements on one of 4 x 4, 1 mm each, half as high; uniform pressure and
    shear in both.

    The shear's complementary tractions act on the sides, so that stresses are uniform and surfaces
    stay flat.
    """

    YOUNG, COEFFICIENT, PRESSURE = 210e3, 0.2, 1.0

    def __init__(self, slave: int = 3) -> None:
        line, fine, depth = (
            np.linspace(0, 1, 5),
            np.linspace(0, 1, slave + 1),
            np.linspace(0, 0.5, 3),
        )
        material = Isotropic(E=self.YOUNG, nu=0.0)
        lower = arc_block(line, depth, line, Surface((0.0, 0.5), 0.0, 1), material)
        upper = arc_block(fine, depth, line, Surface((0.0, 0.5), 0.0, -1), material)
        self.first = len(lower.points)
        self.points = np.vstack([lower.points, upper.points])
        self.hexes = np.vstack([lower.hexes, upper.hexes + self.first])
        fixed = np.zeros(self.points.shape, dtype=bool)
        fixed[self.points[:, 1] < 1e-12] = True
        fixed[np.abs(self.points[:, 2]) < 1e-12, 2] = True
        self.u = np.zeros_like(self.points)
        self.u[self.first :, 1] = -1e-7
        self.blocks = Blocks(
            lower,
            upper,
            fixed,
            coefficient=self.COEFFICIENT,
            before=self.u.copy(),
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
        pressed = self.blocks.press(self.u, self.load(value))
        return -pressed.contact[self.first :].sum(axis=0)


def test_blocks_stick_below_the_limit() -> None:
    """Shear up to 0.9 mu p in two increments: the displacement of one piece, but for the approach
    that the law leaves and the slip of its springs, 1.193 times as much over the tractions.

    Pressures of the cells deviate by up to 7 % from uniform ones, see test_contact.py, and by 26 %
    at the ends. So do tractions that stick, by up to 17 %: their springs depend on the pressure.
    Displacements along the surface by 0.2 % of the largest; those of a penalty were exact to 1e-5.
    """
    stack = Stack()
    limit, strain = stack.COEFFICIENT * stack.PRESSURE, stack.PRESSURE / stack.YOUNG
    y, upper = stack.points[:, 1], np.arange(len(stack.points)) >= stack.first
    for share in (0.0, 0.5, 0.9):
        shear = share * limit
        force = stack.shear(shear)
        assert force == pytest.approx([-shear, stack.PRESSURE, 0.0], abs=1e-7 * stack.PRESSURE)
        traction = stack.blocks.flanks.history.tractions[PAIR.key].traction
        assert np.abs(traction - [shear, 0.0]).max() < 0.2 * shear + 0.01 * limit
        tied = np.column_stack([2.0 * shear / stack.YOUNG * y, -strain * y, 0.0 * y])
        apart = stack.u - tied
        approach, slip = -apart[upper, 1].mean(), apart[upper, 0].mean()
        assert 0.0 < approach < 0.06 * strain
        # the slip of every increment adds up
        expected = ELLIPTICAL * approach * shear / stack.PRESSURE
        assert slip == pytest.approx(expected, rel=0.05, abs=2e-4 * strain)
        apart[upper] -= [slip, -approach, 0.0]
        assert np.abs(apart).max() < 0.004 * strain


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
        assert -sign * force[0] == pytest.approx(stack.COEFFICIENT * force[1], rel=1e-7)
        cells = stack.blocks.flanks.cells.active
        traction = cells.friction.current
        assert np.abs(traction[..., 1]).max() < 1e-3 * limit
        bound = stack.COEFFICIENT * cells.pressure
        np.testing.assert_allclose(sign * traction[..., 0], bound, rtol=1e-3)


@pytest.mark.parametrize("way", [1e-8, 2e-5])
def test_tangent_of_lines_with_friction(way: float) -> None:
    """That of differences of the forces, in stick and in slip, where the pressures that bound the
    tractions are those of the cells."""
    stack = Stack()
    stack.shear(0.0)
    top = stack.points[:, 1] > 0.5 + 1e-12
    u = stack.blocks.before.copy()
    u[stack.first :, 0] += way
    u[top] += 1e-9
    keys = stack.blocks.search(u)
    forces = stack.blocks.forces(u)
    stack.blocks.flanks.cells.freeze()
    tangent, h = stack.blocks.tangent(u, keys), 1e-11
    assert abs(tangent - tangent.T).max() > 1e-3 * abs(tangent).max() or way < 1e-6
    assert np.abs(forces.sum(axis=0)).max() < 1e-9 * np.abs(forces).sum()
    rng = np.random.default_rng(3)
    for _ in range(5):
        step = rng.uniform(-1.0, 1.0, u.shape)
        plus, minus = (stack.blocks.forces(u + k * h * step) for k in (1.0, -1.0))
        exact = tangent @ step.ravel()
        assert np.abs((plus - minus).ravel() / (2.0 * h) - exact).max() < 1e-4 * np.abs(exact).max()

"""Flank contact: exact variations, balanced forces, the contact patch test on meshes that do not
match, Hertz."""

from __future__ import annotations

import numpy as np
import pytest

from support.contact_blocks import Blocks, Rows, block, master
from support.hertz import hertz
from swgpar.contact.flank_pairs import Faces, MasterFlanks, PlacedFaces
from swgpar.contact.flanks import CONTINUATION
from swgpar.contact.segments import SAMPLES, bilinear, cut_faces, face_corners
from swgpar.kernel import contact_flanks
from swgpar.materials import Isotropic

PENALTY = 4e6


def shape_functions(order: int) -> tuple[np.ndarray, np.ndarray]:
    t, w = np.polynomial.legendre.leggauss(order)
    t, w = 0.5 * (t + 1), 0.5 * w
    a, b = (v.ravel() for v in np.meshgrid(t, t, indexing="ij"))
    return bilinear(a, b), np.outer(w, w).ravel()


def pressed() -> tuple[MasterFlanks, Faces, np.ndarray, np.ndarray]:
    """MasterFlanks, faces, places and displacements (n, 3) of all nodes, the face's four first.

    Master: an arc of radius 2 with random nodal displacement; slave: one tilted face pressed into
    it.
    """
    rng = np.random.default_rng(4)
    angle = np.linspace(-0.4, 0.4, 5)
    points = 2.0 * np.column_stack([np.sin(angle), np.cos(angle)])
    tangents = np.column_stack([np.cos(angle), -np.sin(angle)])
    s, z = 2.0 * (angle + 0.4), np.linspace(-0.5, 0.5, 4)
    flanks = master(points, tangents, s, z, 4)
    corners = np.array(
        [[-0.15, 2.0, -0.2], [0.15, 1.98, -0.2], [0.15, 1.99, 0.2], [-0.15, 1.98, 0.2]]
    )
    shape, weight = shape_functions(3)
    faces = Faces(
        np.arange(4, dtype=np.int32)[None],
        np.zeros((1, 4), np.uint8),
        corners[None].copy(),
        np.array([[0.0, -1.0, 0.0]]),
        shape[None],
        0.12 * weight[None],
        np.zeros((1, 9)),
        np.zeros(1, np.int32),
    )
    u = rng.uniform(-0.01, 0.01, (4 + flanks.conn.size, 3))
    u[:4, 1] -= 0.03
    grid = np.column_stack([np.repeat(points, len(z), axis=0), np.tile(z, len(s))])
    return flanks, faces, np.vstack([corners, grid]), u


def test_tangent_and_balance_on_a_curved_deformed_master() -> None:
    flanks, faces, place, u = pressed()

    def force(v: np.ndarray) -> np.ndarray:
        r = np.zeros_like(v)
        contact_flanks(flanks, faces, v, np.zeros((1, 9)), PENALTY, 0.0, 1.0, np.inf, r, None)
        return r

    rows, r, turning = Rows(len(u)), np.zeros_like(u), np.zeros(1)
    settings = np.zeros((1, 9)), PENALTY, 0.0, 1.0, np.inf
    gap, pressure, _, missing = contact_flanks(
        flanks, faces, u, *settings, r, rows, None, 0.0, turning
    )
    assert missing == 0 and (pressure > 0).all() and gap.max() < 0
    tangent, h = rows.matrix(), 1e-6
    difference = np.zeros_like(tangent)
    for k in range(u.size):
        step = np.zeros(u.size)
        step[k] = h
        step = step.reshape(u.shape)
        difference[:, k] = (force(u + step) - force(u - step)).ravel() / (2 * h)
    assert np.abs(difference - tangent).max() < 1e-6 * np.abs(tangent).max()
    # action equals reaction; the moment too, since the force acts along the line between point and
    # foot
    assert np.abs(r.sum(axis=0)).max() < 1e-9 * np.abs(r).max()
    moment = np.cross(place + u, r).sum(axis=0)
    # the foot lies on the curved arc, the forces act at its nodes' chords: balanced up to the
    # sagitta times the force
    assert np.abs(moment).max() < 0.01 * np.abs(r).sum()
    # about z, the rest is what the arc's height over the chords, which turns with the body, takes:
    # exactly
    assert abs(moment[2]) > 1e-5 * np.abs(r).sum() > 1e4 * abs(moment[2] + turning[0])


def over_the_end(along: float, across: float) -> float:
    """Area (mm2) of a face that touches on a flat flank, shifted along profile and width (mm)."""
    s = np.array([0.0, 0.4, 1.0])
    z = np.array([-0.5, 0.5])
    length = 0.35
    depth = 1e-3
    flanks = master(np.column_stack([s, 0.0 * s]), np.tile([1.0, 0.0], (3, 1)), s, z, 4)
    # arc length on the slave runs the other way
    corners = np.array([[length, 0, -0.5], [0, 0, -0.5], [0, 0, 0.5], [length, 0, 0.5]])
    faces = PlacedFaces(
        np.arange(4, dtype=np.int32)[None],
        np.zeros((1, 4), np.uint8),
        (corners + [along, -depth, across])[None],
        np.array([[0.0, -1.0, 0.0]]),
        np.array([[length, 1.0]]),
        np.zeros((1, len(SAMPLES), len(SAMPLES))),
        np.zeros(1, np.int32),
    )
    u, pick, settings = (
        np.zeros((4 + flanks.conn.size, 3)),
        np.zeros(1, dtype=np.int64),
        (PENALTY, 0.0, 0.1, np.inf),
    )
    corners, zero = faces.corners(pick), np.zeros((1, 4))
    foot_point = contact_flanks(
        flanks, corners, u, zero, *settings, None, None, beyond=CONTINUATION
    )[2]
    cut, r = faces.cut(pick, cut_faces(foot_point, faces.size, s, z, 2)), np.zeros_like(u)
    contact_flanks(flanks, cut, u, np.zeros(cut.weight.shape), *settings, r, None)
    return -r[:4, 1].sum() / (PENALTY * depth)


@pytest.mark.parametrize("along", [-0.3, -0.15, 0.0, 0.6, 0.85, 0.95, 1.15])
@pytest.mark.parametrize("across", [0.0, 0.3, -0.8])
def test_face_that_slides_over_the_end_of_the_flank(along: float, across: float) -> None:
    """It is cut where the flank ends, along the profile and the width: the force is that of the
    overlap."""
    overlap = max(0.0, min(1.0, along + 0.35) - max(0.0, along)) * (1.0 - abs(across))
    assert over_the_end(along, across) == pytest.approx(overlap, abs=1e-12)


@pytest.mark.parametrize("angle", [0.3, 1.7, 3.0, -2.2])
def test_contact_turns_with_both_bodies(angle: float) -> None:
    """Turned by any angle as a whole: the same gaps and pressures, and the forces turned alike."""
    flanks, faces, place, u = pressed()
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = (place + u) @ turn.T - place
    before, after, results = np.zeros_like(u), np.zeros_like(u), []
    for v, phi, r in ((u, 0.0, before), (turned, angle, after)):
        moment = np.zeros(1)
        settings = np.zeros((1, 9)), PENALTY, 0.0, 1.0, np.inf
        gap, pressure, _, _ = contact_flanks(
            flanks, faces, v, *settings, r, None, None, phi, moment
        )
        results.append(np.concatenate([gap.ravel() * PENALTY, pressure.ravel(), moment * PENALTY]))
    assert results[0][9:18].min() > 0.0
    assert np.abs(results[1] - results[0]).max() < 1e-10 * np.abs(results[0]).max()
    assert np.abs(after - before @ turn.T).max() < 1e-10 * np.abs(before).max()


def non_uniformity(slave: int) -> float:
    """Largest deviation of the pressure from its mean: slave x slave faces pressed on 4 x 4 by a
    uniform load."""
    load, line, fine = 100.0, np.linspace(0, 1, 5), np.linspace(0, 1, slave + 1)
    lower, lower_hexes, lower_grid = block(line, np.linspace(0.0, 0.5, 3), line)
    upper, upper_hexes, upper_grid = block(fine, np.linspace(0.5, 1.0, 3), fine)
    first = len(lower)
    points = np.vstack([lower, upper])
    flanks = master(
        np.column_stack([line, np.full(5, 0.5)]), np.tile([1.0, 0.0], (5, 1)), line, line, 0
    )
    flanks.conn[0] = lower_grid[:, -1]
    conn = face_corners(first + upper_grid[:, 0]).astype(np.int32)
    placed = PlacedFaces(
        conn,
        np.zeros_like(conn, dtype=np.uint8),
        points[conn],
        np.tile([0.0, -1.0, 0.0], (slave**2, 1)),
        np.full((slave**2, 2), 1.0 / slave),
        np.zeros((slave**2, len(SAMPLES), len(SAMPLES))),
        np.zeros(slave**2, np.int32),
    )
    force, edge = np.zeros_like(points), np.r_[0.5, np.ones(slave - 1), 0.5]
    force[first + upper_grid[:, -1], 1] = -load * np.outer(edge, edge) / slave**2
    fixed = np.abs(points) < 1e-12
    u = np.zeros_like(points)
    u[first:, 1] = -1e-5  # touching
    hexes = np.vstack([lower_hexes, upper_hexes + first])
    blocks = Blocks(
        points, hexes, len(points), flanks, placed, fixed, Isotropic(E=210e3, nu=0.0), PENALTY, 2
    )
    _, pressure, _ = blocks.press(u, force)
    return float(np.abs(pressure - load).max() / load)


@pytest.mark.parametrize("slave", [2, 3, 4, 5, 7])
def test_patch_on_meshes_that_do_not_match(slave: int) -> None:
    """Faces are cut along the master's edges: the pressure is uniform whatever the slave mesh."""
    assert non_uniformity(slave) < 1e-8


def test_hertz_line_contact() -> None:
    """Half width and pressures on meshes that do not match; what is beyond the contact carries
    nothing."""
    coarse, fine = hertz(4), hertz(8)
    for found in (coarse, fine):
        print(f"Hertz: load {found.load:.2f} N/mm, half width {found.half_width:.4f} mm", end=": ")
        print(
            f"found {found.found_half_width:.4f}; peak {found.p.max():.2f}, exact {found.peak:.2f} "
            f"MPa",
            end="; ",
        )
        print(f"largest deviation {found.deviation:.4f} of it")
    assert fine.p.max() == pytest.approx(fine.peak, rel=0.005)
    assert fine.found_half_width == pytest.approx(fine.half_width, rel=0.005)
    assert fine.deviation < 0.01 and fine.deviation < 0.5 * coarse.deviation
    assert fine.p[fine.x > 1.3 * fine.half_width].max() == 0.0

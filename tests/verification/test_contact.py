"""Flank contact: exact variations, balanced forces, the contact patch test on meshes that do not match, Hertz."""

from __future__ import annotations

import numpy as np
import pytest
from contact_blocks import Blocks, Rows, block, master

from swgpar.contact.segments import SAMPLES, bilinear, face_corners
from swgpar.contact.teeth import Faces, Flanks, PlacedFaces
from swgpar.kernel import contact_flanks

PENALTY = 4e6


def shape_functions(order: int) -> tuple[np.ndarray, np.ndarray]:
    t, w = np.polynomial.legendre.leggauss(order)
    t, w = 0.5 * (t + 1), 0.5 * w
    a, b = (v.ravel() for v in np.meshgrid(t, t, indexing="ij"))
    return bilinear(a, b), np.outer(w, w).ravel()


def pressed() -> tuple[Flanks, Faces, np.ndarray, np.ndarray]:
    """Flanks, faces, places and displacements (n, 3) of all nodes, the face's four first.

    Master: an arc of radius 2 with random nodal displacement; slave: one tilted face pressed into it.
    """
    rng = np.random.default_rng(4)
    angle = np.linspace(-0.4, 0.4, 5)
    points = 2.0 * np.column_stack([np.sin(angle), np.cos(angle)])
    tangents = np.column_stack([np.cos(angle), -np.sin(angle)])
    s, z = 2.0 * (angle + 0.4), np.linspace(-0.5, 0.5, 4)
    flanks = master(points, tangents, s, z, 4)
    corners = np.array([[-0.15, 2.0, -0.2], [0.15, 1.98, -0.2], [0.15, 1.99, 0.2], [-0.15, 1.98, 0.2]])
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
    gap, pressure, _, missing = contact_flanks(flanks, faces, u, *settings, r, rows, None, 0.0, turning)
    assert missing == 0 and (pressure > 0).all() and gap.max() < 0
    tangent, h = rows.matrix(), 1e-6
    difference = np.zeros_like(tangent)
    for k in range(u.size):
        step = np.zeros(u.size)
        step[k] = h
        step = step.reshape(u.shape)
        difference[:, k] = (force(u + step) - force(u - step)).ravel() / (2 * h)
    assert np.abs(difference - tangent).max() < 1e-6 * np.abs(tangent).max()
    # action equals reaction; the moment too, since the force acts along the line between point and foot
    assert np.abs(r.sum(axis=0)).max() < 1e-9 * np.abs(r).max()
    moment = np.cross(place + u, r).sum(axis=0)
    # the foot lies on the curved arc, the forces act at its nodes' chords: balanced up to the sagitta times the force
    assert np.abs(moment).max() < 0.01 * np.abs(r).sum()
    # about z, the rest is what the arc's height over the chords, which turns with the body, takes: exactly
    assert abs(moment[2]) > 1e-5 * np.abs(r).sum() > 1e4 * abs(moment[2] + turning[0])


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
        gap, pressure, _, _ = contact_flanks(flanks, faces, v, *settings, r, None, None, phi, moment)
        results.append(np.concatenate([gap.ravel() * PENALTY, pressure.ravel(), moment * PENALTY]))
    assert results[0][9:18].min() > 0.0
    assert np.abs(results[1] - results[0]).max() < 1e-10 * np.abs(results[0]).max()
    assert np.abs(after - before @ turn.T).max() < 1e-10 * np.abs(before).max()


def non_uniformity(slave: int) -> float:
    """Largest deviation of the pressure from its mean: slave x slave faces pressed on 4 x 4 by a uniform load."""
    load, line, fine = 100.0, np.linspace(0, 1, 5), np.linspace(0, 1, slave + 1)
    lower, lower_hexes, lower_grid = block(line, np.linspace(0.0, 0.5, 3), line)
    upper, upper_hexes, upper_grid = block(fine, np.linspace(0.5, 1.0, 3), fine)
    first = len(lower)
    points = np.vstack([lower, upper])
    flanks = master(np.column_stack([line, np.full(5, 0.5)]), np.tile([1.0, 0.0], (5, 1)), line, line, 0)
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
    blocks = Blocks(points, hexes, len(points), flanks, placed, fixed, 210e3, 0.0, PENALTY, 2)
    _, pressure, _ = blocks.press(u, force)
    return float(np.abs(pressure - load).max() / load)


@pytest.mark.parametrize("slave", [2, 3, 4, 5, 7])
def test_patch_on_meshes_that_do_not_match(slave: int) -> None:
    """Faces are cut along the master's edges: the pressure is uniform whatever the slave mesh."""
    assert non_uniformity(slave) < 1e-8


def spacing(fine: float, n_fine: int, length: float, growth: float) -> np.ndarray:
    """Nodes of [0, length]: n_fine elements of size `fine`, then ever longer ones."""
    steps = [fine] * n_fine
    while sum(steps) < length:
        steps.append(steps[-1] * growth)
    return np.concatenate([[0.0], np.cumsum(steps) * length / sum(steps)])


def test_hertz_line_contact() -> None:
    """A cylinder of radius R on a flat block of the same material, in plane strain (Johnson, Contact Mechanics, 4.2).

    Half of it by symmetry. With P per length: p_0^2 = P E* / (pi R), half width b^2 = 4 P R / (pi E*). The blocks
    are some 19 half widths high and wide, 17 to 20 elements lie on a half width; the meshes do not match.
    """
    young, poisson, radius, size, thickness = 210e3, 0.3, 10.0, 2.0, 0.05
    z = np.array([0.0, thickness])
    line, fine = spacing(0.0073, 18, size, 1.25), spacing(0.0065, 20, size, 1.25)
    lower, lower_hexes, lower_grid = block(line, -spacing(0.0073, 12, size, 1.25)[::-1], z)
    upper, upper_hexes, upper_grid = block(fine, spacing(0.0065, 12, size, 1.25), z)
    sagitta = radius - np.sqrt(radius**2 - upper[:, 0] ** 2)
    upper[:, 1] += sagitta * (1.0 - upper[:, 1] / size)
    points, first = np.vstack([lower, upper]), len(lower)
    hexes = np.vstack([lower_hexes, upper_hexes + first])
    # the nodes of both surfaces come first
    surface = np.concatenate([lower_grid[:, -1].ravel(), first + upper_grid[:, 0].ravel()])
    order = np.concatenate([surface, np.setdiff1d(np.arange(len(points)), surface)])
    number = np.argsort(order)
    points, hexes = points[order], number[hexes]
    flanks = master(np.column_stack([line, 0.0 * line]), np.tile([1.0, 0.0], (len(line), 1)), line, z, 0)
    flanks.conn[0] = number[lower_grid[:, -1]]
    conn = face_corners(number[first + upper_grid[:, 0]]).astype(np.int32)
    chord = points[conn[:, 1]] - points[conn[:, 0]]
    length = np.linalg.norm(chord, axis=1)
    normal = np.column_stack([chord[:, 1], -chord[:, 0], 0.0 * length]) / length[:, None]
    on_chord = points[conn[:, 0], None] + SAMPLES[:, None] * chord[:, None]
    # the centre is at height R: the arc lies below its chord
    below = radius - np.hypot(on_chord[..., 0], radius - on_chord[..., 1])
    placed = PlacedFaces(
        conn,
        np.zeros_like(conn, dtype=np.uint8),
        points[conn],
        normal,
        np.column_stack([length, np.full(len(length), thickness)]),
        np.repeat(below[:, :, None], len(SAMPLES), axis=2),
        np.zeros(len(conn), np.int32),
    )
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[points[:, 0] < 1e-12, 0] = True
    bottom, top = points[:, 1] < 1e-12 - size, points[:, 1] > size - 1e-12
    fixed[bottom | top, 1] = True
    u = np.zeros_like(points)
    u[number[first + upper_grid.ravel()], 1] = -0.0022
    blocks = Blocks(points, hexes, len(surface), flanks, placed, fixed, young, poisson, 4e6, 2)
    faces, pressure, contact = blocks.press(u, np.zeros_like(points), augmentations=4)
    load = -2.0 * contact[number[first + upper_grid[:, 0]], 1].sum() / thickness
    modulus = young / (2.0 * (1.0 - poisson**2))
    peak, half_width = np.sqrt(load * modulus / (np.pi * radius)), np.sqrt(4.0 * load * radius / (np.pi * modulus))
    # pressure as it is reported: by nodes, force over area
    force, area = np.zeros(len(points)), np.zeros(len(points))
    np.add.at(force, faces.conn, np.einsum("fq,fqa->fa", faces.weight * pressure, faces.shape))
    np.add.at(area, faces.conn, np.einsum("fq,fqa->fa", faces.weight, faces.shape))
    nodes = number[first + upper_grid[:, 0, 0]]
    x, p = points[nodes, 0] + u[nodes, 0], force[nodes] / area[nodes]
    exact = peak * np.sqrt(np.maximum(1.0 - (x / half_width) ** 2, 0.0))
    inside = x < 0.9 * half_width
    print(f"Hertz: load {load:.2f} N/mm, half width {half_width:.4f} mm, {np.sum(x < half_width)} nodes on it")
    error = np.abs(p - exact)[inside].max() / peak
    print(f"   peak pressure {p.max():.2f}, exact {peak:.2f} MPa; largest deviation {error:.4f} of it")
    assert np.sum(x < half_width) > 10
    assert p.max() == pytest.approx(peak, rel=0.02)
    assert error < 0.02
    assert pressure[np.einsum("fqa,fa->fq", faces.shape, points[faces.conn][..., 0]) > 1.1 * half_width].max() == 0.0

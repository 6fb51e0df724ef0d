"""Contact of flanks: lines with their cells, what elements lack in compliance, the exact surface
over a facet, and the law."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from _drafting import INK, NOTE, RING, SPLINE, label, leader, reference, run
from matplotlib.figure import Figure

from swgpar.contact.cells import Cells, Stations, divided
from swgpar.contact.flank_faces import SAMPLES, flank_faces
from swgpar.contact.missing_compliance import MissingCompliance
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.meshing import build_sector_meshes
from swgpar.meshing.recipe import load_recipe

LINES = np.array([-0.4, 0.35, 1.1]), np.array([0.0, 1.0])
"""Node lines of the master (arc length, z; mm) in the frame of a slave face of 1 mm by 1 mm."""

CELLS_ON_FACE = 12

SHIFT = 1.0
"""Arc length runs the other way on the master: s = SHIFT − a."""


def cells() -> Figure:
    """One face of the slave flank, with its lines and cells, cut along the node lines of the
    master."""
    stations = Stations.of(2, plane=False)
    row, low, high = divided(
        np.array([[SHIFT, 0.0]]), -np.ones(1), LINES[0], np.full((1, 1), CELLS_ON_FACE)
    )
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.4))
    for ax in axes:
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_xlim(-0.62, 1.62)
        ax.set_ylim(-0.62, 1.5)
    left, right = axes
    for s in LINES[0]:
        left.plot([SHIFT - s] * 2, [-0.55, 1.4], color=RING, lw=2.0)
    for z in LINES[1]:
        left.plot([-0.55, 1.5], [z, z], color=RING, lw=2.0)
    for ax in axes:
        ax.fill([0, 1, 1, 0], [0, 0, 1, 1], fc=SPLINE, alpha=0.25, ec=INK, lw=1.5)
    for (x, y), name in zip(
        ((0, 0), (1, 0), (1, 1), (0, 1)), ("(0, 0)", "(1, 0)", "(1, 1)", "(0, 1)")
    ):
        left.plot(x, y, "o", color=INK, ms=5)
        label(left, (x, y - 0.08 if y == 0 else y + 0.08), name, color=INK)
    for z in stations.place:
        left.plot([-0.55, 1.5], [z, z], color=NOTE, lw=1.2, ls="--")
    label(left, (0.5, 0.4), "face of the slave\n(flexible spline)", color=INK)
    leader(left, (1.3, -0.35), "node lines of the master\n(ring gear)", (SHIFT + 0.4, 0.0))
    leader(left, (1.25, 1.25), "lines of contact", (1.2, stations.place[1]), color=NOTE)
    left.set_title("lines along the profile, two on a layer", fontsize=10)
    for s in LINES[0]:
        if 0 < SHIFT - s < 1:
            right.plot([SHIFT - s] * 2, [0, 1], color=RING, lw=2.2)
    chosen = Cells(row, low, high, np.repeat(stations.place[1], len(row)), np.full(len(row), 0.5))
    for z in stations.place:
        right.plot([0, 1], [z, z], color=NOTE, lw=1.2)
        for end in np.union1d(low, high):
            right.plot([end, end], [z - 0.06, z + 0.06], color=NOTE, lw=1.2)
        right.plot(chosen.a.ravel(), np.full(2 * len(row), z), ".", color=INK, ms=3.5)
    right.annotate(
        "", xy=(0.45, -0.22), xytext=(0, -0.22), arrowprops={"arrowstyle": "-|>", "color": INK}
    )
    label(right, (0.6, -0.22), "a, along the profile", color=INK, ha="left")
    right.annotate(
        "", xy=(-0.2, 0.45), xytext=(-0.2, 0.0), arrowprops={"arrowstyle": "-|>", "color": INK}
    )
    label(right, (-0.2, 0.56), "b, along z", color=INK)
    last = (float(chosen.a[-1, 0]), float(stations.place[1]))
    leader(right, (1.2, 1.25), "two Gauss points\nin a cell", last, color=INK)
    right.set_title("cells, cut at the edges of both meshes", fontsize=10)
    figure.tight_layout()
    return figure


def missing() -> Figure:
    """Surface of a half plane and of the elements under a force on a tenth of a facet."""
    figure, ax = plt.subplots(figsize=(6.0, 4.2))
    design = reference("plane_half_turn")
    mesh = build_sector_meshes(design.geometry, load_recipe("plane_coarse"))["ring_gear"]
    grid, material = mesh.flanks[0], design.materials["ring_gear"]
    missing = MissingCompliance(mesh, grid, material.plane_stress())
    k, s = len(grid.s) // 2, grid.s
    parts = np.linspace(s[:-1], s[1:], 31, axis=1)
    low, high = parts[:, :-1].ravel(), parts[:, 1:].ravel()
    values = np.zeros(len(low) ** 2)
    missing.add(np.array([0, len(low)]), low, high, values)
    facet = np.diff(s)[k]
    loaded = np.abs(0.5 * (low + high) - (s[k] + 0.4 * facet)) < 0.051 * facet
    lacks = values.reshape(len(low), -1)[:, loaded].mean(axis=1)
    middle = 0.5 * (low + high)
    half_plane = np.zeros(len(middle))
    for x in np.linspace(low[loaded].min(), high[loaded].max(), 200):
        for image in (x, 2.0 * s[0] - x, 2.0 * s[-1] - x):
            apart = np.maximum(np.abs(middle - image), 1e-4 * facet)
            half_plane -= missing.logarithm * np.log(apart) / 200
    shown = np.abs(middle - s[k] - 0.4 * facet) < 3.5 * facet
    scale = material.modulus
    floor = (half_plane - lacks)[shown].min()
    for y, colour, name in (
        (half_plane - floor, SPLINE, "half plane, $T$"),
        (half_plane - lacks - floor, RING, "elements"),
        (lacks, NOTE, "$D$, what they lack"),
    ):
        ax.plot(middle[shown] - s[k], scale * y[shown], color=colour, lw=1.8, label=name)
    for node in s[k - 3 : k + 5] - s[k]:
        ax.axvline(node, color=INK, lw=0.5, ls=":")
    ax.axhline(0.0, color=INK, lw=0.7)
    ax.set_xlabel("arc length, mm (dotted: nodes)", fontsize=9)
    ax.set_ylabel("displacement into the body · E over the force per length", fontsize=9)
    ax.legend(fontsize=9)
    ax.set_title("a force on a tenth of a facet", fontsize=10)
    figure.tight_layout()
    return figure


def offset() -> Figure:
    """The exact, crowned flank over the facets of a coarse mesh, and the Hermite curve of the
    master."""
    design = reference("plane_half_turn")
    recipe = load_recipe("coarse")
    mesh = build_sector_meshes(design.geometry, recipe)["flexible_spline"]
    grid = mesh.flanks[0]
    profile = design.profile("flexible_spline")
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.5, 4.6), gridspec_kw={"width_ratios": [1.0, 1.25]}
    )
    left.set_aspect("equal")
    left.axis("off")
    curve = profile.point(np.linspace(0.0, profile.length, 400))
    nodes = mesh.coords[grid.nodes[:, 0], :2]
    fill = np.concatenate(
        [curve, [(curve[-1, 0], curve[-1, 1] - 0.2), (0.0, curve[-1, 1] - 0.2), (0.0, curve[0, 1])]]
    )
    left.fill(*fill.T, fc=SPLINE, alpha=0.25)
    left.plot(*curve.T, color=NOTE, lw=1.8)
    left.plot(*nodes.T, "o-", color=INK, lw=1.2, ms=4)
    label(left, (0.25, curve[0, 1] - 0.75), "flexible spline", color=INK)
    leader(
        left,
        (0.95, curve[0, 1] - 0.15),
        "exact flank",
        tuple(profile.point(0.18 * profile.length)[0]),
    )
    at = 0.5 * (nodes[2] + nodes[3])
    leader(left, (1.15, curve[0, 1] - 0.55), "facets between nodes", tuple(at), color=INK)
    left.set_title("nodes lie on the exact curve", fontsize=10)
    faces = flank_faces(mesh, grid, FlankCrowning())
    t = np.linspace(0.0, 1.0, 60)
    for i, (s0, s1) in enumerate(zip(grid.s[:-1], grid.s[1:])):
        exact = profile.point(s0 + t * (s1 - s0))
        chord = nodes[i] + t[:, None] * (nodes[i + 1] - nodes[i])
        height = 1e3 * np.sum((exact - chord) * profile.normal(s0 + t * (s1 - s0)), axis=1)
        right.plot(s0 + t * (s1 - s0), height, color=NOTE, lw=1.6)
        right.plot(s0 + SAMPLES * (s1 - s0), 1e3 * faces.offset[i, :, 0], "o", color=SPLINE, ms=5)
        right.axvline(s0, color=INK, lw=0.5, ls=":")
    right.axvline(grid.s[-1], color=INK, lw=0.5, ls=":")
    right.axhline(0.0, color=INK, lw=1.2)
    right.set_xlabel("arc length s from the addendum circle, mm", fontsize=9)
    right.set_ylabel("height of the exact flank over the facet, µm", fontsize=9)
    right.set_title("offset (dots: samples, polynomial between)", fontsize=10)
    figure.tight_layout()
    return figure


def law() -> Figure:
    """Force on a cell of a flank over the gap of the elements' surfaces, pressure of the cam over
    the gap of the augmented Lagrangian, and the return mapping of friction."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13.0, 3.9))
    gap = np.linspace(-1.6, 1.4, 301)
    for compliance, color in ((0.6, NOTE), (1.4, SPLINE)):
        left.plot(gap, np.maximum(0.0, -gap / compliance), color=color, lw=2.0)
    left.axvline(0.0, color=INK, lw=0.7)
    left.axhline(0.0, color=INK, lw=0.7)
    left.set_ylim(-0.15, 2.2)
    leader(left, (0.35, 1.5), "short elements", (-0.7, 0.7 / 0.6), color=NOTE)
    leader(left, (0.35, 0.8), "long elements", (-0.9, 0.9 / 1.4), color=SPLINE)
    left.set_xticks([])
    left.set_yticks([])
    left.set_xlabel("gap g of the elements' surfaces  (negative: overlap)", fontsize=9)
    left.set_ylabel("force f on one cell", fontsize=9)
    left.set_title(r"flanks: $f \geq 0,\ g + D f \geq 0,\ f\,(g + D f) = 0$", fontsize=11)
    for multiplier, color, style in ((0.0, SPLINE, "-"), (0.8, NOTE, "--")):
        middle.plot(gap, np.maximum(0.0, multiplier - gap), color=color, lw=2.0, ls=style)
    middle.axvline(0.0, color=INK, lw=0.7)
    middle.axhline(0.0, color=INK, lw=0.7)
    leader(middle, (-0.6, 0.15), r"$\lambda = 0$", (-0.35, 0.35), color=SPLINE)
    leader(middle, (0.55, 1.0), r"$\lambda > 0$: $p = \lambda$ at $g = 0$", (0.02, 0.8))
    label(middle, (-1.05, 1.55), r"slope $-\varepsilon$", color=INK, rotation=-40)
    middle.set_xticks([])
    middle.set_yticks([])
    middle.set_xlabel("gap g  (negative: penetration)", fontsize=9)
    middle.set_ylabel("pressure p", fontsize=9)
    middle.set_title(r"cam: $p = \max(0, \lambda - \varepsilon g)$", fontsize=11)
    right.set_aspect("equal")
    right.axis("off")
    circle = np.linspace(0, 2 * np.pi, 200)
    right.plot(np.cos(circle), np.sin(circle), color=INK, lw=1.4)
    label(right, (0.0, -1.13), r"slip: $|T| = \mu p$", color=INK)
    start, trial = np.array([0.15, 0.55]), np.array([1.75, 0.85])
    arrow = {"arrowstyle": "-|>", "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    right.annotate("", xy=start, xytext=(0, 0), arrowprops={**arrow, "color": SPLINE})
    right.annotate("", xy=trial, xytext=start, arrowprops={**arrow, "color": RING})
    end = trial / np.hypot(*trial)
    right.annotate("", xy=end, xytext=(0, 0), arrowprops={**arrow, "color": NOTE})
    leader(right, (-0.5, 0.62), "$t_n$, last\nconverged state", (0.08, 0.3), color=SPLINE)
    label(right, (1.95, 0.95), r"$T_{trial}$")
    label(right, (1.1, 0.92), r"$\varepsilon_t\,\varphi\,(\xi - \xi_n)$", color=INK)
    label(right, (0.62, 0.18), "$T$")
    right.set_xlim(-1.3, 2.3)
    right.set_ylim(-1.3, 1.4)
    right.set_title("friction: the trial traction returns to the cone", fontsize=11)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run(
        {
            "contact_cells": cells,
            "contact_missing": missing,
            "contact_offset": offset,
            "contact_laws": law,
        }
    )

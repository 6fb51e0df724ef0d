"""What the keys of [output] write: values at the nodes of the drive's mesh, and a window on a finer
one, in which the stress at the teeth is resolved."""

from __future__ import annotations

from typing import Any

import numpy as np
from _drafting import INK, NOTE, SPLINE, canvases, extension, label, leader, reference, run, turned
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from swgpar.largest_stress.local_problem import MARGIN, SECTORS, window_sector
from swgpar.largest_stress.window_recipes import window_recipe
from swgpar.meshing import MeshRecipe, SectorMesh, load_recipe

DRIVE_RECIPE, WINDOW_LEVEL = "plane_coarse", 1


def sectors(ax: Axes, mesh: SectorMesh, around: range, **style: Any) -> np.ndarray:
    """Draw sectors by their numbers from the one at +y; places (n, 2) mm of their nodes."""
    step = 2.0 * np.pi / mesh.n_sectors
    # the plane model's lower layer of nodes, the first four of an element
    sides = mesh.coords[mesh.hexes[:, :4], :2]
    for k in around:
        quads = turned(sides.reshape(-1, 2), k * step).reshape(sides.shape)
        ax.add_collection(PolyCollection(list(quads), edgecolors=INK, linewidths=0.3, **style))
    nodes = mesh.coords[np.unique(mesh.hexes[:, :4]), :2]
    return np.concatenate([turned(nodes, k * step) for k in around])


def spline_mesh(recipe: MeshRecipe) -> SectorMesh:
    """A sector of the flexible spline of the plane reference drive."""
    return window_sector(reference("plane_half_turn").geometry, recipe)


def output() -> Figure:
    """The drive's mesh with its nodes, and a window around the middle tooth."""
    figure, (whole, window) = canvases(11.0, 4.6, 1, 2, layout="constrained")
    half = SECTORS // 2
    shown = range(-half, half + 1)
    mesh = spline_mesh(load_recipe(DRIVE_RECIPE))
    nodes = sectors(whole, mesh, shown, facecolors=SPLINE, alpha=0.5)
    whole.plot(*nodes.T, "o", color=NOTE, ms=1.6)
    low, high = float(nodes[:, 1].min()), float(np.hypot(*nodes.T).max())
    picked = nodes[np.hypot(nodes[:, 0], nodes[:, 1] - high).argmin()]
    text = "fields: displacements and stresses\nof every node at every increment"
    leader(whole, (0.0, high + 1.6), text, tuple(picked))
    text = "mesh of the drive, from the mesh recipe\nfigures: PNG files of fields and history"
    label(whole, (0.0, low - 1.4), text, color=INK)

    fine = spline_mesh(window_recipe("plane", WINDOW_LEVEL))
    read = range(MARGIN - half, half - MARGIN + 1)
    sectors(window, fine, range(-half, -half + MARGIN), facecolors=SPLINE, alpha=0.2)
    sectors(window, fine, range(half - MARGIN + 1, half + 1), facecolors=SPLINE, alpha=0.2)
    sectors(window, fine, read, facecolors=SPLINE, alpha=0.6)
    step = 2.0 * np.pi / fine.n_sectors
    ends = np.array(
        [(0.0, fine.profile.r_root_circle), (0.0, np.hypot(*fine.coords[:, :2].T).min())]
    )
    for side in (-1.0, 1.0):
        cut = turned(ends, side * (half + 0.5) * step)
        extension(window, *map(tuple, cut), lw=2.0)
    text = "root_stress: a window of the flexible spline,\nstresses are read in its middle sectors"
    leader(window, (0.0, high + 1.6), text, (0.0, fine.profile.r_root_circle))
    at = tuple(turned(ends, (half + 0.5) * step).mean(axis=0))
    leader(window, (0.62 * at[0], low - 1.2), "cuts: displacements of the drive", at)
    return figure


if __name__ == "__main__":
    run({"output": output})

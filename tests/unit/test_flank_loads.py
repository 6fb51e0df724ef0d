"""Line loads of flanks and the nodal forces that they give."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DESIGN, RECIPE
from swgpar import load_design
from swgpar.flank_pressure.flank_loads import LineLoad, line_load, nodal_forces
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.meshing.recipe_counts import resized

DIRECTION = np.array([0.8, -0.6, 0.0])


def short_load(width: float) -> LineLoad:
    """A load of 100 N that is even over the middle 0.6 mm."""
    z = np.array([-0.5 * width, -0.301, -0.3, 0.3, 0.301, 0.5 * width])
    density = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
    length = float(np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(z)))
    return LineLoad(z, 100.0 / length * density[:, None] * DIRECTION, np.full(len(z), 0.3))


def test_a_projected_load_has_the_nodal_forces_it_comes_from() -> None:
    """The lumped one gives a share of them to the stations beside a short contact."""
    design = load_design(DESIGN)
    recipe = load_recipe(RECIPE)
    coarse, fine = (
        build_sector_meshes(design.geometry, one)["ring_gear"].flanks[0]
        for one in (recipe, resized(recipe, 3.0))
    )
    exact = nodal_forces(short_load(design.drive.face_width), coarse, 0.05)
    mesh = build_sector_meshes(design.geometry, recipe)["ring_gear"]
    forces = np.zeros((len(mesh.coords), 3))
    np.add.at(forces, coarse.nodes, exact)
    load = line_load(coarse, forces)
    again, lumped = (
        nodal_forces(one, coarse, 0.05).sum(axis=0) @ DIRECTION for one in (load.projected(), load)
    )
    along = exact.sum(axis=0) @ DIRECTION
    assert again == pytest.approx(along, abs=1e-9 * along.max())
    assert np.abs(lumped - along).max() > 0.05 * along.max()
    on_fine = nodal_forces(load.projected(), fine, 0.05).sum(axis=(0, 1))
    assert on_fine == pytest.approx(100.0 * DIRECTION, rel=1e-6)

"""The wall of the cup as a sector of its own: its mesh, its parameters, interpolation."""

from __future__ import annotations

import numpy as np
import pytest

from support.cup_shapes import HAT_CLAMPED, WALLS, shaped, wall_volume
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing.quality import hex_volumes
from swgpar.meshing.wall_sector import WallCounts, graded_line, section_parameters, wall_sector

CASES = {**WALLS, "cup": {}, "clamped hat": HAT_CLAMPED}
every_shape = pytest.mark.parametrize("shape", list(CASES))


def design(shape: str) -> DriveDesign:
    return shaped(CASES[shape])


@every_shape
def test_volume_tends_to_that_of_the_solid_of_revolution(shape: str) -> None:
    case, errors = design(shape), []
    for counts in (WallCounts(4, 2), WallCounts(8, 4)):
        mesh = wall_sector(case.geometry, counts, 0.0).mesh
        volume = mesh.n_sectors * hex_volumes(mesh.coords, mesh.hexes).sum()
        errors.append(abs(volume / wall_volume(case) - 1.0))
        assert mesh.quality["min_jacobian"] > 0.0
    # chords around the axis, which are not refined, leave 5e-4
    assert errors[0] < 0.01 and errors[1] < max(errors[0], 6e-4)


@every_shape
def test_faces_of_the_end_have_normals_outwards(shape: str) -> None:
    case = design(shape)
    mesh, wall = wall_sector(case.geometry, WallCounts(4, 2), 0.0).mesh, case.cup_sizes.wall
    corners = mesh.coords[mesh.faces["end"]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])[:, 2]
    middle = [np.mean(wall.faces_at(np.hypot(x, y))) for x, y in corners[:, 0, :2]]
    assert (np.sign(normal) == np.sign(corners[:, 0, 2] - middle)).all()


@every_shape
def test_parameters_of_the_section_are_those_of_the_grid(shape: str) -> None:
    case = design(shape)
    grid = wall_sector(case.geometry, WallCounts(8, 4), 0.0)
    parameters = section_parameters(case.geometry.cup, grid.mesh.coords)
    along, depth = (values[grid.number] for values in parameters)
    assert np.ptp(along, axis=(1, 2)).max() < 1e-9 and (np.diff(along[:, 0, 0]) > 0.0).all()
    assert np.ptp(depth, axis=(0, 2)).max() < 1e-9
    assert depth[0, [0, -1], 0] == pytest.approx([0.0, 1.0])


@every_shape
def test_interpolation_is_exact_at_nodes_and_for_parabolas_along_the_section(shape: str) -> None:
    """Linear tetrahedra would leave kinks of the order of the curvature times an element."""
    case = design(shape)
    cup = case.geometry.cup
    coarse, fine = (
        wall_sector(case.geometry, counts, 0.0) for counts in (WallCounts(4, 2), WallCounts(16, 8))
    )

    def field(points: np.ndarray) -> np.ndarray:
        along, depth = section_parameters(cup, points)
        angle = np.arctan2(points[:, 0], points[:, 1])
        return np.column_stack([along**2, along * depth, angle])

    values = field(coarse.mesh.coords)[None]
    at_nodes = coarse.interpolate(values, coarse.mesh.coords)[0]
    assert at_nodes == pytest.approx(values[0], abs=1e-6)
    found = coarse.interpolate(values, fine.mesh.coords)[0]
    assert found == pytest.approx(field(fine.mesh.coords), abs=1e-6)


@pytest.mark.parametrize("length", [0.3, 1.0, 17.0])
def test_steps_of_a_graded_line_grow_from_both_ends(length: float) -> None:
    steps = np.diff(graded_line(length, 0.1, 0.2, 1.0))
    assert steps.sum() == pytest.approx(length) and (steps > 0.0).all()
    assert steps[0] < 0.2 and steps[-1] < 0.4 and steps.max() < 1.5
    ratio = steps[1:] / steps[:-1]
    assert ratio.max() < 2.1 and ratio.min() > 1.0 / 2.1

"""Growth without stress, by temperature and press fits: rings against Lamé's equations."""

from __future__ import annotations

import numpy as np
import pytest

from support.element_mesh import ElementMesh
from support.grown_ring import GrownRing, lame
from support.paths import RECIPE
from support.stepping import small
from swgpar.fem.condensed_parts import condense_sector
from swgpar.kernel import assemble_elements, recover_stress
from swgpar.materials import Growth, Isotropic, TransverselyIsotropic
from swgpar.meshing import load_recipe
from swgpar.meshing.tooth_sector import build_sector
from swgpar.model.layouts import build_gear

STEEL = Isotropic(E=210e3, nu=0.3, expansion=12e-6)
ALUMINIUM = Isotropic(E=70e3, nu=0.33, expansion=23e-6)
INNER, SEAM, OUTER = 20.0, 24.0, 30.0
RISE = 60.0


def circles(first: float, last: float, n: int) -> np.ndarray:
    return np.linspace(first, last, n + 1)


@pytest.mark.parametrize("plane", [True, False])
def test_a_free_ring_grows_without_stress(plane: bool) -> None:
    growth = STEEL.thermal_growth(RISE)
    ring = GrownRing(circles(INNER, OUTER, 3), (STEEL,), (growth,), plane=plane)
    assert ring.result.converged
    strain = 12e-6 * RISE
    assert ring.displacement[..., 0] == pytest.approx(strain * ring.radius, rel=1e-9)
    assert np.abs(ring.displacement[..., 1]).max() < 1e-9 * strain * INNER
    if not plane:
        assert ring.displacement[..., 2] == pytest.approx(strain * ring.height, rel=1e-6, abs=1e-12)
    assert np.abs(ring.stress[0]).max() < 1e-6  # of 151 MPa, were it held


def test_a_grown_element_that_rotates_has_no_stress() -> None:
    """Growth that differs along z and a rotation of 2 rad about an oblique axis."""
    law = TransverselyIsotropic(E=3e3, nu=0.3, E_z=2e3, nu_z=0.25, G_z=1e3)
    box = np.array(
        [
            [0, 0, 0],
            [2, 0, 0],
            [2.2, 1, 0.1],
            [0, 1, 0],
            [0, 0, 1],
            [2, 0.2, 1],
            [2, 1, 1.3],
            [0, 1, 1],
        ],
        dtype=float,
    )
    growth = Growth(across=2e-3, along=-1e-3)
    grown = box + growth.of(box)
    mesh = ElementMesh(grown, np.arange(8)[None], law)
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = np.eye(3) + np.sin(2.0) * cross + (1.0 - np.cos(2.0)) * cross @ cross
    matrices = mesh.reference._replace(coords=box[None])
    u, residual = np.ascontiguousarray(grown @ rotation.T - box), np.zeros((8, 3))
    energy = assemble_elements(matrices, *mesh.arrays, u, residual, None, None)
    assert energy < 1e-18 and np.abs(residual).max() < 1e-9
    assert np.abs(recover_stress(matrices, *mesh.arrays, u)).max() < 1e-9
    # the same places without growth: 3e3 MPa times 2e-3
    held = recover_stress(matrices, *mesh.arrays, np.ascontiguousarray(box @ rotation.T - box))
    assert np.abs(held).max() > 1.0


@pytest.mark.parametrize("frame", [0.0, -4e-4])
def test_a_ring_in_a_rigid_frame(frame: float) -> None:
    """The frame holds the outer surface; the rest of the growth is the displacement of a pressure.

    frame : strain of the frame's bore, by an interference
    """
    growth = STEEL.thermal_growth(RISE)
    ring = GrownRing(circles(INNER, OUTER, 24), (STEEL,), (growth,), held=Growth(across=frame))
    assert ring.result.converged
    per_pressure = lame(INNER, OUTER, (0.0, 1.0), STEEL, OUTER)[0]
    pressure = (frame - growth.across) * OUTER / per_pressure
    for radius in (INNER, 0.5 * (INNER + OUTER), OUTER):
        u, _, hoop = lame(INNER, OUTER, (0.0, pressure), STEEL, radius)
        at = ring.at(radius)
        assert ring.displacement[at][:, 0] == pytest.approx(u + growth.across * radius, rel=1e-3)
        assert ring.stress[0][at][:, 1] == pytest.approx(hoop, rel=3e-3)


@pytest.mark.parametrize(("interference", "rise"), [(0.03, 0.0), (0.03, RISE), (0.0, -RISE)])
def test_a_ring_pressed_into_another_one(interference: float, rise: float) -> None:
    """Steel in aluminium: the pressure closes what the free rings overlap by. It is below 0 where
    the housing has grown away, because both are bonded.

    interference : mm, of the diameters
    """
    growths_of = (
        STEEL.thermal_growth(rise),
        ALUMINIUM.thermal_growth(rise) + Growth(across=-interference / (2.0 * SEAM)),
    )
    radii = np.concatenate([circles(INNER, SEAM, 16), circles(SEAM, OUTER, 24)[1:]])
    rings = GrownRing(radii, (STEEL, ALUMINIUM), growths_of, seam=SEAM)
    assert rings.result.converged
    outward = lame(SEAM, OUTER, (1.0, 0.0), ALUMINIUM, SEAM)[0]
    inward = lame(INNER, SEAM, (0.0, 1.0), STEEL, SEAM)[0]
    pressure = SEAM * (growths_of[0].across - growths_of[1].across) / (outward - inward)
    at, u_steel = rings.at(SEAM), lame(INNER, SEAM, (0.0, pressure), STEEL, SEAM)[0]
    found = rings.displacement[at][:, 0]
    assert found == pytest.approx(u_steel + growths_of[0].across * SEAM, rel=2e-3)
    _, _, hoop = lame(SEAM, OUTER, (pressure, 0.0), ALUMINIUM, SEAM)
    assert rings.stress[1][at][:, 1] == pytest.approx(hoop, rel=5e-3)
    _, _, hoop = lame(INNER, SEAM, (0.0, pressure), STEEL, INNER)
    assert rings.stress[0][rings.at(INNER)][:, 1] == pytest.approx(hoop, rel=5e-3)


def test_a_condensed_sector_grows_with_its_inside() -> None:
    design = small("plane", "material.expansion=12e-6", "flexible_spline.temperature=80")
    mesh = build_sector(design.geometry, load_recipe(RECIPE), "flexible_spline")
    body = build_gear(mesh, design.materials, design.drive.face_width, design.growths)
    condensed = condense_sector(mesh, body.elements)
    growth = Growth(across=12e-6 * RISE)
    outer = growth.of(mesh.coords[condensed.outer])
    found = condensed.inner_displacement(np.zeros(1), outer[None])[0]
    expected = growth.of(mesh.coords[condensed.inner])
    assert found == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    stretched = condensed.reference.stress_free - condensed.reference.coords
    assert stretched[0, :, :2] == pytest.approx(outer[:, :2], rel=1e-9, abs=1e-15)

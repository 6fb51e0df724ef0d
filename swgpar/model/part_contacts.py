"""Contacts of the inner surface of a part that is cut out of the flexible spline."""

from __future__ import annotations

import numpy as np

from swgpar.contact.face_quadrature import FaceQuadrature
from swgpar.contact.race_surface import RaceSurface
from swgpar.contact.wave_generator import WaveGeneratorContacts
from swgpar.fem.body import OUTER_RACE
from swgpar.fem.elements import BodyElements
from swgpar.fem.vectors import read_field
from swgpar.geometry.rotation import rotated
from swgpar.load.load_states import LoadState
from swgpar.meshing.race_sector import race_grid
from swgpar.model.bearing_model import race_relief
from swgpar.model.drive_model import DriveModel


def contacts_of_part(
    model: DriveModel, state: LoadState, part: BodyElements, teeth: np.ndarray
) -> WaveGeneratorContacts:
    """Contacts with the exact cam, or with the outer race where it lies in the drive; collective.

    model, state : the drive in its equilibrium under that load state
    part : elements of these teeth (n,), which follow each other, on another mesh
    """
    if model.problem.wave_generator.race is None:
        return model.rigid_contacts(part)
    design, layout = model.design, model.partition.layouts[OUTER_RACE]
    beside = np.arange(teeth[0] - 1, teeth[-1] + 2)
    field = read_field(model.partition, OUTER_RACE, beside - layout.first_tooth, model.problem.x)
    grid = race_grid(layout.mesh, "outer")
    own = rotated(layout.mesh.coords[grid], layout.sector_angle(beside)[:, None, None])

    def in_the_cams_frame(nodes: np.ndarray) -> np.ndarray:
        """(n_around, n_z, 3): sectors share the nodes between them."""
        return rotated(nodes[:, :-1].reshape(-1, grid.shape[1], 3), -state.angle)

    quadrature = FaceQuadrature(part, "inner", design.inner_radius, design.contact.wg_quadrature)
    z = quadrature.position[..., 2].ravel()
    surface = RaceSurface(
        in_the_cams_frame(own), in_the_cams_frame(own + field[:, grid]), z, race_relief(design)(z)
    )
    return model.rigid_contacts(part, surface)

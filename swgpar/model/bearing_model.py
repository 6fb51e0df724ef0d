"""The parts of a drive's model that a bearing adds: outer race, balls, their contacts and the
race's support."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from swgpar.contact.ball_contact import LARGEST_REACH, BallContact, BallSet
from swgpar.contact.point_contact import ball_spring
from swgpar.contact.race_contact import RaceContact
from swgpar.contact.wave_generator import WaveGeneratorContacts
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE, Body
from swgpar.fem.elements import Elements
from swgpar.geometry.micro_geometry import crowning
from swgpar.materials import contact_modulus
from swgpar.meshing.race_sector import opposite_cells, race_grid, race_sector
from swgpar.meshing.sector import SectorMesh


def build_race(design: DriveDesign, spline: SectorMesh) -> Body:
    """The outer race. Its sectors lie opposite to those of the flexible spline."""
    mesh = race_sector(
        spline, design.inner_radius, design.bearing.race_thickness, design.race_width
    )
    materials, grown = (design.materials["bearing"],), (design.growths["bearing"],)
    return Body(mesh, materials, design.race_width, grown)


def build_balls(design: DriveDesign) -> BallSet:
    """The balls with their springs, all of the bearing's material."""
    bearing, sizes, material = design.bearing, design.bearing_sizes, design.materials["bearing"]
    return BallSet(
        number=bearing.balls,
        diameter=bearing.ball_diameter,
        clearance=design.ball_clearance,
        first_angle=float(np.radians(bearing.first_ball)),
        cage_speed=design.cage_speed,
        lines=design.grown_ball_lines(),
        spring=ball_spring(
            bearing.ball_diameter,
            sizes.inner_groove,
            sizes.outer_groove,
            (bearing.inner_conformity, bearing.outer_conformity),
            contact_modulus(material, material),
            bearing.stiffness_factor,
        ),
    )


def build_ball_contact(design: DriveDesign, elements: Elements) -> BallContact:
    """Contact of the balls with the outer race, in the mid-plane of its width."""
    race = elements.bodies[OUTER_RACE]
    nodes = race_grid(race.layout.mesh, "inner")
    z = race.layout.mesh.coords[nodes[0], 2]
    share = np.array(
        [np.interp(0.0, z, unit) for unit in np.eye(len(z))]
    )  # shape functions in the mid-plane
    sector = race.layout.mesh.pitch * design.bearing_sizes.outer_groove
    return BallContact(
        race,
        build_balls(design),
        groove=nodes[:, share > 0.0],
        spread=share[share > 0.0],
        reach=min(design.bearing.race_thickness, LARGEST_REACH * sector),
    )


def race_relief(design: DriveDesign) -> Callable[[np.ndarray], np.ndarray]:
    """What gives the gap (n,) mm between race and flexible spline at z (n,) mm, both undeformed."""
    micro, width = design.micro_geometry, design.wave_generator.face_width
    bearing, slope = design.bearing, 2.0 * design.bearing.race_taper / design.race_width

    def relief(z: np.ndarray) -> np.ndarray:
        removed = crowning(micro.wg_crowning, z, width, micro.crowning_shape)[0]
        return removed + slope * z - 0.5 * bearing.race_interference

    return relief


def build_bearing_contacts(
    design: DriveDesign, elements: Elements, pressure_limit: float, edge: float
) -> WaveGeneratorContacts:
    """Contacts of the race with the flexible spline, and of the balls with the race.

    pressure_limit : as a share of the modulus;  edge : factor on the width of the race
    """
    spline, race = elements.bodies[FLEXIBLE_SPLINE], elements.bodies[OUTER_RACE]
    column, layer = opposite_cells(spline.layout.mesh, race.layout.mesh)
    contact = RaceContact(
        spline,
        race,
        grid=race_grid(race.layout.mesh, "outer"),
        column=column,
        layer=layer,
        half_width=0.5 * design.race_width * edge,
        radius=design.inner_radius,
        relief=race_relief(design),
        n_quadrature=design.contact.wg_quadrature,
        penalty=design.wg_penalty,
        pressure_limit=pressure_limit * design.modulus_of("bearing"),
    )
    return WaveGeneratorContacts(race=contact, balls=build_ball_contact(design, elements))

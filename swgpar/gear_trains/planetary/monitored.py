"""What is recorded of a planetary train: coordinates of its parts, deflections of two meshes."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary_parts.model import (
    SUN,
    PlanetaryModel,
    carrier_index,
    planet_index,
    ring_index,
)

MONITORED = {
    "sun_rotation": "rotation of the sun times its base radius",
    "carrier_rotation": "rotation of the carrier times the radius of the planet centres",
    "planet_tangential": "tangential displacement of planet 1 in the frame of the carrier",
    "ring_node_tangential": "tangential displacement of node 3 of the ring",
    "ring_contact_radial": "outward displacement of the ring at the mesh with planet 1",
    "sun_mesh_deflection": "deflection of the mesh of sun and planet 1",
    "ring_mesh_deflection": "deflection of the mesh of ring and planet 1",
}
"""Name -> meaning; all in m."""

MONITORED_NAMES = tuple(MONITORED)

OF_NODE = {
    "radial": "outward displacement of node {} of the ring",
    "tangential": "tangential displacement of node {} of the ring",
    "rotation": "rotation of the ring at node {} times the radius of its centre line",
}

COORDINATES = {
    "sun_x": "displacement of the sun towards planet 1",
    "sun_y": "displacement of the sun across the direction of planet 1",
    "planet_radial": "outward displacement of planet 1 in the frame of the carrier",
    "planet_rotation": "rotation of planet 1 times its base radius",
    "carrier_x": "displacement of the carrier towards planet 1",
    "carrier_y": "displacement of the carrier across the direction of planet 1",
    **{
        f"ring_node_{node}_{name}": meaning.format(node)
        for node in (1, 2, 3)
        for name, meaning in OF_NODE.items()
        if (node, name) != (3, "tangential")  # monitored
    },
}
"""Further coordinates that tables have, name -> meaning; all in m."""

RECORDED = MONITORED | COORDINATES

PARTS = {
    "sun": ("sun_x", "sun_y", "sun_rotation"),
    "planet": ("planet_radial", "planet_tangential", "planet_rotation"),
    "carrier": ("carrier_x", "carrier_y", "carrier_rotation"),
    "ring_node_1": tuple(f"ring_node_1_{name}" for name in OF_NODE),
    "ring_node_2": tuple(f"ring_node_2_{name}" for name in OF_NODE),
    "ring_node_3": ("ring_node_3_radial", "ring_node_tangential", "ring_node_3_rotation"),
}
"""The coordinates of parts, by part."""

RING_NODE = 2
"""Node 3 of the ring, counted from 0."""


def monitored(
    train: PlanetaryModel, steps: TimeStepper, step: int, flanks: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Recorded quantities per unit of each mode (recorded, n), and what is added (recorded,) m, at
    the end of a step.

    Meshes are taken as in contact on their loaded flanks (m,), 1 or -1: force and deflection of the
    ring between its nodes follow from the deflection with that of the nodes.
    """
    design, first, count = train.design, ring_index(train.design), train.design.planet.count
    time = step * steps.h
    fixed = [2, carrier_index(design) + 2, planet_index(0) + 1, first + 3 * RING_NODE + 1]
    outward = train.ring.interpolation(design.carrier.speed * time)[0] @ train.shapes[first:]
    sun, ring = steps.deflection_rows[step, [0, count]]
    stiffness = steps.stiffness[step, count]
    closed = train.half_backlash * flanks[count]
    bulge = stiffness * train.local_flexibility(np.array([time]))[0, 0, 0]
    share = stiffness / train.mesh.at(time)[count]
    monitored_rows = [train.shapes[fixed], outward - bulge * ring, sun, share * ring]
    rows = np.vstack([*monitored_rows, _coordinate_rows(train)])
    constants = np.zeros(len(rows))
    constants[4:7] = bulge * closed, 0.0, (1.0 - share) * closed
    return rows, constants


def _coordinate_rows(train: PlanetaryModel) -> np.ndarray:
    """`COORDINATES` per unit of each mode, (coordinates, n)."""
    carrier, planet, first = carrier_index(train.design), planet_index(0), ring_index(train.design)
    parts = [SUN, SUN + 1, planet, planet + 2, carrier, carrier + 1]
    nodes = [first + k for k in range(9) if k != 3 * RING_NODE + 1]
    rows = train.shapes[parts + nodes]
    turned = [name.startswith("ring") and name.endswith("rotation") for name in COORDINATES]
    rows[turned] *= train.ring.section.radius
    return rows

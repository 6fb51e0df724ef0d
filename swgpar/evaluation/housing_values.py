"""Largest stresses and radial displacement of the housing: entry `housing` of the summary."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from swgpar.contact.contact import largest
from swgpar.fem.body_layout import RING_GEAR
from swgpar.model.drive_model import DriveModel

MICROMETRES = 1000.0


def housing_values(model: DriveModel, stresses: Mapping[str, float]) -> dict[str, float]:
    """Values of the present state by the names of the summary; collective.

    stresses : of the housing, MPa, as `DriveModel.stresses` names them

    `bulge_um` is the largest radial displacement, outwards, of the surface between ring gear and housing.
    """
    body = model.elements.bodies[RING_GEAR]
    mesh = body.layout.mesh
    nodes = np.intersect1d(mesh.nodes_of(0), mesh.nodes_of(1))
    before = body.positions()[body.owned][:, nodes, :2]
    after = before + body.displacement(model.problem.displacement())[body.owned][:, nodes, :2]
    moved = np.linalg.norm(after, axis=-1) - np.linalg.norm(before, axis=-1)
    return {
        **{f"{name.removeprefix('housing_')}_MPa": value for name, value in stresses.items()},
        "bulge_um": MICROMETRES * largest(model.comm, float(moved.max(initial=-np.inf))),
    }


def keep_largest(kept: dict[str, float], values: Mapping[str, float]) -> None:
    """Let `kept` have the larger of what it has and of `values`."""
    for name, value in values.items():
        kept[name] = max(value, kept.get(name, value))

"""Largest stresses and radial displacement of the housing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from swgpar.answers.answer import AnswerGroup, answer, evaluation
from swgpar.contact.contact import largest
from swgpar.fem.body import RING_GEAR
from swgpar.model.drive_model import DriveModel

MICROMETRES = 1000.0


@evaluation
class HousingStresses(AnswerGroup):
    """Largest values of the housing over the increments under load.

    s1_MPa, s3_MPa, vm_MPa : by nodal averages over its own elements, s3 as a positive number
    """

    s1_MPa: float = answer("housing.s1", "largest tension in the housing under load", "MPa")
    s3_MPa: float = answer("housing.s3", "largest compression in the housing under load", "MPa")
    vm_MPa: float = answer(
        "housing.vm", "largest von Mises stress in the housing under load", "MPa"
    )
    bulge_um: float = answer(
        "housing.bulge",
        "largest radial displacement of the ring gear's outer surface under load",
        "µm",
    )

    fit_tension_MPa: float | None = answer(
        "housing.fit_tension",
        "largest tension between ring gear and housing under load, mean of a tooth sector; below 0 "
        "where the fit presses all round",
        "MPa",
        default=None,
    )

    TITLE = "housing under load"
    ASKED_BY = "[ring_gear.housing]"
    SECTION = "housing"


def housing_values(model: DriveModel, stresses: Mapping[str, float]) -> dict[str, float]:
    """Values of the present state by the names of the fields of `HousingStresses`; collective.

    stresses : of the housing, MPa, as `DriveModel.stresses` names them

    `bulge_um` is the largest radial displacement, outwards, of the surface between ring gear and
    housing. `fit_tension_MPa` is by the forces on the housing there.
    """
    body = model.elements.bodies[RING_GEAR]
    mesh = body.layout.mesh
    nodes = np.intersect1d(mesh.nodes_of(0), mesh.nodes_of(1))
    before = body.positions()[body.owned][:, nodes, :2]
    after = before + body.displacement(model.problem.displacement())[body.owned][:, nodes, :2]
    moved = np.linalg.norm(after, axis=-1) - np.linalg.norm(before, axis=-1)
    radius = float(np.hypot(*mesh.coords[nodes[0], :2]))
    forces = body.part_forces(model.problem.displacement(), 1)[:, nodes, :2]
    pressing = np.sum(forces * before / radius, axis=(1, 2))
    area = mesh.pitch * radius * model.design.drive.face_width
    return {
        **{f"{name.removeprefix('housing_')}_MPa": value for name, value in stresses.items()},
        "bulge_um": MICROMETRES * largest(model.comm, float(moved.max(initial=-np.inf))),
        "fit_tension_MPa": largest(model.comm, -float(pressing.min(initial=np.inf)) / area),
    }


def keep_largest(kept: dict[str, float], values: Mapping[str, float]) -> None:
    """Let `kept` have the larger of what it has and of `values`."""
    for name, value in values.items():
        kept[name] = max(value, kept.get(name, value))

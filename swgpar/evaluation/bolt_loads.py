"""Loads of the bolts that hold closed end or flange: rows of bolts.csv, and whether a washer slides
or gapes.

Every washer is bonded to the rigid flange, which carries it by forces on its nodes. Their sum and
their moment are what the joint under the bolt has to transmit. By VDI 2230 it does not slide where
friction of the clamping force that is left exceeds the force in its plane, and it does not gape
where the preload exceeds what lifts the edge of the washer.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation, part_answers
from swgpar.constraints.distributing_coupling import ROTATION
from swgpar.constraints.supports import SPLINE_COUPLING
from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.rotation import rotated
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row, column

EDGE = 8.0
"""Diameter of a circle times its area over its section modulus."""

SLIDING = AnswerKind(
    "bolts.sliding_safety",
    "least safety factor of a bolt against sliding",
    place="places.sliding",
)
GAPING = AnswerKind(
    "bolts.gaping_safety", "least safety factor of a bolt against gaping", place="places.gaping"
)
SAFETIES = SLIDING.name, GAPING.name
"""Answers that need a preload."""


def washer_loads(
    places: np.ndarray,
    forces: np.ndarray,
    bolts: int,
    radius: float,
    *,
    copies: int = 1,
    comm: MPI.Comm = MPI.COMM_SELF,
) -> np.ndarray:
    """Forces (N) on the flange and their moments (N mm) about the middles of the washers,
    (bolts, 6); collective. Axes of a bolt: clockwise, outwards, along z.

    places : (n, 3) mm, of the attached nodes of this rank, from the middle of the closed end
    forces : (n, 3) N, of the nodes on the flange
    radius : mm, of the circle of the bolts, the first of which is on +y
    copies : how many times the nodes of all ranks make the whole drive
    """
    step, own = 2.0 * np.pi / bolts, bolts // copies
    number = np.round(np.arctan2(-places[:, 0], places[:, 1]) / step).astype(int)
    turn = -number * step
    arm = places - np.array([0.0, radius, 0.0])
    arm[:, :2] = rotated(places[:, :2], turn) - np.array([0.0, radius])
    force = forces.copy()
    force[:, :2] = rotated(forces[:, :2], turn)
    loads = np.zeros((own, 6))
    np.add.at(loads, number % own, np.concatenate([force, np.cross(arm, force)], axis=1))
    return np.tile(comm.allreduce(loads, op=MPI.SUM), (copies, 1))


def tilting_moment(loads: np.ndarray, half: float) -> np.ndarray:
    """Moments (n,) N mm that tilt washers, from `washer_loads` (n, 6). The joint may be on either
    face: the larger one. half : mm, of the thickness of closed end or flange"""
    on_faces = [
        np.hypot(loads[:, 3] + at * loads[:, 1], loads[:, 4] - at * loads[:, 0])
        for at in (-half, half)
    ]
    return np.maximum(*on_faces)


def bolt_rows(model: DriveModel, state: LoadState, increment: int, step: int) -> list[Row]:
    """Rows of bolts.csv of the present state, a bolt each, on all ranks; collective."""
    design, supports = model.design, model.problem.supports
    cup, coupling = design.cup, supports.gear_couplings[SPLINE_COUPLING]
    u = model.problem.displacement()
    forces = np.zeros_like(u)
    supports.add_forces(u, state, model.problem.multipliers(), forces)
    rotation = float(coupling.evaluate(u).value[ROTATION])
    on_flange = forces[coupling.nodes]
    on_flange[:, :2] = rotated(on_flange[:, :2], -rotation)
    loads = washer_loads(
        coupling.undeformed - np.array([0.0, 0.0, coupling.center[2]]),
        on_flange,
        cup.bolts,
        0.5 * cup.bolt_circle,
        copies=model.copies,
        comm=model.comm,
    )
    thickness = design.cup_sizes.wall.thickness_at(0.5 * cup.bolt_circle)
    tilting = tilting_moment(loads, 0.5 * thickness)
    wave_generator = float(np.degrees(state.angle))
    rows = []
    for bolt, load in enumerate(loads):
        angle = 360.0 * bolt / cup.bolts + float(np.degrees(rotation))
        shown = design.kinematics.in_frame_of_result(angle, wave_generator) % 360.0
        rows.append(
            {
                "increment": increment,
                "step": step,
                "wg_angle_deg": wave_generator,
                "bolt": bolt,
                "angle_deg": shown,
                "tangential_N": -float(load[0]),
                "radial_N": float(load[1]),
                "axial_N": float(load[2]),
                "tilting_Nmm": float(tilting[bolt]),
                "twisting_Nmm": float(load[5]),
            }
        )
    return rows


@evaluation
class BoltLoads(AnswerGroup):
    """Largest loads of a bolt over the increments under load, by their magnitude, and least safety
    factors.

    sliding, gaping : None without a preload, and where nothing loads the joint
    places : by names of fields
    judged : whether there is a preload
    """

    shear_N: float = answer(
        "bolts.shear_force",
        "largest force of a bolt in the plane of the joint",
        "N",
        place="places.shear_N",
    )
    tangential_N: float = answer(
        "bolts.tangential_force",
        "largest tangential force of a bolt",
        "N",
        place="places.tangential_N",
    )
    radial_N: float = answer(
        "bolts.radial_force", "largest radial force of a bolt", "N", place="places.radial_N"
    )
    axial_N: float = answer(
        "bolts.axial_force", "largest axial force of a bolt", "N", place="places.axial_N"
    )
    tilting_Nmm: float = answer(
        "bolts.tilting_moment",
        "largest moment that tilts a washer",
        "N·mm",
        place="places.tilting_Nmm",
    )
    sliding: float | None = part_answers(SLIDING)
    gaping: float | None = part_answers(GAPING)
    places: Mapping[str, str]
    judged: bool

    TITLE = "bolts, under load"
    ASKED_BY = 'cup.attachment = "bolted"'

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        if not design.is_bolted:
            return ()
        judged = design.cup.bolt_preload is not None
        return tuple(kind for kind in super().kinds(design) if judged or kind.name not in SAFETIES)

    def reasons(self) -> Mapping[str, str]:
        if not self.judged:
            return {}
        return dict.fromkeys(SAFETIES, "nothing loads the joint of a bolt")

    def remarks(self) -> Iterator[str]:
        if not self.judged:
            yield (
                "whether washers slide or gape is not judged: cup.bolt_preload and "
                "cup.joint_friction are not given"
            )
        for value, what in ((self.sliding, "slides"), (self.gaping, "gapes")):
            if value is not None and value < 1.0:
                yield f"a washer {what}, but is bonded in the model: the drive is softer than this"


def evaluate_bolts(cup: Cup, rows: Sequence[Row], increments: Sequence[int]) -> BoltLoads | None:
    """From rows of bolts.csv; None without increments under load.

    increments : under load, as in their column `increment`
    """
    wanted = set(increments)
    rows = [row for row in rows if row["increment"] in wanted]
    if not rows:
        return None
    tangential, radial, axial, tilting = (
        np.abs(column(rows, name))
        for name in ("tangential_N", "radial_N", "axial_N", "tilting_Nmm")
    )
    shear = np.hypot(tangential, radial)
    largest = {
        "shear_N": shear,
        "tangential_N": tangential,
        "radial_N": radial,
        "axial_N": axial,
        "tilting_Nmm": tilting,
    }
    indices = {name: int(values.argmax()) for name, values in largest.items()}
    found: dict[str, float | None] = {
        name: float(values[indices[name]]) for name, values in largest.items()
    }
    found |= {"sliding": None, "gaping": None}
    if cup.bolt_preload is not None:
        # the flange may be on either side: an axial force counts as one that lifts
        needed = {
            "sliding": axial + shear / cup.joint_friction,
            "gaping": axial + EDGE * tilting / cup.washer_diameter,
        }
        for name, force in needed.items():
            indices[name] = worst = int(force.argmax())
            if force[worst] > 0.0:
                found[name] = cup.bolt_preload / float(force[worst])
    return BoltLoads(
        **found,
        places={name: _place(rows[index]) for name, index in indices.items()},
        judged=cup.bolt_preload is not None,
    )


def _place(row: Row) -> str:
    """Words for a bolt at an increment."""
    return (
        f"bolt {int(row['bolt'])}, {row['angle_deg']:.1f}° from +y, wave generator at "
        f"{row['wg_angle_deg']:.4g}°"
    )

"""Losses of the drive over a turn of the wave generator: friction of flanks and bearing, hysteresis
of the material, drag of the lubricant, seals.

The loss torque is the input torque that the losses take: their work per turn over 2 pi
(docs/theory/losses.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation, part_answers
from swgpar.design.bearing_drag import BearingDrag
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.stress_cycle import StressCycle, elements_of_rank
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.masses import mass_matrices
from swgpar.log import logger
from swgpar.materials import Material
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row

SMALL_SHARE = 0.01
"""Share of the flanks' force that friction leaves out without a word: pairs that hardly touch are
not searched."""

CHUNK = 256
"""Elements whose harmonics are combined at once."""


@evaluation
class LossParts:
    """Parts of the loss torque."""

    flank_friction: float = answer(
        "losses.flank_friction", "its part by friction of the flanks", "N·mm"
    )
    hysteresis: float = answer("losses.hysteresis", "its part by hysteresis of the spline", "N·mm")
    bearing: float = answer(
        "losses.bearing", "its part by friction of the wave generator's bearing", "N·mm"
    )
    lubricant: float = answer(
        "losses.lubricant",
        "its part by drag of the lubricant in the wave generator's bearing",
        "N·mm",
        default=0.0,
    )
    seals: float = answer(
        "losses.seals", "its part by seals and grease at input and output", "N·mm", default=0.0
    )


EFFICIENCY = AnswerKind("losses.efficiency", "efficiency")
NO_LOAD_TORQUE = AnswerKind("losses.no_load_torque", "input torque without a load", "N·mm")
STARTING_TORQUE = AnswerKind(
    "losses.starting_torque", "input torque that starts the drive without a load", "N·mm"
)


@evaluation
class DriveLosses(AnswerGroup):
    """Losses over a turn of the wave generator.

    efficiency : None without a torque
    no_load_torque_Nmm, starting_torque_Nmm : None with one
    work_per_turn_J, power_W : at `load.input_speed`
    cam_force_N : pressure of the cam, integrated, or sum of the loads of all balls
    flank_friction_coefficient : between the flanks
    """

    loss_torque_Nmm: float = answer("losses.torque", "input torque that the losses take", "N·mm")
    parts_Nmm: LossParts
    efficiency: float | None = part_answers(EFFICIENCY)
    no_load_torque_Nmm: float | None = part_answers(NO_LOAD_TORQUE)
    starting_torque_Nmm: float | None = part_answers(STARTING_TORQUE, default=None)
    work_per_turn_J: float = answer(
        "losses.work_per_turn", "work of all losses per turn", "J", detail=True
    )
    power_W: float = answer("losses.power", "power of all losses", "W")
    cam_force_N: float = answer(
        "losses.cam_force", "force of the wave generator, mean", "N", detail=True
    )
    flank_friction_coefficient: float

    TITLE = "losses and efficiency"
    ASKED_BY = "[losses]"
    SECTION = "losses"


def cam_force(model: DriveModel) -> float:
    """Force (N) of the wave generator on the whole drive; collective.

    It is the pressure integrated over the inner surface of the spline, with a bearing the sum of
    the ball loads.
    """
    if model.design.bearing is not None:
        mine = float(model.problem.wave_generator.balls.owned_forces().sum())
    else:
        cam = model.problem.wave_generator.cam
        mine = float((cam.pressure * cam.weight)[cam.owned].sum())
    return model.copies * model.comm.allreduce(mine, op=MPI.SUM)


def evaluate_losses(
    cycle: StressCycle, pairs: Sequence[Row], cam_forces: Sequence[float], increments: Sequence[int]
) -> tuple[DriveLosses, dict[str, np.ndarray]]:
    """The losses, and the columns of losses.csv; collective.

    pairs : rows of pairs.csv;  increments : numbers of those of the sampled period, from 1
    cam_forces : (n,) N, `cam_force` of all increments
    """
    model = cycle.model
    design, losses = model.design, model.design.losses
    omega, ratio = design.load.input_rate, design.kinematics.input_ratio
    dry = losses.dry_friction(omega)
    sliding = dry * np.array(
        [_flank_torque(design, pairs, increment, model.copies) for increment in increments]
    )
    forces = np.array([cam_forces[increment - 1] for increment in increments])
    arm = 0.5 * (losses.bearing_diameter or _bearing_diameter(design))
    # the outer race turns with the flexible spline
    relative = 1.0 - design.kinematics.spline_speed
    bearing = dry * losses.bearing_friction * forces * arm * relative
    hysteresis = losses.loss_factor * hysteresis_work(cycle) / (2.0 * np.pi)
    friction = float(sliding.mean() + bearing.mean())
    drag = bearing_drag(design)
    parts = LossParts(
        flank_friction=float(sliding.mean()),
        hysteresis=hysteresis,
        bearing=float(bearing.mean()),
        lubricant=drag.torque(omega),
        seals=1000.0 * losses.drag_at_input(omega, ratio),
    )
    if (missing := force_without_sliding(pairs, increments)) > SMALL_SHARE:
        logger.warning(
            "the friction of the flanks leaves out %.3g %% of their force: the contacts of these "
            "pairs are not known",
            100.0 * missing,
        )
    total, useful = sum(astuple(parts)), 1000.0 * design.load.torque / abs(ratio)
    at_rest = friction * losses.static_friction / dry + hysteresis
    at_rest += drag.torque(0.0) + 1000.0 * losses.drag_at_input(0.0, ratio)
    found = DriveLosses(
        loss_torque_Nmm=total,
        parts_Nmm=parts,
        work_per_turn_J=2e-3 * np.pi * total,
        power_W=1e-3 * total * omega,
        efficiency=useful / (useful + total) if useful else None,
        no_load_torque_Nmm=None if useful else total,
        starting_torque_Nmm=None if useful else at_rest,
        cam_force_N=float(forces.mean()),
        flank_friction_coefficient=flank_coefficient(design),
    )
    table = {
        "increment": np.array(increments),
        "flank_friction_Nmm": sliding,
        "bearing_Nmm": bearing,
        "cam_force_N": forces,
    }
    return found, table


def _bearing_diameter(design: DriveDesign) -> float:
    """Diameter (mm) on which the bearing's friction acts: that of the balls' centres, or without
    them of the bore."""
    return (
        2.0 * design.inner_radius if design.bearing is None else design.bearing_sizes.pitch_diameter
    )


def bearing_drag(design: DriveDesign) -> BearingDrag:
    """Drag of the lubricant in the bearing, with the coefficients of [losses]."""
    losses = design.losses
    return BearingDrag(
        factor=losses.lubrication_factor,
        viscosity=losses.lubricant_viscosity or 0.0,
        diameter=_bearing_diameter(design),
        relative=1.0 - design.kinematics.spline_speed,
    )


def flank_coefficient(design: DriveDesign) -> float:
    """Coefficient of friction between the flanks: that of the run, or that of [losses] in a run
    without friction."""
    return design.contact.friction or design.losses.flank_friction


def _flank_torque(design: DriveDesign, pairs: Sequence[Row], increment: int, copies: int) -> float:
    """Power of the friction between the flanks over the speed of the wave generator, N mm."""
    omega, coefficient = design.load.input_rate, flank_coefficient(design)
    here = [
        pair
        for pair in pairs
        if pair["increment"] == increment and np.isfinite(pair["sliding_mm_s"])
    ]
    work = sum(pair["force_N"] * abs(pair["sliding_mm_s"]) for pair in here)
    # the force of a pair in a run with friction has its tangential part
    share = coefficient / np.hypot(1.0, coefficient) if design.contact.friction else coefficient
    return float(copies * share * work / omega)


def force_without_sliding(pairs: Sequence[Row], increments: Sequence[int]) -> float:
    """Share of the force of all pairs whose contact, and with it their sliding, is not known."""
    here = [pair for pair in pairs if pair["increment"] in increments]
    force = sum(pair["force_N"] for pair in here)
    missing = sum(pair["force_N"] for pair in here if np.isnan(pair["sliding_mm_s"]))
    return missing / force if force else 0.0


def hysteresis_work(cycle: StressCycle) -> float:
    """Work (N mm) per turn of the wave generator that the spline takes with a loss factor of 1;
    collective."""
    model, layout = cycle.model, cycle.body.layout
    mine, stress = cycle.history()
    thickness = model.design.drive.face_width if layout.mesh.plane else None
    material, sectors = model.design.materials["flexible_spline"], cycle.sequence.kinematics.pitches
    # the mean of sectors that are not alike stands for all
    per_cycle = [
        work_per_cycle(model.comm, layout, cycle.nodes[nodes], values, material, thickness)
        for nodes, values in zip(
            np.split(mine, sectors), np.split(stress, sectors, axis=1), strict=True
        )
    ]
    return float(np.mean(per_cycle)) * 2.0 * np.pi / cycle.angle


def work_per_cycle(
    comm: MPI.Comm,
    layout: BodyLayout,
    nodes: np.ndarray,
    stress: np.ndarray,
    material: Material,
    thickness: float | None,
) -> float:
    """Work (N mm) that all sectors of a body take in a cycle with a loss factor of 1; collective.

    Harmonic n of the stress at a point goes through n cycles in a cycle of the drive. With a loss
    factor eta each of them takes 2 pi eta times the strain energy of its amplitude.

    nodes : (n,) of the elements of this rank;  stress : (n_phases, n, 6) MPa over the cycle
    thickness : mm, in the plane; None for a solid
    """
    amplitude = np.fft.rfft(stress, axis=0)[1:] * (2.0 / len(stress))
    if len(stress) % 2 == 0:
        amplitude[-1] *= 0.5
    amplitude *= np.sqrt(np.arange(1.0, len(amplitude) + 1.0))[:, None, None]
    features = energy_coordinates(amplitude, material)
    local = np.full(len(layout.mesh.coords), -1)
    local[nodes] = np.arange(len(nodes))
    elements, energy = layout.mesh.elements[elements_of_rank(comm, layout)], 0.0
    for start in range(0, len(elements), CHUNK):
        chunk = elements[start : start + CHUNK]
        matrix, values = mass_matrices(layout.mesh.coords, chunk, thickness), features[local[chunk]]
        energy += float((np.matmul(matrix, values) * values).sum())
    return 2.0 * np.pi * layout.mesh.n_sectors * comm.allreduce(energy, op=MPI.SUM)


def energy_coordinates(amplitude: np.ndarray, material: Material) -> np.ndarray:
    """Numbers (n, m) whose squares add up to the strain energy density (MPa) of amplitudes (k, n,
    6) MPa, complex.

    The density is half of the product of stress and strain, in plane stress as well: with the
    compliance L L^T it is
    |L^T s|^2 / 2. A law has to be the same in all directions of the plane xy, because the stress is
    in global axes.
    """
    coordinates = amplitude @ np.linalg.cholesky(0.5 * material.compliance())
    stacked = np.concatenate([coordinates.real, coordinates.imag], axis=0)
    return np.moveaxis(stacked, 1, 0).reshape(amplitude.shape[1], -1)

"""drive.inp: a job of CalculiX from the undeformed drive to its loaded state, with the mesh in
drive_mesh.inp.

Steps:

1. The inner surface of the flexible spline gets the displacement of the bent spline; no contact
acts.
2. It is let go on the cam. The output does not rotate.
3. The flanks may touch. The output rotates until the loaded flanks meet.
4. The torque acts in place of that rotation.
5. Nothing changes. CalculiX keeps the places of contact of the beginning of an increment. Where
surfaces slide in
   it, forces on both are not on one line. In this step nothing slides.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from swgpar.analysis.bent_start import BentSpline
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.exchange.calculix_model import JobModel, Surface, Term
from swgpar.exchange.cam_facets import OUTER_FACE, CamFacets, cam_facets
from swgpar.load.negligible_torque import negligible_torque
from swgpar.meshing import MeshRecipe
from swgpar.meshing.inp import write_inp

JOB, MESH = "drive.inp", "drive_mesh.inp"

PAIRS = {
    "cam": "FLEXIBLE_SPLINE_INNER, CAM",
    "clockwise flanks": "FLEXIBLE_SPLINE_CLOCKWISE, RING_GEAR_COUNTER_CLOCKWISE",
    "counter-clockwise flanks": "FLEXIBLE_SPLINE_COUNTER_CLOCKWISE, RING_GEAR_CLOCKWISE",
}
"""Slave and master of every contact pair."""

CAM, *FLANKS = PAIRS.values()

CAM_OVERHANG = 0.1
"""Of the plane model's cam over either end, as a share of the face width."""


def write_calculix(design: DriveDesign, recipe: MeshRecipe, folder: Path) -> list[Path]:
    """Write the job and its mesh; `ccx -i drive` in the folder runs it.

    Raises
    ------
    InputError
        The design has what the job does not carry.
    """
    _check(design)
    model = JobModel(design, recipe)
    mesh, job = folder / MESH, folder / JOB
    write_inp(
        mesh,
        model.drive,
        model.surfaces,
        design.materials,
        design.drive.face_width,
        plane_stress=model.plane,
    )
    half = 0.5 * design.wave_generator.face_width
    if model.plane:
        half = (0.5 + CAM_OVERHANG) * design.drive.face_width
    cam = cam_facets(design, half, model.inner_gap())
    with job.open("w", encoding="ascii") as file:
        file.writelines(f"{line}\n" for line in _job(model, cam))
    return [job, mesh]


def _check(design: DriveDesign) -> None:
    """Refuse what the job does not carry."""

    def refuse(what: str, allowed: str) -> None:
        raise InputError(f"{what} is not available with the format inp: allowed {allowed}")

    if design.contact.friction:
        refuse(f"contact.friction = {design.contact.friction:g}", "0")
    sections = {
        "[wave_generator.bearing]": design.bearing,
        "[ring_gear.housing]": design.ring_gear.housing,
        "[dynamic_spline]": design.dynamic_spline,
        "[deviations]": design.deviations,
        "[stiffness]": design.stiffness,
        "[ratcheting]": design.ratcheting,
        "load.program": design.load.program,
    }
    for key, given in sections.items():
        if given:
            refuse(key, "a design without it")
    if design.has_attachment:
        refuse(f'cup.attachment = "{design.cup.attachment}"', '"edge"')
    least = 0.001 * negligible_torque(design)
    if design.load.torque <= least:
        refuse(
            f"load.torque = {design.load.torque:g} N·m",
            f"above {least:.3g} N·m, which closes the backlash",
        )


def _numbered(numbers: Iterable[int]) -> str:
    return ", ".join(str(k) for k in numbers)


def _equation(terms: list[Term]) -> Iterator[str]:
    yield from ("*EQUATION", str(len(terms)))
    for k in range(0, len(terms), 4):
        yield ", ".join(
            f"{node + 1}, {axis}, {factor:.12e}" for node, axis, factor in terms[k : k + 4]
        )


def _job(model: JobModel, cam: CamFacets) -> Iterator[str]:
    design, ring_fixed = model.design, model.design.kinematics.standing_gear == "ring_gear"
    output = len(model.points) + len(cam.points)
    bore, outer = model.surface(model.spline, "bore"), model.surface(model.ring, "outer")
    planar = ("ALL_NODES, 3, 3",) if model.plane else ()
    fixed = ["CAM, 1, 3", *planar]
    bore_held: list[str] = []
    if ring_fixed:
        fixed.append(f"RING_GEAR_OUTER, 1, {2 if model.plane else 3}")
        equations = [*model.mean_motion(bore, output)]
    else:
        equations = [*model.mean_motion(outer, output, in_housing=True), *model.housing(outer)]
        equations += model.mean_motion(bore, output + 2)
        bore_held = [f"{output + 3}, 1, 3", f"{output + 4}, 1, 3"]
    held, rotation = (
        [f"{output + 1}, 1, 3", f"{output + 2}, 1, 2", *bore_held],
        f"{output + 2}, 3, 3",
    )
    dependent = {terms[0][0] for terms in equations}
    equations += model.ties() if model.plane else ()

    yield from _heading(model, cam)
    yield f"*INCLUDE, INPUT={MESH}"
    yield from _cam(model, cam)
    yield from ("*NODE, NSET=OUTPUT", f"{output + 1}, 0., 0., 0.", f"{output + 2}, 0., 0., 0.")
    if bore_held:
        yield from ("*NODE, NSET=HELD", f"{output + 3}, 0., 0., 0.", f"{output + 4}, 0., 0., 0.")
    for terms in equations:
        yield from _equation(terms)
    for name, penalty in (
        ("ON_CAM", design.wg_penalty),
        ("ON_FLANKS", design.penalty("flexible_spline", "ring_gear")),
    ):
        yield from (
            f"*SURFACE INTERACTION, NAME={name}",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        )
        yield f"{penalty:.12g}"
    for pair in PAIRS.values():
        name = "ON_CAM" if pair == CAM else "ON_FLANKS"
        yield from (f"*CONTACT PAIR, INTERACTION={name}, TYPE=SURFACE TO SURFACE", pair)
    yield from ("*BOUNDARY", *fixed)

    ring_held = [line for line in [*held, rotation] if not ring_fixed and line not in bore_held]
    yield from _bend(model, dependent, ring_held)
    yield from _step("2: on the cam", "*BOUNDARY, OP=NEW", *fixed, *held, rotation, add=[CAM])
    rotate = ("*BOUNDARY", f"{rotation}, {model.closing_rotation:.12e}")
    yield from _step("3: the loaded flanks meet", *rotate, add=FLANKS, acting=[CAM, *FLANKS])
    load = ["*BOUNDARY, OP=NEW", *fixed, *held, *_torque(model, bore if ring_fixed else outer)]
    yield from _step("4: torque", *load, acting=[CAM, *FLANKS], parameters=", AMPLITUDE=STEP")
    yield from _step("5: at rest", acting=[CAM, *FLANKS], parameters=", AMPLITUDE=STEP")


def _heading(model: JobModel, cam: CamFacets) -> Iterator[str]:
    yield from (
        "** from the undeformed drive to its loaded state, at the end of step 5; mm, N, MPa, rad",
        "** drive.frd: displacements and stresses",
        "** drive.dat: rotation of the output, the third displacement of the last node of OUTPUT; "
        "contact forces, of",
        "** which the moment mz about the origin is the torque of the cam or of the flanks on the "
        "flexible spline",
        f"** facets deviate by up to {cam.sagitta:.3g} mm from the cam and {model.flank_gap():.3g} "
        "mm from the flanks",
    )


def _cam(model: JobModel, cam: CamFacets) -> Iterator[str]:
    """The cam, whose nodes are all fixed: a rigid surface."""
    n, m = len(model.points), model.n_elements
    yield "*NODE, NSET=CAM"
    for k, (x, y, z) in enumerate(cam.points, start=n + 1):
        yield f"{k}, {x:.12e}, {y:.12e}, {z:.12e}"
    yield "*ELEMENT, TYPE=C3D8, ELSET=CAM"
    for k, nodes in enumerate(cam.elements + n + 1, start=m + 1):
        yield f"{k}, {_numbered(nodes)}"
    yield from (
        "*SOLID SECTION, ELSET=CAM, MATERIAL=FLEXIBLE_SPLINE_MATERIAL",
        "*SURFACE, NAME=CAM, TYPE=ELEMENT",
    )
    yield f"CAM, S{OUTER_FACE + 1}"


def _bend(model: JobModel, dependent: set[int], held: Iterable[str]) -> Iterator[str]:
    """Step 1. dependent : nodes whose displacement an equation gives;  held : further boundary
    conditions"""
    nodes = np.array([k for k in model.inner_nodes() if k not in dependent])
    u = BentSpline(model.design).displacement(model.points[nodes])
    lines = ["*BOUNDARY", *held]
    for node, values in zip(nodes + 1, u, strict=True):
        lines += [
            f"{node}, {k}, {k}, {values[k - 1]:.12e}"
            for k in ((1, 2) if model.plane else (1, 2, 3))
        ]
    yield from _step("1: bent without contact", *lines, remove=list(PAIRS.values()))


def _torque(model: JobModel, surface: Surface) -> Iterator[str]:
    """Forces of the torque: those of the distributing coupling at the angle zero of the output."""
    torque = model.design.kinematics.internal_torque(model.design.load.torque)
    x = model.points[surface.nodes, :2]
    share = torque * surface.weight / float((surface.weight * (x**2).sum(axis=1)).sum())
    yield "*CLOAD"
    for node, (fx, fy) in zip(
        surface.nodes + 1, share[:, None] * np.column_stack([-x[:, 1], x[:, 0]]), strict=True
    ):
        yield from (f"{node}, 1, {fx:.12e}", f"{node}, 2, {fy:.12e}")


def _step(
    name: str,
    *lines: str,
    add: Iterable[str] = (),
    remove: Iterable[str] = (),
    acting: Iterable[str] = (),
    parameters: str = "",
) -> Iterator[str]:
    """A step of one increment, which CalculiX divides where it has to.

    add, remove, acting : contact pairs that are switched on, off, or whose forces are printed
    """
    yield from (
        f"** step {name}",
        f"*STEP, NLGEOM, INC=1000{parameters}",
        "*STATIC",
        "1., 1., 1e-6",
    )
    for action, pairs in (("REMOVE", remove), ("ADD", add)):
        for pair in pairs:
            yield from (f"*MODEL CHANGE, TYPE=CONTACT PAIR, {action}", pair)
    yield from lines
    yield from ("*NODE PRINT, NSET=OUTPUT, FREQUENCY=1000", "U")
    for pair in acting:
        slave, master = pair.split(", ")
        yield from (f"*CONTACT PRINT, SLAVE={slave}, MASTER={master}, FREQUENCY=1000", "CF")
    yield from ("*NODE FILE, FREQUENCY=1000", "U", "*EL FILE, FREQUENCY=1000", "S", "*END STEP")

"""drive.inp: a job of CalculiX from the undeformed drive to its loaded state, with the mesh in
drive_mesh.inp.

Steps:

1. The inner surface of the flexible spline gets the displacement of the bent spline, without
   contact. Bodies and the rigid frame get their temperatures and fits.
2. It is let go on the cam. The output does not rotate.
3. The flanks may touch. The output rotates until the loaded flanks meet.
4. The torque acts in place of that rotation, with the forces on the output.
5. Nothing changes. CalculiX keeps the places of contact of the beginning of an increment. Where
   surfaces slide in it, forces on both are not on one line. In this step nothing slides.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from swgpar.analysis.bent_spline import BentSpline
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.exchange.calculix_growth import initial_temperature, temperatures
from swgpar.exchange.calculix_model import JobModel, Term
from swgpar.exchange.calculix_supports import JobSupports
from swgpar.exchange.cam_facets import OUTER_FACE, CamFacets, cam_facets
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


def write_calculix(design: DriveDesign, folder: Path, recipe: MeshRecipe) -> list[Path]:
    """Write the job and its mesh; `ccx -i drive` in the folder runs it.

    Raises InputError where the design has what the job does not carry.
    """
    _check(design)
    model = JobModel(design, recipe)
    mesh, job = folder / MESH, folder / JOB
    width, half = design.drive.face_width, 0.5 * design.wave_generator.face_width
    write_inp(mesh, model.drive, model.surfaces, design.materials, width, plane_stress=model.plane)
    if model.plane:
        half = (0.5 + CAM_OVERHANG) * width
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
    if not design.wave_generator.lobes_are_alike:
        refuse("wave_generator.distance", "0")
    sections = {
        "[wave_generator.bearing]": design.bearing,
        "[ring_gear.housing]": design.ring_gear.housing,
        "[dynamic_spline]": design.dynamic_spline,
        "[deviations]": design.deviations,
        "[stiffness]": design.stiffness,
        "[ratcheting]": design.ratcheting,
        "load.program": design.load.program,
        "load.inertia = true": design.load.inertia,
    }
    for key, given in sections.items():
        if given:
            refuse(key, "a design without it")
    if design.frame_growth and design.kinematics.standing_gear != "ring_gear":
        refuse(
            "a temperature or a fit of [ring_gear.frame] around a ring gear that rotates",
            'drive.layout = "ring_fixed", because the guide in the job does not grow',
        )
    least = 0.001 * design.negligible_torque
    if design.load.torque <= least:
        refuse(
            f"load.torque = {design.load.torque:g} N·m",
            f"above {least:.3g} N·m, which closes the backlash",
        )


def _equation(terms: list[Term]) -> Iterator[str]:
    yield from ("*EQUATION", str(len(terms)))
    written = [f"{node + 1}, {axis}, {factor:.12e}" for node, axis, factor in terms]
    for k in range(0, len(written), 4):
        yield ", ".join(written[k : k + 4])


def _job(model: JobModel, cam: CamFacets) -> Iterator[str]:
    design = model.design
    supports = JobSupports(
        model,
        len(model.points) + len(cam.points) + 1,
        model.n_elements + len(cam.elements) + 1,
    )
    yield from _heading(model, cam)
    yield f"*INCLUDE, INPUT={MESH}"
    yield from _cam(model, cam)
    yield from supports.lines()
    for terms in (*supports.equations, *(model.ties() if model.plane else ())):
        yield from _equation(terms)
    on_flanks = design.penalty("flexible_spline", "ring_gear")
    for name, penalty in (("ON_CAM", design.wg_penalty), ("ON_FLANKS", on_flanks)):
        yield f"*SURFACE INTERACTION, NAME={name}"
        yield from ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{penalty:.12g}")
    for pair in PAIRS.values():
        name = "ON_CAM" if pair == CAM else "ON_FLANKS"
        yield from (f"*CONTACT PAIR, INTERACTION={name}, TYPE=SURFACE TO SURFACE", pair)
    # the facets of the cam are at their places at its temperature
    yield from initial_temperature(model, "CAM", "OUTPUT")
    fixed = ["CAM, 1, 3", *supports.fixed]
    yield from ("*BOUNDARY", *fixed)
    yield from _bend(model, supports)
    held, rotation = [*fixed, *supports.frame, *supports.held], f"{supports.turn}, 3"
    yield from _step("2: on the cam", "*BOUNDARY, OP=NEW", *held, rotation, add=[CAM])
    rotate = ("*BOUNDARY", f"{rotation}, {model.closing_rotation:.12e}")
    yield from _step("3: the loaded flanks meet", *rotate, add=FLANKS, acting=[CAM, *FLANKS])
    load = ["*BOUNDARY, OP=NEW", *held, *supports.loads()]
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
        yield ", ".join(map(str, (k, *nodes)))
    yield "*SOLID SECTION, ELSET=CAM, MATERIAL=FLEXIBLE_SPLINE_MATERIAL"
    yield from ("*SURFACE, NAME=CAM, TYPE=ELEMENT", f"CAM, S{OUTER_FACE + 1}")


def _bend(model: JobModel, supports: JobSupports) -> Iterator[str]:
    """Step 1."""
    dependent = {terms[0][0] for terms in supports.equations}
    nodes = np.array([k for k in model.inner_nodes() if k not in dependent])
    bent = model.displaced(nodes, BentSpline(model.design).displacement(model.points[nodes]))
    growth = supports.flange.forces() if supports.flange else ()
    lines = [*temperatures(model), *growth, "*BOUNDARY", *supports.frame]
    if supports.bearing or not supports.ring_fixed:  # the inner surface holds the spline
        lines += supports.output_held
    if not supports.ring_fixed:
        lines.append(f"{supports.turn}, 3")
    yield from _step("1: bent without contact", *lines, *bent, remove=[CAM, *FLANKS])


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
    yield from (f"** step {name}", f"*STEP, NLGEOM, INC=1000{parameters}")
    yield from ("*STATIC", "1., 1., 1e-6")
    for action, pairs in (("REMOVE", remove), ("ADD", add)):
        for pair in pairs:
            yield from (f"*MODEL CHANGE, TYPE=CONTACT PAIR, {action}", pair)
    yield from lines
    yield from ("*NODE PRINT, NSET=OUTPUT, FREQUENCY=1000", "U")
    for pair in acting:
        slave, master = pair.split(", ")
        yield from (f"*CONTACT PRINT, SLAVE={slave}, MASTER={master}, FREQUENCY=1000", "CF")
    yield from ("*NODE FILE, FREQUENCY=1000", "U", "*EL FILE, FREQUENCY=1000", "S", "*END STEP")

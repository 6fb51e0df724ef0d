"""The job of CalculiX: its cam, its constraints, and what it refuses; `tests/verification` runs
it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial import cKDTree

import swgpar
from support.bearing import BEARING
from support.cup_shapes import ATTACHED
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.errors import InputError
from swgpar.exchange.calculix import write_calculix
from swgpar.exchange.calculix_flange import Flange
from swgpar.exchange.calculix_model import JobModel
from swgpar.exchange.cam_facets import OUTER_FACE, SAGITTA, cam_facets
from swgpar.geometry.rotation import rotated
from swgpar.meshing import load_recipe
from swgpar.meshing.inp import HEX_FACES
from swgpar.meshing.quality import hex_volumes
from swgpar.model.drive_model import build_drive_model

ROLLERS = ("wave_generator.type=four_roller", "wave_generator.beta=15", "wave_generator.r_4=4")


@pytest.mark.parametrize(
    "overrides", [(), PLANE, (*PLANE, *ROLLERS)], ids=["cup", "plane", "rollers"]
)
def test_facets_lie_on_the_cam(overrides: tuple[str, ...]) -> None:
    design = swgpar.load_design(DESIGN, overrides)
    inset = 5e-4
    cam = cam_facets(design, 2.0, inset)
    assert cam.sagitta <= SAGITTA * design.drive.module
    assert hex_volumes(cam.points, cam.elements).min() > 0.0
    outer = cam.elements[:, HEX_FACES[OUTER_FACE]]
    level, *_ = design.cam_surface().evaluate(cam.points[np.unique(outer)])
    assert level == pytest.approx(np.full(len(level), 2.0 / 3.0 * cam.sagitta - inset), abs=1e-6)
    middles = cam.points[outer].mean(axis=1)
    height = design.cam_surface().evaluate(middles)[0] + inset
    # along the width the facets have a height of their own, where crowning curves the cam
    crowned = design.micro_geometry.wg_crowning / 16**2
    assert np.abs(height).max() < cam.sagitta + crowned


@pytest.mark.parametrize("overrides", [(), PLANE], ids=["cup", "plane"])
def test_equations_of_a_gear_in_a_guide_that_follows(overrides: tuple[str, ...]) -> None:
    """The ring gear moves with its bearing, 9 mm from the middle, and turns in its guide."""
    model = JobModel(
        swgpar.load_design(DESIGN, [*overrides, "drive.layout=spline_fixed"]), load_recipe(RECIPE)
    )
    surface, n = model.surface(model.ring, "outer"), len(model.points)
    middle = float(model.points[surface.mean, 2].mean())
    lever = 0.0 if model.plane else 9.0
    x = model.points - [0.0, 0.0, middle]
    move = np.array([2e-3, -1e-3, 0.0 if model.plane else 3e-3])
    tilt = np.array([1e-4, -2e-4, 0.0]) * (not model.plane)
    u = move + np.cross(tilt, x - [0.0, 0.0, lever])
    angle = model.closing_rotation
    u[:, :2] += rotated(x[:, :2], angle) - x[:, :2]
    at_zero = move + np.cross(tilt, [0.0, 0.0, -middle - lever])
    values = {
        n: move,
        n + 1: [*tilt[:2], np.sin(angle)],
        n + 2: at_zero,
        n + 3: [tilt[1], -tilt[0], 0.0],
    }
    place = middle + 9.0
    means = [*model.mean_motion(surface, n, place=place, in_housing=True, guide=n + 2)]
    rows = [*means, *model.housing(surface.nodes, n + 2)]
    dependent = [terms[0][:2] for terms in rows]
    assert len(set(dependent)) == len(rows)
    assert len(means) == (3 if model.plane else 6)
    assert not {term[:2] for terms in means for term in terms[1:]} & set(dependent)
    for terms in rows:
        found = sum(f * (values[k] if k >= n else u[k])[axis - 1] for k, axis, f in terms)
        # a tilt by 2e-4 of what is rotated
        assert abs(found) < 1e-9 * sum(abs(f) for *_, f in terms)


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parametrize("overrides", [(), PLANE], ids=["cup", "plane"])
def test_equations_give_the_mean_motion(overrides: tuple[str, ...], layout: str) -> None:
    """A small rigid motion, and the waves of a bent spline, which have no mean."""
    model = JobModel(
        swgpar.load_design(DESIGN, [*overrides, f"drive.layout={layout}"]), load_recipe(RECIPE)
    )
    bodies = {"bore": model.spline} | ({"outer": model.ring} if layout == "spline_fixed" else {})
    move, turn = np.array([2e-3, -1e-3, 3e-3]), np.array([1e-4, -2e-4, 3e-4])
    for name, mesh in bodies.items():
        surface = model.surface(mesh, name)
        housed = name == "outer"
        x = model.points.copy()
        x[:, 2] -= x[surface.mean, 2].mean()
        angle = np.arctan2(x[:, 1], x[:, 0])
        tilt = turn * (0.0 if model.plane else 1.0, 0.0 if model.plane else 1.0, 1.0)
        shift = move * (not housed, not housed, not model.plane)
        u = np.cross(tilt, x) + shift
        if not housed:
            for order in (2, 4, 6):
                wave = np.column_stack([np.cos(order * angle), 0.3 * np.sin(order * angle)])
                u[:, :2] += 0.1 * rotated(wave, angle)
        else:  # on their circle, by the angle at which the flanks meet
            u[:, :2] = rotated(x[:, :2], model.closing_rotation) - x[:, :2]
            tilt[2] = np.sin(model.closing_rotation)
        values = {(len(u), k): shift[k - 1] for k in (1, 2, 3)} | {
            (len(u) + 1, k): tilt[k - 1] for k in (1, 2, 3)
        }
        equations = list(model.mean_motion(surface, len(u), in_housing=housed))
        dependent = [terms[0][:2] for terms in equations]
        assert (
            len(set(dependent))
            == len(equations)
            == (1 if housed else 3) + (0 if model.plane else 3)
        )
        for terms in equations:
            assert not {term[:2] for term in terms[1:]} & set(dependent)
            found = sum(f * (values[n, k] if n >= len(u) else u[n, k - 1]) for n, k, f in terms)
            assert abs(found) < 1e-12 * sum(abs(f) for *_, f in terms)
        if housed:
            assert all(
                abs(sum(f * u[n, k - 1] for n, k, f in terms)) < 1e-12
                for terms in model.housing(surface.nodes)
            )


def test_forces_have_the_torque_of_the_design(tmp_path: Path) -> None:
    design = swgpar.load_design(DESIGN, PLANE)
    job, mesh = swgpar.export(design, tmp_path, ["inp"], mesh=RECIPE)
    points = JobModel(design, load_recipe(RECIPE)).points
    text = job.read_text()
    forces = [line.split(", ") for line in text.split("*CLOAD\n")[1].split("*")[0].splitlines()]
    moment = 0.0
    for node, axis, force in forces:
        x, y, _ = points[int(node) - 1]
        moment += float(force) * (x if axis == "2" else -y)
    assert moment == pytest.approx(200.0)
    assert f"*INCLUDE, INPUT={mesh.name}" in text


@pytest.mark.parametrize(
    "change, words",
    [
        (
            "contact.friction=0.1",
            "contact.friction = 0.1 is not available with the format inp: allowed 0",
        ),
        (
            "load.torque=0",
            "load.torque = 0 N·m is not available with the format inp: allowed above",
        ),
        ("load.torque=1e-5", "load.torque = 1e-05 N·m"),
        (BEARING, "[wave_generator.bearing] is not available"),
        ("deviations.flexible_spline.eccentricity=0.01", "[deviations] is not available"),
        ("stiffness.torque=0.2", "[stiffness] is not available"),
        ("ratcheting.increment=0.1", "[ratcheting] is not available"),
        (("material.density=7850", "load.inertia=true"), "load.inertia = true is not available"),
        (
            ("ring_gear.frame.interference=0.01", "drive.layout=spline_fixed"),
            "a temperature or a fit of [ring_gear.frame] around a ring gear that rotates is not",
        ),
    ],
)
def test_what_the_job_does_not_carry(
    tmp_path: Path, change: str | tuple[str, ...], words: str
) -> None:
    design = swgpar.load_design(
        DESIGN, [*PLANE, *([change] if isinstance(change, str) else change)]
    )
    with pytest.raises(InputError) as raised:
        swgpar.export(design, tmp_path, ["inp"], mesh=RECIPE)
    assert words in str(raised.value)


WARM = ("material.expansion=12e-6", "flexible_spline.temperature=70")


def _after(text: str, keyword: str) -> list[list[str]]:
    """Fields of the lines that follow a keyword, up to the next one."""
    lines = text.split(f"{keyword}\n")[1].split("*")[0].splitlines()
    return [line.split(", ") for line in lines]


@pytest.mark.parametrize("overrides", [(), PLANE], ids=["cup", "plane"])
def test_temperatures_and_the_fit_of_the_frame(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    fit = ("ring_gear.frame.interference=0.02", "wave_generator.temperature=95")
    design = swgpar.load_design(DESIGN, [*overrides, *WARM, *fit, "load.reference_temperature=15"])
    job, mesh = swgpar.export(design, tmp_path, ["inp"], mesh=RECIPE)
    model, text = JobModel(design, load_recipe(RECIPE)), job.read_text()
    assert {float(value) for _, value in _after(text, "*INITIAL CONDITIONS, TYPE=TEMPERATURE")} == {
        15.0
    }
    found = dict(_after(text, "*TEMPERATURE"))
    assert found == {"FLEXIBLE_SPLINE_NODES": "70", "RING_GEAR_NODES": "15"}
    assert _after(text, "*NSET, NSET=FLEXIBLE_SPLINE_NODES, GENERATE") == [
        ["1", str(model.n_spline)]
    ]
    # nothing moves along z in the plane
    expansion = "\n1.2e-05\n" if not model.plane else ", TYPE=ORTHO\n1.2e-05, 1.2e-05, 0\n"
    assert mesh.read_text().count(f"*EXPANSION{expansion}") == 2
    # the bore of the frame is smaller by 0.01 mm of radius, in step 1 and where conditions are new
    outer = {str(node + 1) for node in model.surface(model.ring, "outer").nodes}
    radius = design.geometry.outer_radius
    for k, step in enumerate(text.split("*STEP, NLGEOM")[1:], start=1):
        moved = [
            line.split(", ")
            for line in step.splitlines()
            if line.split(", ")[0] in outer and line.count(",") == 3
        ]
        assert len(moved) == (0 if k in (3, 5) else len(outer) * (2 if model.plane else 3))
        for node, axis, _, value in moved:
            x = model.points[int(node) - 1][int(axis) - 1] if axis != "3" else 0.0
            assert float(value) == pytest.approx(-0.01 / radius * x, abs=1e-12)
    # the cam grows by 80 K
    cold = cam_facets(swgpar.load_design(DESIGN, overrides), 2.0, 0.0).points
    warm = cam_facets(design, 2.0, 0.0).points
    growth = np.hypot(*warm.T[:2]).max() / np.hypot(*cold.T[:2]).max() - 1.0
    assert growth == pytest.approx(12e-6 * 80.0, rel=0.01)


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parametrize("attachment", ATTACHED)
def test_a_flange_has_the_bedding_of_the_program(
    tmp_path: Path, attachment: str, layout: str
) -> None:
    design = swgpar.load_design(
        DESIGN, [*ATTACHED[attachment], *WARM, f"drive.layout={layout}", "solver.symmetry=false"]
    )
    job, _ = swgpar.export(design, tmp_path, ["inp"], mesh=RECIPE)
    model, text = JobModel(design, load_recipe(RECIPE)), job.read_text()
    flange = Flange(model, 1, 1)
    own = build_drive_model(design, load_recipe(RECIPE), comm=MPI.COMM_SELF)
    bedding = own.problem.supports.couplings[0]
    distance, places = cKDTree(bedding.undeformed).query(model.points[flange.nodes])
    assert distance.max() < 1e-9
    assert flange.stiffness == pytest.approx(bedding.stiffness[places], rel=1e-9)
    assert len(flange.nodes) == len(bedding.nodes)
    grown = flange.growth - (bedding.on_flange - bedding.arm)[places]
    assert np.abs(grown).max() < 1e-12
    # three springs each, whose stiffness the file has
    sections = text.split("*ELEMENT, TYPE=SPRING2, ELSET=BEDDING_")[1:]
    stiffness = np.zeros(3)
    for section in sections:
        elements, law = section.split("*SPRING, ELSET=BEDDING_")
        _, freedoms, value = law.splitlines()[:3]
        axis = int(freedoms.split(",")[0])
        stiffness[axis - 1] += (len(elements.splitlines()) - 1) * float(value)
    assert stiffness == pytest.approx(np.full(3, flange.stiffness.sum()), rel=1e-7)
    loads = text.split("*CLOAD\n")
    # forces of the growth of step 1 are in equilibrium
    forces = np.array(_after(text, "*CLOAD"), dtype=float)
    assert np.abs(forces[:, 2]).max() > 1.0
    assert abs(forces[:, 2].sum()) < 1e-9 * np.abs(forces[:, 2]).sum()
    last = loads[-1].split("*")[0].splitlines()
    if layout == "ring_fixed":  # the torque on the node of the rotations
        (load,) = (line.split(", ") for line in last)
        assert load[1] == "3"
        assert float(load[2]) == pytest.approx(2000.0)
    else:  # forces on the ring gear
        assert len(last) > 100


def test_a_mesh_is_needed_for_the_job_and_for_nothing_else(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='format = "inp" needs a mesh recipe'):
        swgpar.export(DESIGN, tmp_path, ["inp"])
    with pytest.raises(InputError, match="a mesh recipe is of no use"):
        swgpar.export(DESIGN, tmp_path, ["dxf"], mesh=RECIPE)


def test_a_standing_wave_generator_changes_nothing_up_to_the_loaded_state(tmp_path: Path) -> None:
    """The flexible spline is the output there as well; the ring gear has not turned yet."""
    jobs = []
    for layout in ("ring_fixed", "wave_generator_fixed"):
        folder = tmp_path / layout
        folder.mkdir()
        job, _ = write_calculix(
            swgpar.load_design(DESIGN, [*PLANE, f"drive.layout={layout}"]),
            folder,
            load_recipe(RECIPE),
        )
        jobs.append(job.read_text().replace(",", " ").split())
    number = re.compile(r"-?\d\.\d+e[+-]\d+")
    words, values = (
        [[w for w in job if bool(number.fullmatch(w)) == real] for job in jobs]
        for real in (False, True)
    )
    assert words[0] == words[1]
    first, second = (np.array(found, dtype=float) for found in values)
    assert second == pytest.approx(first, rel=1e-9, abs=1e-12)

"""Runs with and without what spares work give the same results; on 1, 2 and 3 ranks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stepping import load_stepper, row
from swgpar import load_design
from swgpar.analysis.coarse_start import MeshedDrive, levels, start_loaded
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.mesh_refinement import choose_mesh
from swgpar.evaluation.period import continued
from swgpar.fem.body import RING_GEAR
from swgpar.fem.vectors import read_field
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import Stage
from swgpar.meshing import load_recipe
from swgpar.results.history import OUTPUT_COLUMNS
from swgpar.solve.factor_reuse import MAX_ITERATIONS

PHYSICAL = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm", "output_angle_deg")
STATE = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")
PLAIN = ("solver.far_teeth=modelled", "solver.keep_factor=false")
ONE_INCREMENT = "steps.rotation=1.5"
"""Where nothing follows from the state before."""


def rotated(
    *overrides: str,
    recipe: str | Path = RECIPE,
    comm: MPI.Comm = MPI.COMM_WORLD,
    prepare: Callable[[LoadStepper], None] = lambda stepper: None,
) -> tuple[LoadStepper, dict[str, float]]:
    """The small drive turned by two increments of 1.5 degrees, and its last history row.

    prepare : called on the undeformed drive
    """
    design = load_design(DESIGN, ["steps.rotation=3", "steps.increment=1.5", *overrides])
    mesh = load_recipe(recipe)
    stepper = load_stepper(design, comm, mesh)
    prepare(stepper)
    sequence = load_sequence(design)
    items = sequence.states
    if design.steps.start_levels or design.steps.bent_start:
        recipes = levels(design.start_levels, mesh)
        assert len(recipes) == design.steps.start_levels
        start_loaded(stepper, MeshedDrive(design, stepper.model.comm), recipes)
        items = sequence.from_loaded[1:]
    for item in items:
        stepper.advance(item)
    return stepper, row(stepper)


def assert_same(row: dict[str, float], other: dict[str, float], rel: float) -> None:
    for name in PHYSICAL:
        print(f"{name}: {row[name] / other[name] - 1.0:+.1e}")
        parallel_assert(
            row[name] == pytest.approx(other[name], rel=rel),
            f"{name}: {row[name]} and {other[name]}",
        )


@pytest.fixture(scope="module")
def plain() -> dict[str, float]:
    return rotated(*PLAIN)[1]


@pytest.mark.parallel([1, 2])
def test_a_kept_factor_changes_nothing(plain: dict[str, float]) -> None:
    stepper, row = rotated("solver.far_teeth=modelled")
    counts = stepper.solver.system.reused.iterations
    print(f"GMRES iterations {counts}")
    assert np.mean(np.array(counts) < MAX_ITERATIONS) > 0.8 and np.median(counts) < 20
    assert_same(row, plain, 1e-6)


@pytest.mark.parallel([1, 2])
def test_a_kept_factor_changes_nothing_in_the_plane() -> None:
    stepper, row = rotated(*PLANE, "solver.far_teeth=modelled")
    counts = stepper.solver.system.reused.iterations
    assert len(counts) > 3 and np.mean(np.array(counts) < MAX_ITERATIONS) > 0.8
    assert_same(row, rotated(*PLAIN, *PLANE)[1], 1e-6)


@pytest.mark.parametrize("cost", [0.0, 1e9])
def test_a_factor_renewed_after_every_solve_or_never_changes_nothing(
    cost: float, plain: dict[str, float]
) -> None:
    def set_price(stepper: LoadStepper) -> None:
        stepper.solver.system.solver.price = lambda matrix: cost

    _, row = rotated("solver.far_teeth=modelled", prepare=set_price)
    assert_same(row, plain, 1e-6)


def test_a_start_without_pins_changes_nothing(plain: dict[str, float]) -> None:
    _, row = rotated(*PLAIN, "steps.pins=false")
    assert_same(row, plain, 1e-6)


def test_a_start_without_pins_changes_nothing_in_the_plane() -> None:
    _, pinned = rotated(*PLAIN, *PLANE)
    _, row = rotated(*PLAIN, *PLANE, "steps.pins=false")
    assert_same(row, pinned, 1e-6)


def test_search_over_candidate_teeth_only() -> None:
    """Flanks as far as five modules apart instead of those that can meet."""

    def look_far(stepper: LoadStepper) -> None:
        problem = stepper.problem
        problem.contact_search = replace(problem.contact_search, tip_margin=5.0 * problem.module)

    far, all_pairs = rotated(*PLAIN, *PLANE, prepare=look_far)
    near, candidates = rotated(*PLAIN, *PLANE)
    wide, few = (len(stepper.problem.flanks_of(RING_GEAR).pairs) for stepper in (far, near))
    print(f"{few} of {wide} pairs of flanks")
    assert few < wide
    assert_same(all_pairs, candidates, 1e-6)


@pytest.mark.parametrize(
    ("override", "rel"), [("contact.friction=0.2", 1e-4), ("drive.layout=spline_fixed", 1e-6)]
)
def test_a_kept_factor_with_friction_and_in_the_other_layout(override: str, rel: float) -> None:
    """Friction's tractions live at segments that Newton's iterates fix, here other ones: 8e-6 of
    the ring's stress."""
    stepper, row = rotated("solver.far_teeth=modelled", override, ONE_INCREMENT)
    assert np.median(stepper.solver.system.reused.iterations) < 20
    _, alone = rotated(*PLAIN, override, ONE_INCREMENT)
    assert_same(row, alone, rel)


def test_a_start_on_a_coarser_mesh_changes_nothing(plain: dict[str, float]) -> None:
    _, row = rotated(*PLAIN, "steps.start_levels=1")
    assert_same(row, plain, 1e-6)


def test_a_start_from_the_bent_shape_changes_nothing(plain: dict[str, float]) -> None:
    _, row = rotated(*PLAIN, "steps.bent_start=true")
    assert_same(row, plain, 1e-6)


@pytest.mark.parametrize("overrides", [(), ("drive.layout=spline_fixed",), ("load.torque=0",)])
def test_a_start_from_the_bent_shape_changes_nothing_in_the_plane(
    overrides: tuple[str, ...],
) -> None:
    _, step_by_step = rotated(*PLAIN, *PLANE, *overrides)
    _, row = rotated(*PLAIN, *PLANE, *overrides, "steps.bent_start=true")
    for name in PHYSICAL:  # without a torque the input torque vanishes
        same = row[name] == pytest.approx(step_by_step[name], rel=1e-6, abs=1e-6)
        parallel_assert(same, f"{name}: {row[name]} and {step_by_step[name]}")


@pytest.mark.parametrize("count", [1, pytest.param(2, marks=pytest.mark.parallel(2))])
def test_a_start_on_coarser_meshes_changes_nothing_in_the_plane(count: int) -> None:
    refined = "plane_coarse"
    _, step_by_step = rotated(*PLAIN, *PLANE, recipe=refined)
    _, row = rotated(*PLAIN, *PLANE, f"steps.start_levels={count}", recipe=refined)
    assert_same(row, step_by_step, 1e-6)


@pytest.mark.parallel(2)
def test_far_teeth_change_little() -> None:
    """80 teeth, of which a third is out of reach; measured are changes of 1e-12 in stresses and
    1e-8 in the torque."""
    many = ("drive.teeth_fs=80", "drive.teeth_rg=82", *PLANE, "solver.keep_factor=false")
    _, all_teeth = rotated("solver.far_teeth=modelled", *many)
    stepper, near_teeth = rotated(*many)
    print(f"{stepper.problem.modelled.ring_sectors.active.sum()} of 41 ring-gear sectors")
    assert stepper.problem.modelled.ring_sectors.active.sum() < 38
    assert_same(near_teeth, all_teeth, 1e-6)


@pytest.mark.parametrize(
    "overrides", [(), ("contact.friction=0.2",), ("drive.layout=spline_fixed",)]
)
def test_condensed_teeth_change_little(overrides: tuple[str, ...]) -> None:
    """They leave out the bend of the tooth where it stands on the rim: with 40 teeth 5e-4 of the
    compression there."""
    plain_stepper, plain = rotated(*PLAIN, *overrides)
    stepper, row = rotated("solver.keep_factor=false", *overrides)
    whole = [int(teeth.active.sum()) for teeth in stepper.problem.modelled.whole_teeth]
    print(f"{whole} whole teeth")
    assert not plain_stepper.problem.modelled.whole_teeth and max(whole) < 12
    rows, all_rows = (one.problem.blocks.matrix.getSize()[0] for one in (stepper, plain_stepper))
    print(f"{rows} of {all_rows} rows")
    assert rows < 0.9 * all_rows
    assert_same(row, plain, 1e-3)
    # everywhere, inside too
    for fields, others in zip(
        stepper.model.stresses()[1].values(), plain_stepper.model.stresses()[1].values()
    ):
        assert (
            np.abs(fields["displacement"] - others["displacement"]).max()
            < 1e-4 * stepper.design.deflection
        )
        if "s1" in fields and not overrides:
            assert np.abs(fields["s1"] - others["s1"]).max() < 4e-3 * plain["fs_vm"]


@pytest.mark.parallel([2, 3])
def test_condensed_teeth_on_any_number_of_ranks() -> None:
    """The results, and what is read of sectors of any rank, images too."""
    stepper, row = rotated(ONE_INCREMENT)
    _, alone = rotated(ONE_INCREMENT, comm=MPI.COMM_SELF)
    assert_same(row, alone, 1e-7)
    model = stepper.model
    u = model.problem.displacement()
    for k, body in model.elements.bodies.items():
        field = read_field(model.partition, k, body.sectors, model.problem.x)
        parallel_assert(np.abs(field - body.displacement(u)).max(initial=0.0) < 1e-14)


MANY = ("drive.teeth_fs=80", "drive.teeth_rg=82", *PLANE)
CONDENSED = (*MANY, "solver.condensed_sectors=true")


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("contact.friction=0.2",),
        ("drive.layout=spline_fixed",),
        ("solver.linear=iterative",),
        ("ring_gear.housing.thickness=4", "ring_gear.housing.material={E=70e3, nu=0.29}"),
    ],
)
def test_condensed_sectors_in_the_plane_leave_out_the_bend_of_a_sector(
    overrides: tuple[str, ...],
) -> None:
    """E theta^2 / 8 of the bending stress; half as much again for the load's part and the nodal
    averages."""
    stepper, plain = rotated(*MANY, *overrides)
    condensed_stepper, condensed = rotated(*CONDENSED, *overrides)
    design = stepper.design
    assert 0.5 * stepper.model.partition.n_global > condensed_stepper.model.partition.n_global
    left_out = condensed_stepper.model.omitted_bending_stress()
    assert stepper.model.omitted_bending_stress() == 0.0
    bending = (
        0.75
        * design.material.E
        * design.flexible_spline.rim
        * design.deflection
        / design.inner_radius**2
    )
    # 6.6 % more than by the formula, which is that of a smooth ring: a sector bends more between
    # its thick teeth
    assert left_out == pytest.approx(1.066 * design.omitted_bending * bending, rel=0.01)
    share = 1.5 * design.omitted_bending
    assert 1e-3 < share < 0.015
    assert_same(condensed, plain, share)
    # everywhere, inside too
    for fields, others in zip(
        condensed_stepper.model.stresses()[1].values(), stepper.model.stresses()[1].values()
    ):
        assert (
            np.abs(fields["displacement"] - others["displacement"]).max(initial=0.0)
            < 2e-3 * design.deflection
        )
        for name in ("s1", "s3", "vm"):
            assert np.abs(fields[name] - others[name]).max(initial=0.0) < share * plain["fs_vm"], (
                name
            )


@pytest.mark.parallel([1, 2, 3])
def test_what_is_read_of_condensed_sectors_is_complete() -> None:
    """Sectors of any rank, images too, with what is inside of them."""
    stepper, _ = rotated(*CONDENSED)
    model = stepper.model
    u = model.problem.displacement()
    for k, body in model.elements.bodies.items():
        parallel_assert(np.abs(body.displacement(u)).max(initial=0.0) > 0.0)
        field = read_field(model.partition, k, body.sectors, model.problem.x)
        parallel_assert(np.abs(field - body.displacement(u)).max(initial=0.0) < 1e-14)


@pytest.mark.parallel(2)
def test_condensed_sectors_with_all_that_applies() -> None:
    refined, keys = "plane_coarse", (*CONDENSED, ONE_INCREMENT)
    _, row = rotated(*keys, recipe=refined)
    for further in (("steps.start_levels=1", "steps.pins=false"), ("solver.symmetry=false",)):
        _, other = rotated(*keys, *further, recipe=refined)
        assert_same(other, row, 1e-6)


def test_a_start_on_a_coarser_mesh_takes_over_what_is_inside() -> None:
    """The loaded state is as close as without condensed sectors."""
    iterations = []
    for condensed in (False, True):
        overrides = [
            *CONDENSED[:-1],
            "steps.start_levels=1",
            f"solver.condensed_sectors={str(condensed).lower()}",
        ]
        design, mesh = load_design(DESIGN, overrides), load_recipe("plane_coarse")
        stepper = load_stepper(design, recipe=mesh)
        drive = MeshedDrive(design, stepper.model.comm)
        start_loaded(stepper, drive, levels(design.start_levels, mesh))
        iterations.append(stepper.iterations)
    print(iterations)
    assert iterations[1] <= iterations[0] + 1


@pytest.mark.parallel([2, 3])
def test_condensed_sectors_on_any_number_of_ranks() -> None:
    _, row = rotated(*CONDENSED, ONE_INCREMENT)
    _, alone = rotated(*CONDENSED, ONE_INCREMENT, comm=MPI.COMM_SELF)
    assert_same(row, alone, 1e-7)  # the input torque is what is left of moments 1e3 times as large


def test_the_continued_history_is_that_of_a_longer_rotation() -> None:
    design = load_design(DESIGN, [*PLANE, "steps.samples=4", "steps.rotation=11"])
    stepper = load_stepper(design)
    rows = []
    sequence = load_sequence(design)
    for item in sequence.states:
        stepper.advance(item)
        if item.stage >= Stage.LOAD:
            rows.append({**stepper.row(), **stepper.model.stresses()[0], "wall_s": 1.0})
    again, following = continued(sequence, rows)[4:6]
    assert again["wg_angle_deg"] == pytest.approx(np.degrees(design.kinematics.period_angle))
    assert {k: again[k] for k in STATE} == {k: rows[0][k] for k in STATE}
    stepper.advance(replace(stepper.load_state, angle=1.25 * design.kinematics.period_angle))
    computed = row(stepper)
    assert following["wg_angle_deg"] == pytest.approx(
        np.degrees(1.25 * design.kinematics.period_angle)
    )
    assert_same(following, computed, 1e-6)


def test_the_displacement_of_the_output_goes_round_with_the_wave() -> None:
    """Odd numbers of teeth push the output aside on its bearing, against the wave generator always
    in the same direction."""
    bearing = [f"output_bearing.{key}_stiffness=1e4" for key in ("radial", "axial", "tilting")]
    teeth = ["drive.teeth_fs=41", "drive.teeth_rg=43", "steps.samples=2", "steps.rotation=17"]
    design = load_design(DESIGN, [*PLANE, *teeth, *bearing])
    stepper, sequence, rows = load_stepper(design), load_sequence(design), []
    for state in sequence.states:
        stepper.advance(state)
        if state.stage >= Stage.LOAD:
            rows.append({**stepper.row(), "wall_s": 1.0})
    third = continued(sequence, rows)[2]
    stepper.advance(replace(stepper.load_state, angle=design.kinematics.period_angle))
    computed = stepper.row()
    names = OUTPUT_COLUMNS[:2]
    found, expected, before = (
        np.array([one[name] for name in names]) for one in (third, computed, rows[0])
    )
    assert np.linalg.norm(found - expected) < 1e-5 * np.linalg.norm(expected)
    assert np.linalg.norm(before - expected) > 0.1 * np.linalg.norm(expected)


@pytest.mark.parallel(2)
def test_a_mesh_is_chosen_alike_on_any_number_of_ranks() -> None:
    """The recipe, the loaded state on it and the estimated error, in space as well."""
    design = load_design(DESIGN, ["steps.rotation=3", "solver.rtol=1e-9"])
    found = []
    for comm in (MPI.COMM_WORLD, MPI.COMM_SELF):
        chosen = choose_mesh(MeshedDrive(design, comm), load_recipe(RECIPE), 0.2)
        # a coarser mesh than this one would not find the contacts: it is compared with a finer one
        assert chosen.error <= 0.2 and chosen.model.recipe.flexible_spline.flank == 3
        found.append((chosen, chosen.model.stresses()[0]))
        chosen.model.destroy()
    (here, stress), (alone, other) = found
    parallel_assert(here.model.recipe == alone.model.recipe)
    parallel_assert(
        here.error == pytest.approx(alone.error, rel=1e-5), f"{here.error} and {alone.error}"
    )
    parallel_assert(stress == pytest.approx(other, rel=1e-7), f"{stress} and {other}")

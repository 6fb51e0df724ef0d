"""Drives at the limits of their keys: the hardest cases of the groups, and some random ones; the
rest is the bench's.

Every case turns through one and a half pitches of the fixed gear: the state repeats.
"""

from __future__ import annotations

import pytest
from mpi4py import MPI

from support.commands import assert_same_history, run_command, succeed
from support.drive_groups import MESH, ONCE_FAILED, drift, groups, table_of
from support.small_drive import PLANE
from support.stepping import load_stepper, row
from swgpar.checks.design_file import make_drive
from swgpar.errors import InputError
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import load_recipe

WORLD = MPI.COMM_WORLD
ALL = groups(count=4, seed=7)
HARDEST = [
    ("rim, plane reference", "rim=0.18"),
    ("teeth, plane reference", "teeth=20"),
    ("torque, plane reference", "torque=0.01"),
    ("friction, plane", "friction=0.5"),
    ("gaps, plane reference", "c_P=0.7"),
    ("overlap, plane", "c_P=1.05"),
    ("increments, plane", "increment=10"),
    ("penalty without augmentation, plane", "wg_penalty_coef=500"),
]


def run(group: str, case: str) -> None:
    """Every increment converges, torques balance, and without friction the state repeats."""
    design = make_drive(table_of(ALL[group].design, ALL[group].cases()[case]))
    stepper = load_stepper(design, recipe=load_recipe(MESH))
    rows = []
    try:
        for load_state in load_sequence(design).states:
            stepper.advance(load_state)
            rows.append(row(stepper))
    finally:
        stepper.model.destroy()
    torque = 1000.0 * design.load.torque
    for found in rows[2:]:
        assert abs(found["output_torque_Nmm"]) == pytest.approx(torque)
        assert found["torque_balance_Nmm"] < 1e-5 * torque
    if not design.contact.friction and not ALL[group].steps:
        assert drift(rows[3], rows[5]) < 1e-6


ON_TWO_RANKS = ("friction, plane", "gaps, plane reference", "overlap, plane")
"""Groups whose active sets change most: decisions of the iteration must be those of all ranks."""


@pytest.mark.parametrize(
    ("group", "case"),
    [
        *HARDEST,
        *(
            pytest.param(group, case, marks=pytest.mark.parallel(2), id=f"{group}, 2 ranks")
            for group, case in HARDEST
            if group in ON_TWO_RANKS
        ),
    ],
)
def test_hardest(group: str, case: str) -> None:
    run(group, case)


@pytest.mark.parametrize("case", ALL[ONCE_FAILED].make())
def test_design_that_once_failed(case: str) -> None:
    run(ONCE_FAILED, case)


@pytest.mark.parametrize("number", range(4))
def test_random_design(number: int) -> None:
    run("random designs, plane", sorted(ALL["random designs, plane"].make())[number])


def test_bulging_cam_is_refused() -> None:
    """A parabola too flat for its width drives the spline's teeth through the ring gear's root
    circle."""
    flat = {
        "type": "parabolic",
        "C": 1.0,
        "a_p": 0.008,
        "C_p": 0.5,
        "r_c": 10.0,
        "face_width": 10.0,
    }
    with pytest.raises(
        InputError,
        match=r"bulges .* mm beyond .* allowed up to 0.2 mm.*wave_generator\.C "
        r".*wave_generator\.a_p",
    ):
        make_drive(table_of(ALL["rim, plane reference"].design, {"wave_generator": flat}))


def test_more_ranks_than_cores(tmp_path) -> None:
    """The same on one rank and on four, whatever the machine has."""
    for ranks in (1, 4):
        overrides = (*PLANE, "steps.rotation=0")
        succeed(run_command(tmp_path / str(ranks), ranks=ranks, overrides=overrides))
    assert_same_history(tmp_path / "4", tmp_path / "1", 1e-8, iterations=False)

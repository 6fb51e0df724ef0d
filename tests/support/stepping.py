"""The small drive on its smallest mesh, brought to load states in this process, for tests of what
is computed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import Stage
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.model.drive_model import build_drive_model

WORLD = MPI.COMM_WORLD
MODELS = {"cup": (), "plane": PLANE}
"""Overrides of the small drive by name of the model."""

Row = dict[str, float]
"""Quantities of one state: a row of the history, with the largest stresses."""


def small(model: str, *overrides: str) -> DriveDesign:
    """The small drive as "cup" or "plane"."""
    return load_design(DESIGN, [*MODELS[model], *overrides])


def load_stepper(
    design: DriveDesign, comm: MPI.Comm = WORLD, recipe: MeshRecipe | None = None
) -> LoadStepper:
    """The undeformed drive; on the smallest mesh if no recipe is given."""
    return LoadStepper(build_drive_model(design, recipe or load_recipe(RECIPE), comm=comm))


def row(stepper: LoadStepper) -> Row:
    return {**stepper.row(), **stepper.model.stresses()[0]}


def loaded(
    design: DriveDesign,
    comm: MPI.Comm = WORLD,
    prepare: Callable[[LoadStepper], None] = lambda stepper: None,
) -> tuple[LoadStepper, Row]:
    """The drive under its torque, the wave generator not yet rotated. prepare : called on the
    undeformed drive"""
    stepper = load_stepper(design, comm)
    prepare(stepper)
    for state in load_sequence(design).states:
        if state.stage <= Stage.LOAD:
            stepper.advance(state)
    return stepper, row(stepper)


def rotate(stepper: LoadStepper, angle: float) -> Row:
    """Row after rotating the wave generator to `angle` (rad)."""
    stepper.advance(replace(stepper.load_state, stage=Stage.ROTATE, step=4, angle=angle))
    return row(stepper)


def assert_agree(a: Row, b: Row, names: Iterable[str], rel: float) -> None:
    """Named quantities of two states agree on every rank, relative to those of the second."""
    for name in names:
        parallel_assert(
            a[name] == pytest.approx(b[name], rel=rel), f"{name}: {a[name]} and {b[name]}"
        )

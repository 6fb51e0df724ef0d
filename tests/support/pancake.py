"""The small pancake drive on its smallest mesh, loaded in this process."""

from __future__ import annotations

from mpi4py import MPI

from support.paths import DATA
from support.stepping import WORLD, Row, load_stepper, row
from swgpar import load_design
from swgpar.analysis.bent_start import bend
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import MeshRecipe


def pancake(*overrides: str) -> DriveDesign:
    return load_design(DATA / "pancake.toml", list(overrides))


def loaded_pancake(
    design: DriveDesign, comm: MPI.Comm = WORLD, recipe: MeshRecipe | None = None
) -> tuple[LoadStepper, Row]:
    """The drive under its torque, from the bent shape; on the smallest mesh if no recipe is
    given."""
    stepper = load_stepper(design, comm, recipe)
    bend(stepper.model)
    stepper.jump(load_sequence(design).loaded)
    return stepper, row(stepper)

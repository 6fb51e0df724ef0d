"""Runs of one drive under several loads share models and loaded states, and find what each finds
alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.paths import RECIPE
from support.stepping import small
from swgpar.analysis import model_sources
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.model_sources import LoadedDrives
from swgpar.analysis.run_drive import run_drive
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import to_toml
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.run_options import RunOptions
from swgpar.studies.case import Outcome
from swgpar.studies.job import run_one
from swgpar.systems.drive import Drives

WORLD = MPI.COMM_WORLD
SAMPLED = ("steps.samples=2", "steps.rotation=9.0")
WITHOUT = ("output.root_stress=false", "output.fields=false")
DENSE = ("material.density=7850", "frequencies.number=1", "frequencies.output_inertia=1e-5")
LOADS = [
    (*SAMPLED, "load.torque=0.2"),
    (*SAMPLED, "load.torque=0.3"),
    (*SAMPLED, "load.torque=0.0"),
    (*DENSE, "load.torque=0.2", "steps.rotation=0"),
    ("stiffness.positions=1", "stiffness.points=1", "stiffness.torque=0.2"),
]
"""Overrides of the loads; a period without a torque and modes of the whole drive among them."""


def runs(friction: float) -> list[DriveDesign]:
    loads = LOADS[:3] if friction else LOADS
    rubbed = (f"contact.friction={friction}", "steps.rotation=18.0") if friction else ()
    return [small("plane", *WITHOUT, *load, *rubbed) for load in loads]


@pytest.mark.parallel([1, 2])
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_shared_models_give_the_results_of_each_run_alone(
    friction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With friction a loaded state depends on the path to it: only the model is shared."""
    options = RunOptions(recipe=load_recipe(RECIPE), comm=WORLD)
    build, built = model_sources.build_drive_model, []
    monkeypatch.setattr(
        model_sources,
        "build_drive_model",
        lambda *keys, **more: built.append(None) or build(*keys, **more),
    )
    drives = LoadedDrives()
    for design in runs(friction):
        shared = run_drive(design, options, drives)
        count = len(built)
        alone = run_drive(design, options)
        del built[count:]
        for name in ("wg_torque_Nmm", "output_torque_Nmm", "output_angle_deg"):
            a, b = shared.history[name][-1], alone.history[name][-1]
            near = np.isclose(a, b, rtol=1e-4, atol=1e-4)  # N·mm, deg: what solves leave
            parallel_assert(bool(near), f"{name} of {design.load.torque:g} N·m: {a} and {b}")
        for name in ("stiffness.K1", "stiffness.lost_motion", "frequency.1"):
            if name in alone.summary:
                a, b = (one.summary[name] for one in (shared, alone))
                parallel_assert(a.value == pytest.approx(b.value, rel=1e-4), name)
                if b.error is not None:
                    parallel_assert(a.error == pytest.approx(b.error, rel=0.02), name)
    drives.destroy()
    expected = 1 if friction else 2  # half of the drive, and with its modes the whole
    parallel_assert(len(built) == expected, str(len(built)))


class ChoiceError(Exception):
    """Ends a run where it has its first mesh."""


@pytest.fixture
def first(monkeypatch: pytest.MonkeyPatch) -> list[MeshRecipe]:
    """The mesh that each choice begins with, where it ends."""
    begun: list[MeshRecipe] = []

    def choose(drive: MeshedDrive, begin: MeshRecipe, *_: object, **__: object) -> None:
        begun.append(begin)
        raise ChoiceError

    monkeypatch.setattr("swgpar.analysis.run_drive.choose_mesh", choose)
    return begun


def test_a_choice_begins_with_the_mesh_of_another_load(first: list[MeshRecipe]) -> None:
    """Of the same drive, for the same accuracy."""
    recipe, chosen = load_recipe(RECIPE), load_recipe("plane_coarse")
    drives = LoadedDrives()
    loaded = with_shortcuts(small("plane", *SAMPLED, "load.torque=0.3"), recipe, levels=False)
    drives.keep_mesh(loaded.design, recipe, 0.05, chosen)
    for more, accuracy in ((), 0.05), ((), 0.1), (("ring_gear.rim=1.6",), 0.05):
        options = RunOptions(recipe=recipe, accuracy=accuracy)
        with pytest.raises(ChoiceError):
            run_drive(small("plane", "load.torque=0.2", *SAMPLED, *more), options, drives)
    assert first == [chosen, recipe, recipe]


@pytest.mark.parametrize("finished", [True, False])
def test_a_choice_begins_with_the_mesh_of_an_earlier_call(
    finished: bool, first: list[MeshRecipe], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether that call has finished the run under the other load, or left a checkpoint of it."""
    chosen, folder = load_recipe("plane_coarse"), tmp_path / "before"
    folder.mkdir()
    (folder / "recipe.toml").write_bytes(to_toml(chosen.model_dump()).encode())
    (folder / "status.json").write_text('{"status": "finished"}' if finished else "{}")
    kept = Outcome("finished", kept=True)
    monkeypatch.setattr("swgpar.studies.job._finished_before", lambda *_: kept)
    options = RunOptions(recipe=load_recipe(RECIPE), accuracy=0.05, comm=MPI.COMM_SELF)
    system = Drives(LoadedDrives())
    with monkeypatch.context() as patched:
        patched.setattr("swgpar.analysis.run_drive.prepare", lambda *_, **__: True)
        patched.setattr(LoadedDrives, "take", lambda *_: 1 / 0)  # ends the run that is continued
        before = small("plane", *SAMPLED, "load.torque=0.3")
        outcome = run_one(system, before, replace(options, out=folder, restart=True))
    assert outcome.kept == finished
    run_one(system, small("plane", *SAMPLED, "load.torque=0.2"), options)
    assert first == [chosen]

"""Where a run has its models from: built for it alone, or shared by runs of one drive under several
loads."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import Any

from mpi4py import MPI

from swgpar.analysis.identity import identity
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.predictor import KnownState
from swgpar.analysis.transfer import interpolations, meshed_alike, transfer
from swgpar.design.drive_design import DriveDesign
from swgpar.input.differences import differ_little
from swgpar.load.load_states import LoadState
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel, build_drive_model
from swgpar.petsc import PETSc


class ModelSource(ABC):
    """Gives models of drives on meshes, and takes them back. All calls are collective."""

    @abstractmethod
    def take(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> DriveModel:
        """The model of a design on the mesh of a recipe. Raises InputError where the recipe gives
        no mesh of it."""

    @abstractmethod
    def give_back(self, model: DriveModel) -> None:
        """Nobody uses the model any more."""

    @abstractmethod
    def drop(self, model: DriveModel) -> None:
        """Release a model in which a solve has failed."""

    @abstractmethod
    def keep_loaded(self, stepper: LoadStepper) -> None:
        """The stepper has reached the loaded state of its run."""

    @abstractmethod
    def keep_period(self, stepper: LoadStepper) -> None:
        """The stepper has gone through a sampled period."""

    @abstractmethod
    def resume(self, stepper: LoadStepper) -> bool:
        """Set the stepper to a loaded state of its model under another load; False where none is
        known, or where friction makes it depend on the path."""

    @abstractmethod
    def first_mesh(self, design: DriveDesign, recipe: MeshRecipe, accuracy: float) -> MeshRecipe:
        """The mesh that a choice for an accuracy begins with, from the recipe that is asked for:
        the one that was chosen for this drive under another load, if there is one."""

    @abstractmethod
    def keep_mesh(
        self, design: DriveDesign, recipe: MeshRecipe, accuracy: float, chosen: MeshRecipe
    ) -> None:
        """A mesh was chosen for an accuracy. recipe : that was asked for"""


class NewModels(ModelSource):
    """Builds every model anew."""

    def take(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> DriveModel:
        return build_drive_model(design, recipe, comm=comm)

    def give_back(self, model: DriveModel) -> None:
        model.destroy()

    def drop(self, model: DriveModel) -> None:
        model.destroy()

    def keep_loaded(self, stepper: LoadStepper) -> None:
        pass

    def keep_period(self, stepper: LoadStepper) -> None:
        pass

    def resume(self, stepper: LoadStepper) -> bool:
        return False

    def first_mesh(self, design: DriveDesign, recipe: MeshRecipe, accuracy: float) -> MeshRecipe:
        return recipe

    def keep_mesh(
        self, design: DriveDesign, recipe: MeshRecipe, accuracy: float, chosen: MeshRecipe
    ) -> None:
        pass


NEAR = 0.02
"""Relative difference of numbers up to which the loaded states of two drives are near: one of S-
shaped teeth then takes 3 to 8 iterations from the other, and 24 from the bent shape."""

MOST_STATES = 12
"""Loaded states of a model that are kept, the last ones."""

UNLOADED = 0.01
"""Share of the largest torque of the known states up to which a state is a start for one without
torque. From a larger one flanks let go one after the other: 52 iterations in a cup with balls that
takes some 20 from the bent shape."""

LIKE_TORQUE = 0.5
"""Difference of two torques, over the larger one, up to which the period under one guides the
predictions under the other. Without torque a cup with balls takes 5 or 6 iterations an angle, and
10 to 12 guided by the period under its repeated peak torque."""

NEW_MODELS = NewModels()
"""Of a run that shares none."""


@dataclass
class LoadedDrive:
    """A model that several runs use, and what it has reached.

    keys : of the drive, without its mesh and what of it is modelled
    model : with the factor of its last tangent
    loaded : load states that runs have begun with, and their vectors
    period : states over a sampled period, from the loaded one on; empty without one
    period_torque : N mm, under which they are
    """

    keys: dict[str, Any]
    model: DriveModel
    loaded: list[tuple[LoadState, PETSc.Vec]] = field(default_factory=list)
    period: list[KnownState] = field(default_factory=list)
    period_torque: float = 0.0


class LoadedDrives(ModelSource):
    """The models of drives on several meshes, with the loaded states that they have reached.

    Designs share a model where they differ in the load and in what is asked of the states under it
    only (`DriveDesign.model_keys`). Without friction an equilibrium does not depend on the path to
    it: a run starts with that of the nearest torque.

    most : models that are kept, those that were used last; None for all
    keeps_windows : whether models keep meshes and factors of windows for further loads
    starts_near : whether a drive whose numbers differ by up to `NEAR` from those of another one
        begins with its loaded state
    """

    def __init__(
        self, most: int | None = None, *, keeps_windows: bool = False, starts_near: bool = False
    ) -> None:
        self.most, self.keeps_windows, self.starts_near = most, keeps_windows, starts_near
        self._free: dict[str, LoadedDrive] = {}
        self._taken: dict[str, LoadedDrive] = {}
        self._chosen: dict[str, MeshRecipe] = {}

    def take(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> DriveModel:
        key = identity({**design.model_keys, "modelled": design.modelled_part}, recipe, None)
        drive = self._free.pop(key, None)
        if drive is None:
            model = build_drive_model(design, recipe, comm=comm)
            model.keeps_windows = self.keeps_windows
            drive = LoadedDrive(design.model_keys, model)
        else:
            drive.model = replace(drive.model, design=design)
            drive.model.phases.seconds.clear()
            drive.model.solver.monitor = None
            LoadStepper(drive.model).reset()
        self._taken[key] = drive
        return drive.model

    def give_back(self, model: DriveModel) -> None:
        model.release_windows()
        key = self._key(model)
        self._free[key] = self._taken.pop(key)  # the last one of those that are free
        while self.most is not None and len(self._free) > self.most:
            self._free.pop(next(iter(self._free))).model.destroy()

    def drop(self, model: DriveModel) -> None:
        self._taken.pop(self._key(model))
        model.destroy()

    def keep_loaded(self, stepper: LoadStepper) -> None:
        if not stepper.design.contact.friction:
            drive = self._taken[self._key(stepper.model)]
            state = stepper.load_state
            others = [one for one in drive.loaded if one[0].torque != state.torque]
            drive.loaded = [*others, (state, stepper.problem.x.copy())][-MOST_STATES:]

    def keep_period(self, stepper: LoadStepper) -> None:
        if not stepper.design.contact.friction:
            drive = self._taken[self._key(stepper.model)]
            drive.period = list(stepper.known_states)
            drive.period_torque = stepper.load_state.torque

    def resume(self, stepper: LoadStepper) -> bool:
        drive, target = self._taken[self._key(stepper.model)], stepper.sequence.loaded
        if stepper.design.contact.friction or target.angle:
            return False
        # where the wave generator has turned balls are elsewhere at another speed of the cage
        reached = [
            (one, state, x) for one in self._all() for state, x in one.loaded if not state.angle
        ]
        known = [each for each in reached if each[0].keys == drive.keys]
        alike = not known and self.starts_near
        if alike:
            known = [each for each in reached if _are_near(each[0], drive)]
        if not target.torque and known:
            enough = UNLOADED * max(abs(state.torque) for _, state, _ in known)
            known = [each for each in known if abs(each[1].torque) <= enough]
        if not known:
            return False
        # of drives alike the last one: a key is changed little by little, and it has the factor
        nearest, stepper.load_state, x = min(
            reversed(known),
            key=lambda one: (
                abs(one[1].torque - target.torque),
                one[0] is not drive,
                -one[0].model.n_elements(),
            ),
        )
        if nearest is drive:
            x.copy(stepper.problem.x)
        else:
            matrices = None if alike else interpolations(nearest.model, stepper.model)
            transfer(nearest.model, x, stepper.model, stepper.problem.x, matrices)
            if alike:
                # the same sectors of the ring gear in full, where they will do
                stepper.problem.resume_sectors(nearest.model.problem.modelled.chosen())
                stepper.solver.take_over_factor(nearest.model.solver)
        if math.isclose(target.torque, drive.period_torque, rel_tol=LIKE_TORQUE):
            stepper.guides = drive.period
        return True

    def first_mesh(self, design: DriveDesign, recipe: MeshRecipe, accuracy: float) -> MeshRecipe:
        return self._chosen.get(identity(design.model_keys, recipe, accuracy), recipe)

    def keep_mesh(
        self, design: DriveDesign, recipe: MeshRecipe, accuracy: float, chosen: MeshRecipe
    ) -> None:
        self._chosen[identity(design.model_keys, recipe, accuracy)] = chosen

    def destroy(self) -> None:
        """Release all models."""
        for drive in self._all():
            drive.model.destroy()
        self._free, self._taken = {}, {}

    def _all(self) -> list[LoadedDrive]:
        return [*self._free.values(), *self._taken.values()]

    def _key(self, model: DriveModel) -> str:
        return next(key for key, drive in self._taken.items() if drive.model is model)


def _are_near(first: LoadedDrive, second: LoadedDrive) -> bool:
    """Whether a loaded state of one drive is a start for the other one."""
    little = differ_little(first.keys, second.keys, NEAR)
    return little and meshed_alike(first.model, second.model)

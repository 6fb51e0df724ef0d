"""The drive with deviations at the angles of whole turns of the wave generator.

The ideal drive repeats after one pitch of the fixed gear with its teeth renamed, with bolts after
several. So every angle of a turn is an angle of the first period at which the deviations have been
renamed: the ideal state is known, and only the deviations differ. Where these repeat, the states do
too, and each is computed once.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.deviation_guess import DeviationGuess, ModelledState
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.turn_drive import (
    WORTH_GUESSES,
    checked_share,
    turn_design,
    turn_mesh,
    turned_pitches,
)
from swgpar.constraints.distributing_coupling import TILT_X, TILT_Y, X, Y
from swgpar.constraints.supports import SPLINE_COUPLING
from swgpar.contact.flank_deviations import flank_deviations
from swgpar.contact.flank_state import SearchRange
from swgpar.contact.rigid_surface import SurfacePose, cam_pose
from swgpar.design.deviations import gear_deviations
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.errors import ConvergenceError
from swgpar.evaluation.transmission_error import TurnPoint
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.fem.partition import split
from swgpar.geometry.rotation import rotated
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel
from swgpar.model.torques import torques
from swgpar.petsc import PETSc

NEAR = 0.06
"""Distance over the module within which flanks are followed; the check after every solve finds
those that it misses."""

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Step between numbers in [0, 1) that are even, and have no period in common with teeth."""

STEPS = (4, 16)
"""Equal steps from the ideal state to the deviations where these cannot be reached at once; then
more of them."""


class DeviatingDrive:
    """The loaded drive with deviations; all calls are collective.

    Parameters
    ----------
    design : with deviations and a torque;  recipe : of the run's mesh
    comm : communicator

    Attributes
    ----------
    bore_z : mm, of the middle of the bore
    tables : deviations of all flanks;  periods : numbers of pitches after which those of each gear
    repeat
    per_period : angles of a period of the ideal drive;  angles : those of all turns
    ideals : load state and x of the ideal drive at the angles of a period, once they are needed
    """

    def __init__(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> None:
        self.design, self.deviations = turn_design(design), design.deviations
        mesh = turn_mesh(design, recipe)
        self.model: DriveModel = MeshedDrive(self.design, comm).load(mesh)
        problem = self.model.problem
        near = NEAR * design.drive.module + design.backlash
        problem.contact_search = replace(
            problem.contact_search, distances=SearchRange(near=near, reach=near, touch=near)
        )
        self.stepper = LoadStepper(self.model)
        self.loaded = self.stepper.sequence.loaded
        self.stepper.resume_at(self.loaded)
        of_spline, of_ring = (
            gear_deviations(self.deviations, gear, design.teeth(gear)) for gear in GEARS
        )
        layouts = self.model.partition.layouts
        self.tables = flank_deviations(
            layouts[FLEXIBLE_SPLINE], layouts[RING_GEAR], of_spline, of_ring, design.axial_travel
        )
        bore = problem.supports.gear_couplings[SPLINE_COUPLING]
        self.bore_z = float(bore.sum(bore.weight * bore.undeformed[:, 2]))
        spline, ring = self.tables.periods()
        cup = self.deviations.cup
        self.periods = (design.drive.teeth_fs if cup.eccentricity or cup.tilt else spline, ring)
        per_pitch = self.deviations.angles_per_pitch
        self.per_period = design.kinematics.pitches * per_pitch
        self.angles = turned_pitches(design) * per_pitch
        self.ideals: list[tuple[LoadState, PETSc.Vec]] = []

    def destroy(self) -> None:
        """Release the model."""
        self.model.destroy()

    def points(
        self,
        known: Container[int] = (),
        share: tuple[int, int] = (0, 1),
        *,
        linear_model: bool = False,
    ) -> Iterator[TurnPoint]:
        """States at all angles but those whose indices, from 0 on, are `known`.

        share : number of a share of the states, from 0, which is computed, and how many there are
        linear_model : where a linear model is made, take most states from it

        Raises ConvergenceError where a state cannot be reached.
        """
        if not self.ideals:
            self.ideals = self._ideal_states()
            self._displace_cam()
        for place, (state, ideal) in enumerate(self.ideals):
            ideal.copy(self.model.problem.x)
            self.model.problem.search(state)  # all states of the place are near this one
            states: dict[tuple[int, ...], list[int]] = {}
            different = set()
            for index in range(place, self.angles, self.per_period):
                renamed = tuple(self._renamed(index) % period for period in self.periods)
                different.add(renamed)
                if index not in known:
                    states.setdefault(renamed, []).append(index)
            checked = checked_share(len(different)) if linear_model else 1.0
            start = split(len(states), share[1])
            mine = list(states.values())[start[share[0]] : start[share[0] + 1]]
            worth = mine and len(different) >= WORTH_GUESSES
            guess = self._guess(state) if worth else None
            last = ideal
            try:
                for first, *others in mine:
                    check = (first // self.per_period) * GOLDEN % 1.0 < checked
                    found = self._point(first, state, ideal, guess or last, check=check)
                    last = self.model.problem.x.copy()
                    yield found
                    for index in others:
                        yield self._repeated(found, index)
            finally:
                if guess is not None:
                    guess.destroy()

    def _guess(self, state: LoadState) -> DeviationGuess | None:
        """What guesses the states around the ideal one, near which x is; None in a cup drive, in
        which the faces on the cam are many, and with a bearing."""
        problem = self.model.problem
        if (
            self.model.comm.size > 1
            or self.design.drive.model != "plane"
            or problem.wave_generator.cam is None
            or not self.model.solver.system.solver.is_factor
        ):
            return None
        none = self.tables.scaled(0.0)
        problem.flanks_of(RING_GEAR).deviate(none)
        # the cam may have been displaced
        if not self.model.solver.solve(state, search=False).converged:
            return None
        return DeviationGuess(self.model, state, none)

    def _renamed(self, index: int) -> int:
        """By how many pitches the teeth are renamed at the angle of an index."""
        return index // self.per_period * self.design.kinematics.pitches

    def _ideal_states(self) -> list[tuple[LoadState, PETSc.Vec]]:
        """Load state and x of the ideal drive at the angles of a period."""
        x = self.model.problem.x
        found = [(self.loaded, x.copy())]
        for place in range(1, self.per_period):
            angle = self.design.kinematics.period_angle * place / self.per_period
            step = Stage.ROTATE + place - 1
            state = replace(self.loaded, stage=Stage.ROTATE, step=step, angle=angle)
            self.stepper.advance(state)
            found.append((state, x.copy()))
        return found

    def _displace_cam(self) -> None:
        """Move the cam off the axis on which it rotates."""
        if self.design.bearing is not None:
            return
        part = self.deviations.wave_generator
        shift, lean = tuple(part.shift), tuple(part.lean)

        def pose(state: LoadState) -> SurfacePose | None:
            ideal = cam_pose(state)
            return ideal and replace(ideal, shift=shift, lean=lean)

        self.model.problem.wave_generator.cam.pose = pose

    def _displace_bore(self, renamed: int, state: LoadState, share: float) -> None:
        """Hold the bore off the axis, in the direction that its material has where teeth are
        renamed."""
        part = self.deviations.cup
        offsets = self.model.problem.supports.offsets
        turn = -2.0 * np.pi * renamed / self.design.drive.teeth_fs
        if self.design.kinematics.output_gear == "flexible_spline":
            turn += state.angle / self.design.kinematics.ratio
        lean = share * rotated(part.lean, turn)
        offsets[SPLINE_COUPLING, [X, Y]] = share * rotated(part.shift, turn) + self.bore_z * lean
        offsets[SPLINE_COUPLING, [TILT_X, TILT_Y]] = -lean[1], lean[0]

    def _point(
        self,
        index: int,
        state: LoadState,
        ideal: PETSc.Vec,
        guess: PETSc.Vec | DeviationGuess,
        *,
        check: bool,
    ) -> TurnPoint:
        """The state at an angle, from a guess, or from the ideal one step by step.

        state, ideal : of the ideal drive at the same place of a period
        check : whether a guess that is settled is not yet the state
        """
        problem, iterations, renamed = self.model.problem, 0, self._renamed(index)
        deviations, turned = (
            self.tables.rolled(renamed),
            renamed * self.design.kinematics.pitch_angle,
        )
        angle, turned_output = state.angle + turned, turned / self.design.kinematics.ratio
        modelled: ModelledState | None = None
        for start, steps in ((guess, 1), *((ideal, steps) for steps in STEPS)):
            if isinstance(start, PETSc.Vec):
                start.copy(problem.x)
            for share in np.arange(1, steps + 1) / steps:
                self._displace_bore(renamed, state, share)
                problem.flanks_of(RING_GEAR).deviate(deviations.scaled(share))
                if isinstance(start, DeviationGuess):
                    found = start.set_x()
                    modelled = found if found.settled else None
                    if modelled is not None and not check:
                        output = modelled.output_rotation + turned_output
                        return TurnPoint(
                            index, angle, output, modelled.torque, 0, by_linear_model=True
                        )
                result = self.model.solver.solve(state, search=False)
                iterations += result.iterations
                if not result.converged:
                    break
            else:
                rotation, torque = problem.output_rotation(), torques(problem, state).wave_generator
                difference = None
                if modelled is not None:
                    difference = modelled.output_rotation - rotation, modelled.torque - torque
                output = rotation + turned_output
                return TurnPoint(index, angle, output, torque, iterations, difference=difference)
        raise ConvergenceError(
            f"the drive with [deviations] did not converge at a wave-generator angle of "
            f"{np.degrees(angle):.4g} degrees: {result.reason}, residual {result.residual:.1e} of "
            "the contact force"
        )

    def _repeated(self, point: TurnPoint, index: int) -> TurnPoint:
        """The state of a point again, at the angle of another index."""
        pitches = self._renamed(index) - self._renamed(point.index)
        turned = pitches * self.design.kinematics.pitch_angle
        output = point.output_angle + turned / self.design.kinematics.ratio
        return replace(
            point,
            index=index,
            wg_angle=point.wg_angle + turned,
            output_angle=output,
            iterations=0,
            difference=None,
        )

"""A sampled period on a coarser mesh, which shows the error of its ranges by the mesh."""

from __future__ import annotations

from swgpar.analysis.drive_mesh_error import shown_error
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.predictor import KnownState
from swgpar.analysis.transfer import Interpolations, interpolations, transfer
from swgpar.errors import ConvergenceError
from swgpar.evaluation.period_ranges import INPUT_TORQUE, CoarsePeriod, period_curves
from swgpar.log import logger
from swgpar.model.drive_model import DriveModel


def coarse_period(model: DriveModel, run: LoadStepper) -> CoarsePeriod | None:
    """Take the loaded model on a coarser mesh through the period that a run samples, and back to
    its loaded state; collective. Its states guide the run.

    run : takes the run through its states

    None without a sampled period or a torque; in a cup drive, where it would cost a third of the
    run; with friction, whose first period settles; and where an angle does not converge in one
    step: teeth that jam would take longer here than in the run.
    """
    stepper = LoadStepper(model)
    sequence = stepper.sequence
    if model.recipe.model != "plane" or not (sequence.samples and sequence.torque):
        return None
    if sequence.periods > 1 or sequence.kinematics.wave_generator_is_fixed:
        return None
    stepper.resume_at(sequence.loaded)
    loaded = model.problem.x.copy()
    matrices = interpolations(model, run.model)
    rows, guides = [stepper.row()], [_on_mesh_of(run, stepper, matrices)]
    try:
        for state in sequence.from_loaded[1:]:
            stepper.advance(state, cut_back=False)
            rows.append(stepper.row())
            guides.append(_on_mesh_of(run, stepper, matrices))
    except ConvergenceError as error:
        logger.info("the errors over the period by the mesh are not known: %s", error)
        return None
    finally:
        loaded.copy(model.problem.x)
    run.guides = guides
    factor = shown_error(model.recipe, run.model.recipe, 1.0)
    return CoarsePeriod(period_curves(sequence.kinematics, rows, INPUT_TORQUE), factor)


def _on_mesh_of(run: LoadStepper, stepper: LoadStepper, matrices: Interpolations) -> KnownState:
    """The present state of `stepper` on the mesh of the run."""
    x = run.problem.x.duplicate()
    x.set(0.0)
    transfer(stepper.model, stepper.problem.x, run.model, x, matrices)
    return KnownState(stepper.load_state.angle, x)

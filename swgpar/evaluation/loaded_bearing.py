"""What the bearing of a drive gives in one state."""

from __future__ import annotations

from swgpar.evaluation.bearing_loads import BallLoads, ball_rows, evaluate_bearing
from swgpar.evaluation.compliance import bearing_shares
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel


def loaded_bearing(model: DriveModel, state: LoadState) -> BallLoads | None:
    """What the bearing of the loaded model gives; None without one. Collective."""
    if model.design.bearing is None:
        return None
    stresses, _ = model.stresses()
    race = {name: value for name, value in stresses.items() if name.startswith("race_")}
    rows = ball_rows(model, state, 1, state.step)
    return evaluate_bearing(model.design, rows, [1], bearing_shares(model, state), race)

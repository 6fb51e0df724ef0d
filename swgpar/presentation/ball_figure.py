"""The figure of a bearing's balls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from swgpar.load.load_states import Stage
from swgpar.results.figure_set import from_zero, panels, plot_line
from swgpar.results.table import Columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from swgpar.evaluation.bearing_loads import BallLoads


def draw_ball_loads(balls: Columns, bearing: BallLoads | None, title: str) -> Figure:
    """Loads of the balls (N) over the angle from the major axis, and the largest during the
    rotation.

    balls : columns of balls.csv;  title : of the axis with the angle of the wave generator
    """
    loaded = balls["step"] >= Stage.LOAD
    if loaded.any():
        balls = {name: values[loaded] for name, values in balls.items()}
    figure, (upper, lower) = panels(2, 7.0, 6.5)
    increments, first = np.unique(balls["increment"], return_index=True)
    for increment in increments:
        here = np.flatnonzero(balls["increment"] == increment)
        here = here[np.argsort(balls["cam_angle_deg"][here])]
        angle, load = balls["cam_angle_deg"][here], balls["load_N"][here]
        plot_line(upper, angle, load, "o-", ms=3, lw=0.6)
    upper.set(xlabel="angle from the major axis (degrees)", ylabel="ball load (N)")
    upper.set_xlim(-180.0, 180.0)
    count = len(balls["ball"]) // len(increments)
    upper.set_title(f"loads of {count} balls at {len(increments)} angles")
    peaks = balls["load_N"].reshape(len(increments), -1).max(axis=1)
    plot_line(lower, balls["wg_angle_deg"][first], peaks, "o-", ms=4)
    lower.set(xlabel=title, ylabel="largest ball load (N)")
    if bearing and bearing.balls_fixed_to_cam:
        lower.set_title("balls fixed to the cam: ball passing is left out", fontsize=10)
    for axes in (upper, lower):
        from_zero(axes)
    return figure

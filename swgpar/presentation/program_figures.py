"""Figures of load programs: torque against rotation of the output."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from swgpar.drive_results.summary import DriveSummary
from swgpar.evaluation.stiffness import TorsionalStiffness
from swgpar.presentation.answer_text import value_text
from swgpar.results.figure_set import line_through, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def torque_against_rotation(program: Mapping[str, np.ndarray], summary: DriveSummary) -> Figure:
    """Torque on the output (N·m) against its rotation (arc minutes), a line for every stage, or
    every position.

    program : columns of program.csv;  summary : of the run
    """
    figure, (axes,) = panels(1, 7.0, 5.0)
    groups = program["wg_angle_deg"] if summary.stiffness else program["stage"]
    for value in dict.fromkeys(groups):
        here = groups == value
        first = max(0, int(np.flatnonzero(here)[0]) - 1)
        if not summary.stiffness:  # a stage begins where the one before has ended
            here[first] = True
        label = f"wave generator at {value:.3g}°" if summary.stiffness else str(value)
        rotation, torque = program["rotation_arcmin"][here], program["torque_Nm"][here]
        if summary.ratcheting and here[0]:  # before the first point the output carries nothing
            rotation, torque = np.append(0.0, rotation), np.append(0.0, torque)
        style = line_through(len(torque) if summary.stiffness else len(groups))
        axes.plot(rotation, torque, "o", ls=style, ms=3, lw=1.0, label=label)
    if summary.stiffness:
        _mark_chords(axes, summary.stiffness)
    if ratcheting := summary.ratcheting:
        peak = 60.0 * ratcheting.peak_rotation_deg, ratcheting.peak_torque_Nm
        axes.plot(*peak, "k*", ms=12, label="largest torque")
        if (yields := ratcheting.yield_torque_Nm) is not None:
            axes.axhline(yields, color="0.4", ls=":", lw=0.8, label="gears begin to yield")
    axes.set_xlabel("rotation of the output by the torque (arc minutes)")
    axes.set_ylabel("torque on the output (N·m)")
    what = "ratcheting: torque" if summary.ratcheting else "torque"
    locked = summary.stiffness or summary.ratcheting
    where = "wave generator locked" if locked else "along the load program"
    axes.set_title(f"{what} on the output against its rotation, {where}")
    axes.axhline(0.0, color="0.6", lw=0.6)
    axes.legend(fontsize=8)
    return figure


def _mark_chords(axes: Axes, stiffness: TorsionalStiffness) -> None:
    """Mark the torques at which the chords of K1, K2 and K3 end."""
    for share in stiffness.break_points:
        axes.axhline(share * stiffness.torque_Nm, color="0.4", ls=":", lw=0.8)
    chords = {name: value_text(getattr(stiffness, name)) for name in ("K1", "K2", "K3")}
    words = "\n".join(f"{name} = {chord} N·m/rad" for name, chord in chords.items())
    if stiffness.lost_motion is not None:
        words += f"\nlost motion {stiffness.lost_motion:.3g}′"
    if stiffness.hysteresis is not None:
        words += f", hysteresis {abs(stiffness.hysteresis):.2g}′"
    axes.text(0.02, 0.98, words, transform=axes.transAxes, va="top", fontsize=9)

"""What the keys of answers measure: stiffness, ratcheting, fatigue, losses, modes of the spline."""

from __future__ import annotations

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from _drafting import CAM, INK, NOTE, RING, SPLINE, dimension, label, leader, reference, run
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.losses_section import Losses
from swgpar.design.program_sections import Ratcheting, Stiffness
from swgpar.design.sections import Fatigue
from swgpar.evaluation.fatigue_criteria import damage, fatigue_limits, goodman
from swgpar.evaluation.ratcheting import TorquePoint, evaluate_ratcheting
from swgpar.evaluation.stiffness import at_position
from swgpar.exchange.loaded_losses import LoadedLosses, LoadLine
from swgpar.load.load_program import StiffnessProgram
from swgpar.vibration.curved_beam import BeamSection, Ring, free_frequencies

TOP, PLAY, FRICTION = 10.0, 0.5, 0.35
"""N·m; arc minutes of the drawn spring: half of its backlash, and half of what friction holds."""


def plain_axes(ax: Axes, x: str, y: str) -> None:
    """Axes through the origin, named at their ends, without a scale."""
    ax.axhline(0.0, color=INK, lw=0.6)
    ax.axvline(0.0, color=INK, lw=0.6)
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.set_xlabel(x, fontsize=9)
    ax.set_ylabel(y, fontsize=9)


def spring(torque: float, way: float) -> float:
    """Rotation (arc minutes) of a spring that becomes stiffer, with backlash, on a way up (1) or
    down (-1) of the torque."""
    slack = PLAY * np.sign(torque)
    lag = FRICTION * (1.0 - (torque / TOP) ** 2) * way
    return float(slack + np.sign(torque) * 2.6 * (abs(torque) / TOP) ** 0.7 - lag)


def stiffness_loop() -> Figure:
    """The loop that the program runs through, evaluated by it."""
    section = Stiffness(torque=TOP, points=12)
    program = StiffnessProgram(section, TOP, TOP, 0.0, (0.0,), False, False, 1.0)
    points = program.points()
    torques = np.array([point.value for point in points])
    ways = np.sign(np.diff(torques, prepend=0.0))
    turns = [spring(t, w) for t, w in zip(torques, ways, strict=True)]
    rows = [
        {
            "stage": point.stage,
            "wg_angle_deg": 0.0,
            "torque_Nm": point.value,
            "rotation_arcmin": turn,
            "wg_torque_Nmm": 0.0,
        }
        for point, turn in zip(points, turns, strict=True)
    ]
    found = at_position(program, rows)
    figure, ax = plt.subplots(figsize=(8.0, 5.6), layout="constrained")
    ax.plot(turns, torques, "o-", color=SPLINE, ms=3, lw=1.2)
    plain_axes(ax, "rotation of the output by the torque", "torque on the output")
    right = 1.45 * max(turns)
    for share, key in zip(section.break_points, ("break_points[1]", "break_points[2]")):
        ax.plot([0.0, right], [share * TOP] * 2, color=NOTE, lw=0.6, ls=":")
        label(ax, (right, share * TOP), f"{key} · torque", ha="left")
    ax.plot([0.0, right], [TOP] * 2, color=NOTE, lw=0.6, ls=":")
    label(ax, (right, TOP), "torque", ha="left")
    measured = section.lost_motion_share * TOP
    label(ax, (right, measured), "lost_motion_share · rated_torque", ha="left", va="bottom")
    ax.plot([-1.0, right], [measured] * 2, color=NOTE, lw=0.6, ls=":")
    # the middle line of all four branches, whose chords are K1, K2 and K3
    ends = np.array([0.0, *section.break_points, 1.0]) * TOP
    chords = np.array([found.K1, found.K2, found.K3])
    line = np.concatenate([[0.0], np.cumsum(np.diff(ends) / chords)]) * 10800.0 / np.pi
    line += PLAY
    ax.plot(line, ends, color=NOTE, lw=2.0)
    for k, name in enumerate(("K1", "K2", "K3")):
        middle = 0.5 * (line[k] + line[k + 1]), 0.5 * (ends[k] + ends[k + 1])
        leader(ax, (middle[0] - 1.1, middle[1] + 0.9), name, middle, fontsize=10)
    assert found.hysteresis is not None
    half = 0.5 * found.hysteresis
    dimension(ax, (-half, -0.35 * TOP), (half, -0.35 * TOP), "", at=(0.0, -0.35 * TOP))
    label(ax, (half + 0.1, -0.35 * TOP), "hysteresis: width at zero torque", ha="left")
    for x in (-half, half):
        ax.plot([x, x], [-0.38 * TOP, 0.0], color=NOTE, lw=0.5)
    label(ax, (0.4, -0.75 * TOP), "dots: points of a branch (key points)", ha="left", color=INK)
    ax.set_xlim(1.1 * min(turns), 1.5 * right)
    return figure


def ratcheting() -> Figure:
    """A torque that rises until teeth jump over, evaluated by the program."""
    section, kinematics = Ratcheting(increment=0.05), reference("plane_half_turn").kinematics
    pitch, over = kinematics.output_pitch, 0.62
    at = np.sort([*np.arange(0.05, 0.81, section.increment), over - 0.01, over - 0.003, over])
    torques = np.where(at < over, np.sin(2.1 * at), 0.35 + 0.25 * (at - over))
    points = [
        TorquePoint(1, float(x * pitch), float(t), float(x * pitch if x >= over else 0.0))
        for x, t in zip(at, torques, strict=True)
    ]
    found = evaluate_ratcheting(kinematics, section, points, 0.0, ended_early=False)
    peak = found.peak_rotation_pitches, found.peak_torque_Nm
    figure, ax = plt.subplots(figsize=(8.0, 4.8), layout="constrained")
    ended = at <= over
    ax.plot([0.0, *at[ended]], [0.0, *torques[ended]], color=SPLINE, lw=1.4)
    recorded = np.arange(section.increment, over, section.increment)
    ax.plot(recorded, np.sin(2.1 * recorded), "o", color=SPLINE, ms=4)
    ax.plot(*peak, "*", color=NOTE, ms=12)
    leader(ax, (peak[0] - 0.2, 1.08), "largest torque, known to tolerance", peak)
    plain_axes(ax, "rotation of the output, pitches", "torque on the output")
    for x in recorded[2:4]:
        ax.plot([x, x], [0.0, np.sin(2.1 * x)], color=NOTE, lw=0.6)
    dimension(ax, (recorded[2], 0.08), (recorded[3], 0.08), "increment", at=(0.28, 0.08))
    low = (1.0 - section.drop) * peak[1]
    for y in (low, peak[1]):
        ax.plot([peak[0], 0.8], [y, y], color=NOTE, lw=0.6)
    dimension(ax, (0.76, low), (0.76, peak[1]), "drop: the run ends below", at=(0.95, low))
    leader(ax, (0.8, 0.45), found.gave_way, (over, torques[ended][-1]), color=INK)
    ax.axvline(1.2, ymax=0.5, color=NOTE, lw=0.8, ls=":")
    label(ax, (1.2, 0.62), "limit: the run ends\nat the latest")
    label(ax, (0.1, 1.0), "at one angle wave_generator", color=INK, ha="left")
    ax.set_xlim(-0.02, 1.35)
    ax.set_ylim(-0.03, 1.16)
    return figure


def haigh() -> Figure:
    """Haigh's diagram and life by the keys of [fatigue]."""
    keys = Fatigue()
    limit, _ = fatigue_limits(keys)
    figure, (ax, life) = plt.subplots(1, 2, figsize=(11.0, 4.6), layout="constrained")
    mean = np.linspace(-keys.yield_strength, keys.tensile_strength, 400)
    # amplitudes at which the utilisation by Goodman's line is 1
    left = 1.0 - goodman(np.zeros_like(mean), mean, keys)
    ax.plot(mean, limit * left, color=SPLINE, lw=2.0)
    yields = keys.yield_strength - np.abs(mean)
    ax.plot(mean[yields > 0], yields[yields > 0], color=INK, lw=1.0, ls="--")
    plain_axes(ax, "mean of the normal stress", "amplitude")
    ax.set_ylim(0.0, 1.12 * keys.yield_strength)
    leader(ax, (420.0, 900.0), "yield_strength", (180.0, keys.yield_strength - 180.0))
    strength = keys.tensile_strength
    leader(ax, (0.86 * strength, 250.0), "tensile_strength", (strength, 0.0))
    text = "fatigue_limit · surface_factor · size_factor"
    label(ax, (-560.0, limit + 30.0), text)
    place = np.array([180.0, 210.0])
    safety = 1.0 / float(goodman(place[1:], place[:1], keys)[0])
    ax.plot([0.0, safety * place[0]], [0.0, safety * place[1]], color=NOTE, lw=0.8, ls=":")
    ax.plot(*place, "o", color=NOTE)
    ax.plot(*(safety * place), "s", color=NOTE, ms=4)
    label(ax, (250.0, 160.0), f"a cycle: safety {safety:.2g}", ha="left")
    ax.set_title("safety", fontsize=10)
    _life(life, keys, limit)
    return figure


def _life(ax: Axes, keys: Fatigue, limit: float) -> None:
    """Amplitude over the number of cycles, by the damage of one cycle without a mean."""
    amplitude = np.geomspace(1.0001 * limit, 1000.0, 60)
    one = np.array([damage(np.array([a, -a]), keys) for a in amplitude])
    ax.loglog(1.0 / one, amplitude, color=SPLINE, lw=2.0)
    ax.plot([1.0 / one[0], 30.0 / one[0]], [limit, limit], color=SPLINE, lw=2.0)
    ax.set_xlabel("cycles to failure", fontsize=9)
    ax.set_ylabel("amplitude at zero mean (MPa)", fontsize=9)
    ax.set_yticks([500, 700, 1000], ["500", "700", "1000"])
    ax.minorticks_off()
    middle = len(amplitude) // 2
    words = "basquin_coefficient: height\nbasquin_exponent: slope"
    leader(
        ax,
        (3.0 / one[middle], 1.25 * amplitude[middle]),
        words,
        (1.0 / one[middle], amplitude[middle]),
    )
    label(ax, (5.0 / one[0], 1.04 * limit), "no damage below", va="bottom")
    ax.set_title("life", fontsize=10)


def losses() -> Figure:
    """Loss torque at the input over load and speed, of the tables that exports have."""
    ratio, speed, rated = -60.0, 200.0, 20.0
    drag = Losses(input_drag=0.012, input_viscous_drag=6e-5, output_drag=0.4)
    drag = drag.model_copy(update={"output_viscous_drag": 0.15})
    friction, hysteresis = LoadLine(0.006, 0.0016), LoadLine(0.004, 0.0)
    found = LoadedLosses(friction, hysteresis, drag, ratio, rated, speed)
    flanks = replace(found, section=Losses())
    figure, (over_load, over_speed) = plt.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    torque = np.linspace(0.0, 1.5 * rated, 30)
    parts = [
        (np.full_like(torque, flanks.at_input(0.0, 0.0)), "loss_factor, and friction without load"),
        (friction.by_load * torque, "flank_friction, bearing_friction"),
        (np.full_like(torque, drag.input_drag), "input_drag"),
        (np.full_like(torque, drag.output_drag / abs(ratio)), "output_drag / ratio"),
    ]
    colours = (CAM, SPLINE, RING, "#cfcfcf")
    over_load.stackplot(torque, *(part for part, _ in parts), colors=colours)
    _names_of_parts(over_load, torque, parts)
    over_load.set_title("over the output torque, at rest", fontsize=10)
    rate = np.linspace(0.0, 1.5 * speed, 30)
    still = np.full_like(rate, found.at_input(rated, 0.0))
    at_output = drag.output_viscous_drag / ratio**2 * rate
    viscous = [
        (still, "what the left picture has at this torque"),
        (drag.input_viscous_drag * rate, "input_viscous_drag · speed"),
        (at_output, "output_viscous_drag · speed / ratio²"),
    ]
    total = sum(part for part, _ in viscous)
    if not np.allclose(total, [found.at_input(rated, one) for one in rate]):
        raise ArithmeticError("the parts are not those of the tables")
    over_speed.stackplot(rate, *(part for part, _ in viscous), colors=("#e8e0d0", SPLINE, RING))
    _names_of_parts(over_speed, rate, viscous)
    over_speed.set_title("over the input speed, under one torque", fontsize=10)
    for ax in (over_load, over_speed):
        ax.set_xticks([])
        ax.set_yticks([])
        ax.set_ylabel("loss torque at the input", fontsize=9)
    return figure


def _names_of_parts(ax: Axes, x: np.ndarray, parts: list[tuple[np.ndarray, str]]) -> None:
    """Texts in the middle of stacked areas, at three quarters of the width."""
    at, below = len(x) * 5 // 8, 0.0
    for part, words in parts:
        label(ax, (float(x[at]), below + 0.5 * float(part[at])), words, color=INK)
        below += float(part[at])
    ax.set_xlim(x[0], x[-1])


def modes() -> Figure:
    """The lowest modes of the rim of the reference drive, free: waves around it."""
    design = reference("plane_half_turn")
    spline, material = design.flexible_spline, design.materials["flexible_spline"]
    radius = 1e-3 * (design.inner_radius + 0.5 * spline.rim)
    sizes = 1e-3 * spline.rim, 1e-3 * design.drive.face_width
    section = BeamSection.rectangle(
        1e6 * material.modulus, material.poisson, 7850.0, radius, *sizes
    )
    ring = Ring(section, 120)
    rate, shapes = ring.modes()
    figure, axes = plt.subplots(1, 3, figsize=(10.0, 3.8), layout="constrained")
    figure.suptitle("rim of the reference drive, free; a run has the loaded drive", fontsize=10)
    angle = 2.0 * np.pi * np.arange(120) / 120
    for ax, waves in zip(axes, (2, 3, 4), strict=True):
        expected = free_frequencies(section, waves)[0]
        shape = shapes[:, int(np.abs(rate - expected).argmin())].reshape(-1, 3)
        moved = 1.0 + 0.22 * (shape[:, 0] + 1j * shape[:, 1]) / np.abs(shape[:, 0]).max()
        closed = np.append(moved * np.exp(1j * angle), moved[0])
        ax.plot(np.cos(angle), np.sin(angle), color=INK, lw=0.7, ls="--")
        ax.plot(closed.real, closed.imag, color=SPLINE, lw=2.0)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title(f"{waves} waves, {expected / (2.0 * np.pi):.0f} Hz", fontsize=10)
    return figure


if __name__ == "__main__":
    run(
        {
            "stiffness_loop": stiffness_loop,
            "ratcheting": ratcheting,
            "haigh": haigh,
            "losses": losses,
            "modes": modes,
        }
    )

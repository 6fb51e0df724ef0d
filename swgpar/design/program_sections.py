"""The sections of load programs: stages of a path of loads, and programs that are generated from
few keys."""

from __future__ import annotations

from swgpar.input.quantities import Section, not_negative, positive, quantity


class ProgramStage(Section):
    """One table [[load.program]]: where output and wave generator are taken from where the stage
    before left them."""

    name: str = quantity(text="name of the stage in the results")
    torque: float | None = quantity(
        None,
        unit="N·m",
        text="output torque at the end of the stage, positive against the output's motion",
    )
    output_rotation: float | None = quantity(
        None,
        unit="deg",
        text="instead: prescribed angle of the output, as in the history",
        gt=-180.0,
        lt=180.0,
    )
    wave_generator: float | None = quantity(
        None, unit="deg", text="angle of the wave generator at the end", ge=-36000.0, le=36000.0
    )
    points: int = quantity(
        1, text="points that are recorded, evenly spaced up to the end", ge=1, le=10000
    )


class Stiffness(Section):
    """Section [stiffness]: torque against rotation of the output with the wave generator locked."""

    torque: float | None = positive(
        "largest torque, in both directions; default load.torque", "N·m", None
    )
    rated_torque: float | None = positive(
        "torque that lost_motion_share refers to; default stiffness.torque", "N·m", None
    )
    break_points: list[float] = quantity(
        [0.2, 0.65],
        text="two shares of the largest torque, ascending: K1 ends at the first, K2 at the second",
    )
    lost_motion_share: float = positive(
        "share of the rated torque at which the lost motion is measured", default=0.04, lt=1.0
    )
    points: int = quantity(
        2,
        text="evenly spaced torques up to the largest one, beside those that the results need",
        ge=1,
        le=200,
    )
    positions: int = quantity(
        3, text="angles of the wave generator in one period, evenly spaced", ge=1, le=360
    )
    loop: bool = quantity(
        True,
        text="compute the whole loop at every position; false: one way of it, which suffices "
        "without friction",
    )
    mesh_error: bool = quantity(
        True, text="repeat the first position on a coarser mesh for the error by the mesh"
    )


class Ratcheting(Section):
    """Section [ratcheting]: the output is rotated with the wave generator locked until its torque
    falls."""

    wave_generator: float = not_negative("angle of the wave generator", "deg", 0.0, lt=360.0)
    increment: float = quantity(
        0.02,
        unit="pitches",
        text="rotation of the output between two records, in pitches of the output; the steps "
        "between follow the torque",
        ge=1e-4,
        le=0.5,
    )
    start_torque: float | None = positive(
        "torque of the output from which on it is rotated; default: none, from the assembled drive",
        "N·m",
        None,
    )
    limit: float = positive(
        "rotation of the output at which the run ends at the latest", "pitches", 1.5, le=20.0
    )
    drop: float = positive(
        "share of its peak by which the torque has to fall for the run to end", default=0.1, lt=1.0
    )
    tolerance: float = quantity(
        0.01,
        text="share of the peak torque by which it may be missed between two states",
        ge=1e-4,
        le=0.1,
    )
    sufficient_torque: float | None = positive(
        "torque of the output at which the run ends without a peak; default: none", "N·m", None
    )
    yield_strength: float | None = positive(
        "yield strength of both gears, for the torque at which they begin to yield; default: none",
        "MPa",
        None,
    )

"""The spring model as an FMU: checked, built and simulated by FMPy."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stepping import small
from swgpar.errors import InputError, OutputError
from swgpar.evaluation.losses import LossParts, bearing_drag
from swgpar.evaluation.stiffness import torsional_stiffness
from swgpar.exchange.fmu import VARIABLES, write_fmu
from swgpar.exchange.loaded_losses import LoadedLosses
from swgpar.exchange.tables import ripple_table, spring_table
from swgpar.load.load_sequence import program_points, stiffness_program

fmpy = pytest.importorskip("fmpy")
pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")

RATIO, PITCH = -20.0, 360.0 / 42.0
"""Of the small drive; deg."""

ARCMIN = np.pi / 10800.0
TOP = 40.0
"""N·m"""

GIVEN = [one.name for one in VARIABLES if one.causality == "input"]


class StiffnessRun:
    """A run with [stiffness]: a loop at two positions that softens, its branches apart between its
    ends.

    backlash, width : arc minutes
    """

    transmission_error: dict[str, np.ndarray] = {}

    def __init__(
        self, layout: str = "ring_fixed", backlash: float = 0.0, width: float = 0.5
    ) -> None:
        values = {"stiffness.torque": TOP, "stiffness.positions": 2, "stiffness.points": 20}
        self.design = small("plane", "contact.friction=0.1", f"drive.layout={layout}").with_values(
            values
        )
        points = program_points(self.design)
        torque = np.array([point.value for point in points])
        stage = np.array([point.stage for point in points])
        unloading = np.where(np.char.find(stage, "unloading") >= 0, 1.0, -1.0) * np.sign(torque)
        lag = unloading * 0.5 * width * (1.0 - np.abs(torque) / TOP)
        rotation = windup(torque) / ARCMIN + np.sign(torque) * 0.5 * backlash + lag
        angle = np.array([point.angle for point in points])
        self.program = {
            "stage": stage,
            "wg_angle_deg": angle,
            "torque_Nm": torque,
            "rotation_arcmin": rotation,
            "wg_torque_Nmm": np.zeros_like(rotation),
        }
        rows = [dict(zip(self.program, values)) for values in zip(*self.program.values())]
        stiffness = torsional_stiffness(stiffness_program(self.design), rows, None)
        self.summary = SimpleNamespace(
            ratio=self.design.kinematics.ratio, design=self.design, stiffness=stiffness
        )


def windup(torque: np.ndarray) -> np.ndarray:
    """Mean branch, rad."""
    return (0.2 * torque - 2e-5 * torque**3) * ARCMIN


class SampledRun:
    """A sampled period with losses of 50 N·mm; with DRAG 5 of them are by seals, with a viscosity a
    part is by the lubricant."""

    program: dict[str, np.ndarray] = {}

    def __init__(
        self,
        samples: int = 12,
        ratio: float = RATIO,
        torque: float = 0.2,
        loss: float = 50.0,
        drag: tuple[str, ...] = (),
    ) -> None:
        angle = PITCH * np.arange(samples) / samples + 2.0 * PITCH
        phase = 2.0 * np.pi * angle / PITCH
        self.transmission_error = {
            "wg_angle_deg": angle,
            "transmission_error_arcsec": 20.0 + 4.0 * np.cos(phase) + 1.5 * np.sin(2.0 * phase),
        }
        design = small("plane", f"load.torque={torque}", "losses.loss_factor=3e-4", *drag)
        lubricant = bearing_drag(design).torque(design.load.input_rate)
        seals = 5.0 if drag == DRAG else 0.0
        friction = loss - 5.0 - lubricant - seals
        parts = LossParts(
            flank_friction=0.5 * friction,
            hysteresis=5.0,
            bearing=0.5 * friction,
            lubricant=lubricant,
            seals=seals,
        )
        self.summary = SimpleNamespace(
            ratio=ratio,
            stiffness=None,
            design=design,
            losses=SimpleNamespace(loss_torque_Nmm=loss, parts_Nmm=parts),
        )


class Unit:
    """An instance of an FMU, as a co-simulation unit."""

    def __init__(self, path: Path, folder: Path) -> None:
        description = fmpy.read_model_description(str(path))
        self.references = {one.name: one.valueReference for one in description.modelVariables}
        self.unit = fmpy.instantiate_fmu(
            fmpy.extract(str(path), str(folder)), description, fmi_type="CoSimulation"
        )
        self.unit.setupExperiment(startTime=0.0)
        self.unit.enterInitializationMode()
        self.unit.exitInitializationMode()

    def set(self, **values: float) -> None:
        self.unit.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, *names: str) -> list[float]:
        return self.unit.getReal([self.references[name] for name in names])


@contextmanager
def instance(path: Path, folder: Path) -> Iterator[Unit]:
    unit = Unit(path, folder)
    yield unit
    unit.unit.terminate()
    unit.unit.freeInstance()


def build_binary(path: Path) -> None:
    """Add the binary of this system to an FMU, by FMPy."""
    try:
        from fmpy.build import build_platform_binary
    except ImportError:  # FMPy for NumPy 1
        from fmpy.util import compile_platform_binary

        compile_platform_binary(str(path))
        return
    folder = path.with_suffix("")
    fmpy.extract(str(path), unzipdir=str(folder))
    build_platform_binary(folder)
    Path(shutil.make_archive(str(folder), "zip", folder)).replace(path)


@pytest.fixture
def fmu(tmp_path: Path) -> Path:
    (path,) = write_fmu(StiffnessRun(), tmp_path, SampledRun())
    return path


def rigid_output(angle: float | np.ndarray, error: float | np.ndarray = 0.0) -> Any:
    """Angle of the output without wind-up."""
    return angle / RATIO + error


def test_fmpy_finds_nothing_wrong(fmu: Path) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation is not None and description.modelExchange is not None
    assert [one.name for one in description.modelVariables] == [one.name for one in VARIABLES]


def test_the_same_results_give_the_same_file(fmu: Path, tmp_path: Path) -> None:
    (tmp_path / "again").mkdir()
    (again,) = write_fmu(StiffnessRun(), tmp_path / "again", SampledRun())
    assert again.read_bytes() == fmu.read_bytes()


@pytest.mark.parametrize(
    "layout, backlash", [("ring_fixed", 0.0), ("ring_fixed", 24.0), ("spline_fixed", 0.0)]
)
def test_windup_under_a_torque_is_that_of_the_table(
    tmp_path: Path, layout: str, backlash: float
) -> None:
    """Torques of the table act against the output's motion, those of the FMU about z."""
    run = StiffnessRun(layout, backlash)
    (path,) = write_fmu(run, tmp_path)
    table, sense = spring_table(run), -np.sign(run.design.kinematics.ratio)
    expected = windup(table["torque_Nm"]) + 0.5 * backlash * ARCMIN * np.sign(table["torque_Nm"])
    assert table["windup_rad"] == pytest.approx(expected, abs=1e-15)
    with instance(path, tmp_path / "unit") as unit:
        unit.set(friction_torque=0.0)
        for torque, expected in zip(table["torque_Nm"], table["windup_rad"], strict=True):

            def left(angle: float, torque: float = torque) -> float:
                unit.set(output_angle=angle)
                return unit.get("output_torque")[0] + sense * torque

            assert sense * brentq(left, -0.01, 0.01, xtol=1e-14) == pytest.approx(
                expected, abs=1e-9
            )


def test_the_kinematic_error_is_that_of_the_table(fmu: Path, tmp_path: Path) -> None:
    table = ripple_table(SampledRun().transmission_error)
    with instance(fmu, tmp_path / "unit") as unit:
        for turn in (-37.0, 0.0, 1000.0):
            for angle, error in zip(*table.values(), strict=True):
                angle += turn * np.radians(PITCH)
                unit.set(wave_generator_angle=angle, output_angle=rigid_output(angle, error))
                found, windup = unit.get("kinematic_error", "windup")
                assert found == pytest.approx(error, abs=1e-12)
                assert windup == pytest.approx(0.0, abs=1e-12)


def path_of(
    fmu: Path, wave: np.ndarray, output: np.ndarray, kind: str, **parameters: float
) -> np.ndarray:
    """Outputs along a motion over 1 s: angles at even times, speeds by the periodic rule of
    `np.gradient`."""
    time = np.linspace(0.0, 1.0, len(wave))
    columns = [time, wave, np.gradient(wave, time), output, np.gradient(output, time)]
    signals = np.rec.fromarrays(columns, names=["time", *GIVEN])
    return fmpy.simulate_fmu(
        str(fmu),
        fmi_type=kind,
        stop_time=1.0,
        output_interval=time[1],
        step_size=time[1],
        input=signals,
        start_values=parameters,
        output=["wave_generator_torque", "output_torque", "wave_generator_angle", "output_angle"],
    )


def work(found: np.ndarray) -> float:
    """Work (N·m) that goes into the drive in a cycle, by the trapezoidal rule; co-simulation ends a
    step before."""
    found = np.append(found, found[:1])
    ends = ("wave_generator", "output")
    torques, angles = ([found[f"{end}_{kind}"] for end in ends] for kind in ("torque", "angle"))
    return -float(sum(np.sum(0.5 * (m[1:] + m[:-1]) * np.diff(x)) for m, x in zip(torques, angles)))


CYCLE = 2.0 * np.pi * np.linspace(0.0, 1.0, 20001)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_cycle_without_friction_takes_no_work(fmu: Path, kind: str) -> None:
    """Wave generator and output go to and fro, out of phase, over several pitches and both signs of
    the torque."""
    wave = 0.3 * np.sin(CYCLE)
    output = rigid_output(wave) + 1.5e-3 * np.cos(CYCLE)
    found = path_of(fmu, wave, output, kind, friction_torque=0.0, loss_torque=0.0)
    size = np.sum(np.abs(found["output_torque"][1:] * np.diff(found["output_angle"])))
    assert size > 0.1 and abs(work(found)) < 1e-6 * size


def test_a_cycle_with_friction_takes_the_area_of_the_loop(fmu: Path) -> None:
    """From one end of the loop to the other and back, with the wave generator at rest."""
    windup = spring_table(StiffnessRun())["windup_rad"]
    middle, half = 0.5 * (windup[0] + windup[-1]), 0.5 * np.ptp(windup)
    output = middle + half * np.cos(CYCLE)
    wave = np.zeros(len(CYCLE))
    found = path_of(fmu, wave, output, "CoSimulation", friction_speed=1e-6)
    assert StiffnessRun().summary.stiffness.loop_work > 0.0
    assert 1000.0 * work(found) == pytest.approx(
        StiffnessRun().summary.stiffness.loop_work, rel=1e-5
    )


def test_the_input_torque_averages_to_the_output_torque_over_the_ratio(
    fmu: Path, tmp_path: Path
) -> None:
    """Without friction, over one pitch, at a constant torque on the output."""
    torque, found = 25.0, []
    with instance(fmu, tmp_path / "unit") as unit:
        unit.set(friction_torque=0.0, loss_torque=0.0)
        for angle in np.radians(PITCH) * np.arange(240) / 240:
            unit.set(wave_generator_angle=angle)

            def left(output: float) -> float:
                unit.set(output_angle=output)
                return unit.get("output_torque")[0] + torque

            brentq(left, -0.02, 0.02, xtol=1e-15)
            found.append(unit.get("wave_generator_torque")[0])
    assert np.mean(found) == pytest.approx(torque / RATIO, rel=1e-8)
    assert np.ptp(found) > 0.04 * abs(torque / RATIO)  # the ripple is there


def test_losses_and_damping_act_against_the_motion(fmu: Path, tmp_path: Path) -> None:
    with instance(fmu, tmp_path / "unit") as unit:
        (error,) = unit.get("kinematic_error")
        unit.set(damping=0.0, friction_torque=0.0, output_angle=error)
        for speed in (500.0, -500.0):
            unit.set(wave_generator_speed=speed, output_speed=0.0)
            before = unit.get("wave_generator_torque", "output_torque")
            unit.set(loss_torque=0.0)
            after = unit.get("wave_generator_torque", "output_torque")
            assert (
                before[0] - after[0] == pytest.approx(-0.05 * np.sign(speed), rel=1e-9)
                and before[1] == after[1]
            )
            unit.set(loss_torque=0.05)
        unit.set(wave_generator_speed=0.0, output_speed=2.0, damping=3.0)
        assert unit.get("output_torque")[0] == pytest.approx(-6.0, abs=1e-6)


DRAG = (
    "losses.input_drag=0.002",
    "losses.input_viscous_drag=1e-5",
    "losses.output_drag=0.02",
    "losses.output_viscous_drag=0.5",
)


def test_losses_grow_with_the_load_and_the_speed(tmp_path: Path) -> None:
    """Under 0.2 N·m 45 N·mm without the seals, without a load 25: 0.1 N·m by N·m."""
    loaded, idle = SampledRun(drag=DRAG), SampledRun(torque=0.0, loss=30.0, drag=DRAG)
    (path,) = write_fmu(StiffnessRun(), tmp_path, loaded, idle)
    with instance(path, tmp_path / "unit") as unit:
        names = ("loss_torque", "load_loss", "viscous_loss", "output_drag", "output_viscous_drag")
        assert unit.get(*names) == pytest.approx([0.027, 0.1, 1e-5, 0.02, 0.5], rel=1e-12)
        (error,) = unit.get("kinematic_error")
        unit.set(friction_torque=0.0, output_angle=error + 3e-4, wave_generator_speed=500.0)
        unit.set(output_speed=25.0)
        shafts = ("wave_generator_torque", "output_torque")
        found = unit.get(*shafts)
        unit.set(**dict.fromkeys(names, 0.0))
        ideal = unit.get(*shafts)
    assert ideal[1] < -1.0
    assert ideal[0] - found[0] == pytest.approx(0.027 + 0.1 * -ideal[1] + 500e-5, rel=1e-9)
    assert ideal[1] - found[1] == pytest.approx(0.02 + 0.5 * 25.0, rel=1e-9)


def test_the_table_of_losses_balances_the_power() -> None:
    loaded, idle = SampledRun(drag=DRAG), SampledRun(torque=0.0, loss=30.0, drag=DRAG)
    losses = LoadedLosses.of(loaded, idle)
    table = losses.table()
    torque, speed = table["output_torque_Nm"], table["input_speed_rad_s"]
    assert (torque.min(), torque.max()) == pytest.approx((0.0, 0.3))
    # the power of the losses is what the input gives less what the output takes, both ways
    power = table["loss_torque_Nm"] * speed
    useful = torque * speed / abs(RATIO)
    assert table["driving_input_torque_Nm"] * speed - useful == pytest.approx(power)
    assert useful - table["backdriving_input_torque_Nm"] * speed == pytest.approx(power)
    moving = (torque > 0.0) & (speed > 0.0)
    drives = useful[moving] / (useful[moving] + power[moving])
    assert table["driving_efficiency"][moving] == pytest.approx(drives)
    # at the speed of the run and its load: seals included
    design = loaded.summary.design
    omega = design.load.input_rate
    seals = design.losses.drag_at_input(omega, RATIO)
    assert losses.at_input(0.2, omega) == pytest.approx(0.045 + seals)


def test_the_drag_of_the_lubricant_follows_the_speed() -> None:
    """It is a part of both runs, and neither of what the load adds."""
    drag = ("losses.lubricant_viscosity=200",)
    loaded, idle = SampledRun(drag=drag), SampledRun(torque=0.0, loss=30.0, drag=drag)
    losses, omega = LoadedLosses.of(loaded, idle), loaded.summary.design.load.input_rate
    part = loaded.summary.losses.parts_Nmm.lubricant / 1000.0
    assert losses.at_input(0.2, omega) == pytest.approx(0.05)
    assert losses.at_input(0.0, omega) == pytest.approx(0.03)
    double = losses.at_input(0.0, 2.0 * omega)
    assert double - 0.03 == pytest.approx(part * (2.0 ** (2.0 / 3.0) - 1.0))


def test_friction_at_rest_is_in_the_table_and_in_the_torque_that_backdrives() -> None:
    """Friction of flanks and bearing grows by the factor, hysteresis and lubricant do not."""
    rest = ("losses.static_friction=1.5", "losses.stribeck_speed=100")
    loaded, idle = SampledRun(torque=2.0, drag=rest), SampledRun(torque=0.0, loss=15.0, drag=rest)
    losses = LoadedLosses.of(loaded, idle)
    # 2000 per minute: nothing is left of the additional friction
    assert losses.at_input(0.0, 209.4) == pytest.approx(0.015)
    slow = 100.0 * np.pi / 30.0
    assert losses.at_input(0.0, slow) == pytest.approx(0.005 + 0.01 * (1.0 + 0.5 / np.e))
    assert losses.at_input(0.0, 0.0) == pytest.approx(0.005 + 0.01 * 1.5)
    torque = losses.backdriving_torque()
    assert torque / abs(RATIO) == pytest.approx(losses.at_input(torque, 0.0))


def test_the_torque_that_backdrives_is_that_of_the_balance() -> None:
    idle = SampledRun(torque=0.0, loss=10.0)
    losses = LoadedLosses.of(SampledRun(torque=2.0), idle)
    torque = losses.backdriving_torque()
    assert torque / abs(RATIO) == pytest.approx(losses.at_input(torque, 0.0))
    # 0.2 N·m by N·m are more than 1 / 20
    assert LoadedLosses.of(SampledRun(), idle).backdriving_torque() == np.inf


def test_start_angles_shift_the_inputs(fmu: Path, tmp_path: Path) -> None:
    with instance(fmu, tmp_path / "unit") as unit:
        unit.set(wave_generator_angle=0.011, output_angle=2e-4)
        before = unit.get("output_torque", "wave_generator_torque", "windup", "kinematic_error")
        unit.set(wave_generator_start_angle=1.25, output_start_angle=-0.5)
        unit.set(wave_generator_angle=1.261, output_angle=2e-4 - 0.5)
        after = unit.get("output_torque", "wave_generator_torque", "windup", "kinematic_error")
        assert after == pytest.approx(before, rel=1e-9)


def test_impossible_parameters_are_refused(fmu: Path, tmp_path: Path) -> None:
    with instance(fmu, tmp_path / "unit") as unit:
        for values in (
            {"friction_speed": 0.0},
            {"loss_speed": -1.0},
            {"windup": 0.0},
            {"damping": np.nan},
        ):
            with pytest.raises(fmpy.fmi1.FMICallException):
                unit.set(**values)


def test_the_sources_fit_the_headers_of_the_standard(fmu: Path, tmp_path: Path) -> None:
    """The compiler compares every function with its declaration in the headers, which FMPy ships,
    and finds all."""
    folder = Path(fmpy.extract(str(fmu), str(tmp_path / "unit")))
    headers = Path(fmpy.__file__).parent / "c-code"
    code, binary = tmp_path / "check.c", tmp_path / "check.so"
    code.write_text('#include "fmi2Functions.h"\n#include "strain_wave_spring.c"\n')
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-shared", "-fPIC"]
    command = [
        "cc",
        *flags,
        f"-I{headers}",
        f"-I{folder / 'sources'}",
        str(code),
        "-o",
        str(binary),
        "-lm",
    ]
    assert subprocess.run(command, capture_output=True, text=True).stderr == ""


def test_fmpy_builds_the_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: Any
) -> None:
    """Without a compiler the FMU has its sources alone; another program builds it."""
    monkeypatch.setenv("CC", "no-such-compiler")
    with caplog.at_level("WARNING"):
        (path,) = write_fmu(StiffnessRun(), tmp_path, SampledRun())
    assert "sources only" in caplog.text
    monkeypatch.delenv("CC")
    assert fmpy.supported_platforms(str(path)) == ["c-code"]
    build_binary(path)
    with instance(path, tmp_path / "unit") as unit:
        unit.set(output_angle=1e-3)
        assert unit.get("output_torque")[0] < -5.0


def test_what_the_results_must_have(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"needs a run with \[stiffness\]"):
        write_fmu(SampledRun(), tmp_path)
    with pytest.raises(InputError, match="--ripple needs a run with steps.samples"):
        write_fmu(StiffnessRun(), tmp_path, StiffnessRun())
    with pytest.raises(
        InputError, match="--ripple has the ratio 50: allowed a run of the same drive, -20"
    ):
        write_fmu(StiffnessRun(), tmp_path, SampledRun(ratio=50.0))
    with pytest.raises(InputError, match="at 3 angles: allowed 4 and more"):
        write_fmu(StiffnessRun(), tmp_path, SampledRun(samples=3))
    with pytest.raises(InputError, match=r"--idle needs a run with \[losses\] and load.torque = 0"):
        write_fmu(StiffnessRun(), tmp_path, SampledRun(), SampledRun())
    with pytest.raises(InputError, match="--idle has the ratio 50"):
        write_fmu(StiffnessRun(), tmp_path, SampledRun(), SampledRun(ratio=50.0, torque=0.0))
    slack = StiffnessRun()
    slack.program["rotation_arcmin"] = np.minimum(slack.program["rotation_arcmin"], 1.0)
    with pytest.raises(InputError, match="the wind-up does not grow between"):
        write_fmu(slack, tmp_path)
    standing = StiffnessRun()
    standing.summary.design = small("plane", "drive.layout=wave_generator_fixed")
    with pytest.raises(
        InputError, match='"wave_generator_fixed" is not available with the format fmu'
    ):
        write_fmu(standing, tmp_path)
    monkeypatch.setenv("CC", "false")
    with pytest.raises(OutputError, match="the C compiler false cannot build the FMU"):
        write_fmu(StiffnessRun(), tmp_path)


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
def test_the_drive_of_two_runs(layout: str, tmp_path: Path) -> None:
    """Without friction a run computes one side of the loop; the FMU has both, with the stiffness of
    the summary."""
    shared = [*PLANE, f"drive.layout={layout}"]
    loop = {"stiffness.positions": 1, "stiffness.mesh_error": False}
    swgpar.run(swgpar.load_design(DESIGN, shared).with_values(loop), RECIPE, tmp_path / "stiffness")
    period = {"steps.samples": 6, "steps.rotation": 20.0, "losses.bearing_friction": 0.0015}
    swgpar.run(swgpar.load_design(DESIGN, shared).with_values(period), RECIPE, tmp_path / "period")
    (path,) = swgpar.export(tmp_path / "stiffness", tmp_path, ["fmu"], ripple=tmp_path / "period")
    found, losses = (
        getattr(swgpar.open_result(tmp_path / name).summary, entry)
        for name, entry in (("stiffness", "stiffness"), ("period", "losses"))
    )
    with instance(path, tmp_path / "unit") as unit:
        expected = [0.0, losses.loss_torque_Nmm / 1000.0]
        assert unit.get("friction_torque", "loss_torque") == pytest.approx(expected, rel=1e-12)

        def windup_under(torque: float) -> float:
            def left(angle: float) -> float:
                unit.set(output_angle=angle)
                return unit.get("output_torque")[0] + torque

            return brentq(left, -0.1, 0.1, xtol=1e-15)

        top, last = found.torque_Nm, found.break_points[-1] * found.torque_Nm
        for sign in (1.0, -1.0):
            chord = sign * (top - last) / (windup_under(sign * top) - windup_under(sign * last))
            assert chord == pytest.approx(found.K3, rel=1e-5)
        both = (windup_under(top) - windup_under(-top)) / ARCMIN
        assert both > found.backlash > 1.0


def test_the_table_of_a_given_loop() -> None:
    """Both branches, their mean, and the image where the program leaves out one side."""
    run = StiffnessRun()
    table = spring_table(run)
    lag = 0.5 * 0.5 * ARCMIN * (1.0 - np.abs(table["torque_Nm"]) / TOP)
    assert table["windup_rising_rad"] == pytest.approx(windup(table["torque_Nm"]) - lag, abs=1e-15)
    assert table["windup_falling_rad"] == pytest.approx(windup(table["torque_Nm"]) + lag, abs=1e-15)
    assert (
        np.array_equal(table["torque_Nm"], np.sort(table["torque_Nm"]))
        and table["torque_Nm"][0] == -TOP
    )
    chosen = run.program["stage"] == "positive loading"
    run.program = {name: values[chosen] for name, values in run.program.items()}
    image = spring_table(run)
    assert image["windup_rad"] == pytest.approx(-image["windup_rad"][::-1], abs=1e-15)
    assert image["windup_rising_rad"] == pytest.approx(image["windup_falling_rad"], abs=1e-15)

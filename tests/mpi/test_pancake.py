"""Pancake drive: a flexible spline that contacts alone hold, between a fixed ring gear and one that
is the output."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.pancake import loaded_pancake, pancake
from support.paths import DATA, RECIPE
from support.stepping import WORLD, rotate, row
from swgpar import load_design
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.saved_state import SolvedState, restore_state, state_rows
from swgpar.constraints.distributing_coupling import ROTATION
from swgpar.flank_pressure.pair_contact import pair_contacts
from swgpar.load.load_sequence import load_sequence
from swgpar.presentation.drive_result import DriveResult
from swgpar.results.checkpoint import read_checkpoint, write_checkpoint

TORQUE = 1000.0
"""Torque of the output, N mm."""

FRICTION = 0.05
"""Coefficient of friction."""

LAYOUTS = {"ring_fixed": (-20.0, 42), "spline_fixed": (21.0, 40)}
"""Ratio, and teeth of the fixed ring gear."""


def spline_rotation(stepper: LoadStepper) -> float:
    """Mean rotation (rad) of the flexible spline."""
    problem = stepper.problem
    return float(problem.supports.couplings[0].evaluate(problem.displacement()).value[ROTATION])


@pytest.mark.parallel([1, 2])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_balance_and_period(layout: str) -> None:
    """Both ring gears and the wave generator balance; after a pitch of the fixed ring gear the
    state is the same."""
    ratio, teeth = LAYOUTS[layout]
    design = pancake(f"drive.layout={layout}")
    assert design.kinematics.ratio == ratio
    stepper, first = loaded_pancake(design)
    tooth, second, cam = (
        first["tooth_torque_Nmm"],
        first["ds_tooth_torque_Nmm"],
        first["wg_torque_Nmm"],
    )
    at_output = second if layout == "ring_fixed" else tooth
    load = first["output_torque_Nmm"]
    parallel_assert(abs(load) == pytest.approx(TORQUE) and load * ratio < 0.0)
    parallel_assert(at_output == pytest.approx(load, abs=1e-4 * TORQUE))
    parallel_assert(abs(tooth + second + cam) < 1e-4 * TORQUE and 0.0 < cam < 0.2 * TORQUE)
    parallel_assert(first["torque_balance_Nmm"] < 1e-4 * TORQUE and first["pairs_in_contact"] >= 4)
    contacts = pair_contacts(stepper.model, stepper.load_state)
    parallel_assert(2 * len(contacts) == first["pairs_in_contact"])
    for ring, torque in (("ring_gear", tooth), ("dynamic_spline", second)):
        of_ring, (low, high) = (
            [one for one in contacts if one.ring == ring],
            design.axial_range(ring),
        )
        parallel_assert(
            2.0 * sum(one.torque_Nmm for one in of_ring) == pytest.approx(torque, rel=1e-6)
        )
        stations = [station.z_mm for one in of_ring for station in one.stations]
        parallel_assert(len(stations) > 0 and low < min(stations) and max(stations) < high)
    before, pitch = spline_rotation(stepper), 2.0 * np.pi / teeth
    last = rotate(stepper, pitch)
    turned = np.degrees(pitch) / ratio
    parallel_assert(
        last["output_angle_deg"] - first["output_angle_deg"] == pytest.approx(turned, abs=1e-5)
    )
    # the flexible spline rotates with the dynamic one, which is the output or fixed
    expected = np.radians(turned) if layout == "ring_fixed" else 0.0
    parallel_assert(spline_rotation(stepper) - before == pytest.approx(expected, abs=2e-7))
    for name in ("fs_vm", "rg_vm", "ds_vm", "wg_torque_Nmm"):
        parallel_assert(last[name] == pytest.approx(first[name], rel=1e-4))


@pytest.mark.parallel(2)
def test_any_number_of_ranks_gives_the_same() -> None:
    (_, parallel), (_, alone) = loaded_pancake(pancake()), loaded_pancake(pancake(), MPI.COMM_SELF)
    for name in set(alone) - {"torque_balance_Nmm", "newton_iterations"}:
        parallel_assert(parallel[name] == pytest.approx(alone[name], rel=1e-5, abs=1e-6))


@pytest.mark.parallel(1)
def test_half_of_the_drive_is_the_whole() -> None:
    """Nothing but the cam and the teeth centres the flexible spline in the whole drive."""
    (_, half), (_, whole) = (
        loaded_pancake(pancake()),
        loaded_pancake(pancake("solver.symmetry=false")),
    )
    for name in (
        "output_angle_deg",
        "fs_vm",
        "rg_vm",
        "ds_vm",
        "wg_torque_Nmm",
        "pairs_in_contact",
    ):
        assert whole[name] == pytest.approx(half[name], rel=1e-4), name


@pytest.mark.parallel(1)
def test_energy() -> None:
    """Without friction the input torque averages to that of the output over the ratio."""
    stepper, _ = loaded_pancake(pancake())
    pitch, samples = 2.0 * np.pi / 42, 8
    rows = [rotate(stepper, k * pitch / samples) for k in range(1, samples + 1)]
    torque = [one["wg_torque_Nmm"] for one in rows]
    # the coarse mesh has a ripple of a third of the mean, of which eight samples leave 0.3 %
    assert np.ptp(torque) > 0.1 * np.mean(torque)
    assert np.mean(torque) == pytest.approx(TORQUE / 20.0, rel=0.01)


def run(keys: dict[str, Any]) -> DriveResult:
    return swgpar.run(load_design(DATA / "pancake.toml", keys), mesh=RECIPE)


def mean_input(result: DriveResult) -> float:
    """Mean input torque of a period, N mm."""
    value = result.summary["mean.wg_torque_Nmm"].value
    assert isinstance(value, float)
    return value


@pytest.mark.parallel(1)
def test_stiffness_is_that_of_separate_loads() -> None:
    """K2, between the break points, beside the rotations under two torques of `load.torque`."""
    shares, torque = (0.4, 0.8), 1e-3 * TORQUE
    result = run(
        {
            "stiffness.torque": torque,
            "stiffness.positions": 1,
            "stiffness.break_points": list(shares),
            "stiffness.mesh_error": False,
        }
    )
    angles = [
        run({"load.torque": share * torque, "steps.rotation": 0.0}).history["output_angle_deg"]
        for share in shares
    ]
    turned = abs(np.radians(angles[1][-1] - angles[0][-1]))
    expected = (shares[1] - shares[0]) * torque / turned
    assert result.summary["stiffness.K2"].value == pytest.approx(expected, rel=1e-3)


@pytest.mark.parallel(1)
def test_a_program_is_that_of_separate_loads() -> None:
    """Torque and angle of the wave generator, one after the other, with the same states as runs
    under one torque."""
    torque = 1e-3 * TORQUE
    stages = [
        {"name": "loaded", "torque": torque},
        {"name": "unloaded", "torque": 0.4 * torque},
        {"name": "turned", "torque": 0.4 * torque, "wave_generator": 3.0},
    ]
    program = run({"load.program": stages, "steps.rotation": 0.0}).history
    alone = run({"load.torque": 0.4 * torque, "steps.rotation": 3.0, "steps.increment": 3.0})
    for name, rel in (("output_angle_deg", 1e-5), ("wg_torque_Nmm", 1e-3), ("fs_vm", 1e-4)):
        assert program[name][-2:] == pytest.approx(alone.history[name][-2:], rel=rel), name
    assert program["output_angle_deg"][-3] > program["output_angle_deg"][-2]


@pytest.mark.parallel(1)
def test_losses_are_what_friction_takes() -> None:
    """The mean input torque with friction between the flanks is that without friction and the work
    of the pairs of flanks in both ring gears."""
    ideal = run({"losses.flank_friction": FRICTION, "steps.samples": 4, "steps.rotation": 9.0})
    # two periods: the state settles in the first one
    real = run({"contact.friction": FRICTION, "steps.samples": 4, "steps.rotation": 18.0})
    added = mean_input(real) - mean_input(ideal)
    assert added > 0.0
    # forces and paths of the losses are those without friction: mu times the slope of the flanks
    lost = ideal.summary["losses.flank_friction"].value
    assert lost == pytest.approx(added, rel=2.0 * FRICTION)


@pytest.mark.parallel([1, 2])
def test_a_checkpoint_has_the_friction_of_both_ring_gears(tmp_path: Path) -> None:
    path = Path(WORLD.bcast(str(tmp_path))) / "state.h5"
    stepper, _ = loaded_pancake(pancake(f"contact.friction={FRICTION}"))
    stepper.problem.accept()
    model, flanks = stepper.model, stepper.problem.flanks
    before = [dict(one.history.tractions) for one in flanks]
    write_checkpoint(path, WORLD, state_rows(model), SolvedState.of(model))
    stepper.reset()
    assert not any(one.history.tractions for one in flanks)
    restore_state(model, path, read_checkpoint(path, WORLD, SolvedState))
    for one, known in zip(flanks, before, strict=True):
        parallel_assert(WORLD.allreduce(len(known)) > 0)
        for pair, cells in known.items():  # of other ranks there are more
            found = one.history.tractions[pair].traction
            assert found == pytest.approx(cells.traction) and np.abs(found).max() > 0.0


@pytest.mark.parallel(1)
def test_fatigue_has_the_stress_of_windows() -> None:
    """The largest normal stress of the cycle is the largest tension that windows find in a root."""
    keys = {"output.root_stress": True, "steps.samples": 1, "steps.rotation": 9.0}
    summary = run(keys | {"fatigue.surface_factor": 0.9}).summary
    root, fatigue = summary.root_stress, summary.fatigue
    assert root is not None and fatigue is not None
    assert root.s1 > 1.05 * root.on_mesh
    assert {name[:2] for name in root.regions} == {"fs", "rg", "ds"}
    least = fatigue.least["goodman"]
    assert least.amplitude_MPa + least.mean_MPa == pytest.approx(root.s1, rel=0.02)


@pytest.mark.parallel(1)
def test_without_torque_the_flexible_spline_is_held() -> None:
    """It rotates with the output at its kinematic angle, and nothing touches the teeth."""
    design = pancake("load.torque=0", "steps.rotation=3", "steps.increment=3")
    stepper, first = loaded_pancake(design)
    stepper.advance(load_sequence(design).states[-1])
    last = row(stepper)
    assert first["pairs_in_contact"] == last["pairs_in_contact"] == 0
    assert last["output_angle_deg"] == pytest.approx(-3.0 / 20.0)
    assert spline_rotation(stepper) == pytest.approx(np.radians(-3.0 / 20.0))
    assert abs(last["wg_torque_Nmm"]) < 1e-3 * TORQUE

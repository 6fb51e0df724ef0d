"""Features of one design file together, on the small plane drive: bearing, deviations, friction,
programs, fatigue."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.bearing import BEARING
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stepping import WORLD, load_stepper, small
from swgpar.analysis.deviating_drive import DeviatingDrive, TurnPoint
from swgpar.design.sections import GEARS
from swgpar.errors import InputError
from swgpar.evaluation.fatigue import evaluate_fatigue
from swgpar.evaluation.safety_and_life import SafetyAndLife
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.load.load_sequence import load_sequence
from swgpar.log import console
from swgpar.meshing import load_recipe
from swgpar.presentation.drive_result import DriveResult
from swgpar.presentation.terminal import print_drive

SAMPLED = ("steps.samples=2", "steps.rotation=9.0")
WEAK = (
    "fatigue.fatigue_limit=5",
    "fatigue.shear_fatigue_limit=3.1",
    "fatigue.basquin_coefficient=400",
    "fatigue.tensile_strength=4000",
)
"""SafetyAndLife limits that the small drive exceeds; a tensile strength that it does not, or its
life would be 0."""

RESOLVED = "output.root_stress=true"

UP, DOWN = '{name="up", torque=0.2}', '{name="down", torque=-0.2}'
AGAIN = ', {name="up again", torque=0.2}, {name="down again", torque=-0.2}'


def run(*overrides: str) -> DriveResult:
    return swgpar.run(small("plane", *overrides), RECIPE)


@pytest.mark.parallel(1)
def test_fatigue_over_a_program() -> None:
    """The program twice does twice the damage with the same safety; the stress is that of every
    sector."""
    results = [run(*WEAK, f"load.program=[{UP}, {DOWN}{more}]") for more in ("", AGAIN)]
    one, two = (result.summary.fatigue for result in results)
    assert (one.phases, two.phases) == (2, 4)
    assert results[1].fatigue_cycle["step"].tolist() == [3, 4, 5, 6]
    assert len(results[1].plot.haigh().axes) == 2
    for name in ("goodman", "crossland", "yield"):
        assert two.least[name].safety == pytest.approx(one.least[name].safety, rel=1e-3), name
    assert 0.0 < one.life.damage_per_program < np.inf and one.life.life_turns is None
    assert two.life.damage_per_program == pytest.approx(2.0 * one.life.damage_per_program, rel=0.02)
    assert two.life.life_programs == pytest.approx(0.5 * one.life.life_programs, rel=0.02)


@pytest.mark.parallel([1, 2, 3])
def test_fatigue_over_a_program_on_any_ranks() -> None:
    """Every rank has the histories of its sectors; the worst of them is that of one rank with
    all."""
    design = small("plane", *WEAK, f"load.program=[{UP}, {DOWN}]")

    def found(comm: MPI.Comm) -> SafetyAndLife:
        stepper = load_stepper(design, comm)
        sequence = load_sequence(design)
        cycle = StressCycle(stepper.model, sequence)
        for state in sequence.states:
            stepper.advance(state)
            cycle.keep(stepper.load_state, stepper.model.stresses()[1][FLEXIBLE_SPLINE])
        assert cycle.complete
        values = evaluate_fatigue(cycle, {}).found
        stepper.model.destroy()
        return values

    several, alone = found(WORLD), found(MPI.COMM_SELF)
    for name in ("goodman", "crossland"):
        for key in ("safety", "radius", "angle_deg"):
            a, b = getattr(several.least[name], key), getattr(alone.least[name], key)
            parallel_assert(a == pytest.approx(b, rel=1e-6), f"{name} {key}")
    parallel_assert(several.life.life_programs == pytest.approx(alone.life.life_programs, rel=1e-5))


@pytest.mark.parallel(1)
def test_everything_under_a_torque_in_one_run() -> None:
    """Bearing, windows, friction, fatigue, losses and a period in one run give what two runs do:
    one with windows, one with fatigue and losses over the period. The fatigue of all together is
    that of the resolved stress.

    The balls' loads act at the circle of their centres; the terminal names the results.
    """
    two_periods = ("steps.samples=2", "steps.rotation=18", "solver.rtol=1e-6")
    drive = (*BEARING, "contact.friction=0.1", *two_periods)
    evaluated = ("losses.bearing_friction=0.002", "fatigue.size_factor=1.0")
    result = run(*drive, *evaluated, RESOLVED)
    period = run(*drive, *evaluated, "output.contact_errors=false")
    windows = run(*drive, "steps.samples=0", "steps.rotation=0", RESOLVED)
    resolved, alone = result.summary.root_stress, windows.summary.root_stress
    assert resolved.s1 == pytest.approx(alone.s1, rel=1e-6)
    for name in ("fs_s1", "wg_torque_Nmm", "output_angle_deg"):
        assert result.history[name] == pytest.approx(period.history[name], rel=1e-4), name
    factors = [
        period.summary.fatigue.least[name].safety / result.summary.fatigue.least[name].safety
        for name in ("goodman", "crossland")
    ]
    assert factors == pytest.approx([resolved.s1 / resolved.on_mesh] * 2, rel=2e-3)
    strength, mises = result.summary.design.fatigue.yield_strength, "largest.fs_vm_off_corners"
    of_yield = strength / result.summary[mises].value
    assert result.summary.fatigue.least["yield"].safety == pytest.approx(of_yield, rel=2e-3)
    for part in ("bearing", "flank_friction"):
        taken = [getattr(one.summary.losses.parts_Nmm, part) for one in (result, period)]
        assert taken[0] == pytest.approx(taken[1], rel=1e-3), part
    losses, loads = result.summary.losses, result.balls["load_N"].reshape(-1, 20)[-2:]
    assert losses.cam_force_N == pytest.approx(loads.sum(axis=1).mean(), rel=1e-9)
    centres = 18.6 - 0.5 - 1.0
    expected = 0.002 * loads.sum(axis=1).mean() * centres * (1.0 + 2.0 / 40.0)
    assert losses.parts_Nmm.bearing == pytest.approx(expected, rel=1e-9)
    assert (
        result.summary.fatigue.least["goodman"].safety > 0.0
        and result.summary.bearing.ball_places == 2
    )
    with console.capture() as captured:
        print_drive(result.history, result.summary)
    shown = " ".join(captured.get().split())
    for words in (
        "largest ball load",
        "share of the bearing",
        "losses take",
        "L10",
    ):
        assert words in shown, words


@pytest.mark.parallel(1)
def test_friction_with_a_bearing() -> None:
    """Friction of the flanks takes input torque; the loads of the balls stay within a twentieth."""
    turned = ("steps.rotation=2.0", "steps.increment=2.0", "steps.samples=0")
    rough, smooth = (run(*BEARING, *turned, f"contact.friction={mu}") for mu in (0.1, 0.0))
    gained = rough.history["wg_torque_Nmm"][-1] - smooth.history["wg_torque_Nmm"][-1]
    assert 0.0 < gained < 0.2 * smooth.summary.rotation.wg_torque_expected_Nmm
    assert rough.summary.numerics.balance_error_Nmm < 1e-4
    last = [result.balls["load_N"][-20:] for result in (rough, smooth)]
    assert np.abs(last[0] - last[1]).max() < 0.05 * last[1].max()
    assert rough.summary.bearing.torsional_share.bearing > 0.05


@pytest.mark.parallel(1)
def test_stiffness_with_a_bearing() -> None:
    """The compliance without the bearing's share, found at the largest torque, is still more than
    that on the cam.

    Between the balls the spline yields where the cam would support it. Friction holds a part of
    the torque, and takes work in the loop. Windows are for one torque, and change nothing.
    """
    values = ("stiffness.positions=1", "stiffness.points=1", "stiffness.mesh_error=false")
    soft, rigid = run(*BEARING, *values), run(*values)
    rough = run(*BEARING, *values, RESOLVED, "contact.friction=0.1").summary.stiffness
    smooth = soft.summary.stiffness
    assert rough.loop_work > 1e-5 > abs(smooth.loop_work)
    assert smooth.K3 < rough.K3 < 1.2 * smooth.K3
    assert rough.K1 == pytest.approx(smooth.K1, rel=0.02)
    share = soft.summary.bearing.torsional_share.bearing
    print(share, soft.summary.stiffness.K3, rigid.summary.stiffness.K3)
    assert 0.1 < share < 0.5
    assert (1.0 - share) / soft.summary.stiffness.K3 > 1.0 / rigid.summary.stiffness.K3


@pytest.mark.parallel(1)
def test_ratcheting_crosses_a_backlash_with_a_bearing_in_whole_steps() -> None:
    """Two steps of 0.02 pitches end before flanks touch. The bearing has a torque there that is
    larger than the one up to which a drive counts as unloaded."""
    values = ("ratcheting.limit=0.04", *(f"{gear}.c_P=0.9" for gear in GEARS))
    result = run(*BEARING, *values)
    both = run(*BEARING, *values, RESOLVED, "contact.friction=0.1")
    for name in ("output_torque_Nmm", "wg_torque_Nmm"):  # flanks that do not touch have no friction
        expected = result.history[name]  # from the assembled drive on
        found = both.history[name][-len(expected) :]
        assert found == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())
    torque = np.abs(result.history["output_torque_Nmm"][-1])
    assert result.history["pairs_in_contact"][-1] == 0
    assert torque > result.summary.design.negligible_torque
    assert result.summary.ratcheting.states == 3


def turn_points(*overrides: str, indices: tuple[int, ...] = (0, 1)) -> dict[int, TurnPoint]:
    design = small("plane", 'deviations.mesh="same"', "deviations.angles_per_pitch=1", *overrides)
    drive = DeviatingDrive(design, load_recipe(RECIPE), MPI.COMM_SELF)
    known = set(range(drive.angles)).difference(indices)
    found = {point.index: point for point in drive.points(known)}
    drive.destroy()
    return found


@pytest.mark.parallel(1)
def test_deviations_with_a_bearing() -> None:
    """An eccentric ring gear on the bearing: its transmission error is near that on the cam, and
    not the same."""
    ring = ("deviations.ring_gear.eccentricity=0.01", "deviations.ring_gear.direction=90")
    errors = []
    for bearing in (BEARING, ()):
        found = turn_points(*bearing, *ring)
        errors.append(
            np.degrees(found[1].output_angle - found[0].output_angle) + 360.0 / 42.0 / 20.0
        )
    print(errors)
    others = ("contact.friction=0.1", RESOLVED, "fatigue.size_factor=1.0", *SAMPLED[:1])
    together = turn_points(*BEARING, *ring, *others, "steps.rotation=18")
    for index, point in turn_points(*BEARING, *ring).items():
        assert together[index].output_angle == pytest.approx(point.output_angle, abs=1e-9)
    assert errors[0] == pytest.approx(errors[1], rel=0.2)
    assert errors[0] != errors[1]


@pytest.mark.parallel(1)
def test_deviations_with_friction() -> None:
    """Over whole turns the transmission error is that of the run without friction, and says so; the
    history is that of the run with friction and without deviations."""
    turned = (*SAMPLED, "steps.rotation=18.0")
    deviations = (DEVIATIONS, 'deviations.mesh="same"', "deviations.angles_per_pitch=1")
    rough = run(*turned, *deviations, "contact.friction=0.1")
    found, smooth = rough.summary.transmission_error, run(*turned, *deviations)
    expected = smooth.summary.transmission_error
    assert found.peak_to_peak == pytest.approx(expected.peak_to_peak, rel=1e-3)
    assert found.angles == expected.angles
    assert any("without contact.friction" in words for words in found.remarks())
    assert not any("without contact.friction" in words for words in expected.remarks())
    assert rough.history["wg_torque_Nmm"][-1] > 1.01 * smooth.history["wg_torque_Nmm"][-1]


DEVIATIONS = "deviations.ring_gear.eccentricity=0.01"
PROGRAM = f"load.program=[{UP}]"
REFUSED = [
    ((DEVIATIONS, PROGRAM), "[deviations] is not available with load.program"),
    ((DEVIATIONS, "stiffness.positions=1"), "swgpar rate has a run for each"),
    ((DEVIATIONS, "ratcheting.limit=0.2"), "[deviations] is not available with [ratcheting]"),
    (
        (*BEARING, "deviations.wave_generator.eccentricity=0.01"),
        "deviations.wave_generator.eccentricity = 0.01 is out of range: allowed only 0 with "
        "wave_generator.bearing",
    ),
    (("losses.loss_factor=0.001", PROGRAM), "[losses] is not available with load.program"),
    (
        ("losses.loss_factor=0.001", "stiffness.positions=1"),
        "[losses] is not available with [stiffness]",
    ),
    (
        ("fatigue.size_factor=1.0", "stiffness.positions=1"),
        "[fatigue] is not available with [stiffness]",
    ),
    (
        ("fatigue.size_factor=1.0", "ratcheting.limit=0.2"),
        "[fatigue] is not available with [ratcheting]",
    ),
    (("stiffness.positions=1", PROGRAM), "load.program and [stiffness] are both given"),
    (
        ("stiffness.positions=1", "ratcheting.limit=0.2"),
        "[stiffness] and [ratcheting] are both given: allowed one of load.program, [stiffness], "
        "[ratcheting]; swgpar rate has a run for each",
    ),
    ((*SAMPLED, PROGRAM), "steps.samples = 2 is out of range: allowed only 0 with load.program"),
]


@pytest.mark.parallel(1)
@pytest.mark.parametrize(("overrides", "words"), REFUSED, ids=[words[:45] for _, words in REFUSED])
def test_refused(overrides: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError) as caught:
        swgpar.load_design(DESIGN, [*PLANE, *overrides])
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parallel(1)
def test_an_accuracy_with_a_bearing() -> None:
    """The mesh that is chosen and the usual one agree within the errors of both, in the stress and
    in what the bearing gives."""
    design = small("plane", *BEARING, "steps.rotation=0", "output.root_stress=true")
    usual, chosen = swgpar.run(design), swgpar.run(design, RECIPE, accuracy=0.03)
    assert chosen.summary.accuracy.reached
    stresses = [result.summary.root_stress for result in (usual, chosen)]
    apart = abs(stresses[0].s1 - stresses[1].s1)
    assert apart < sum(stress.total_error for stress in stresses)
    for name in ("bearing.largest_load", "bearing.torsional_share"):
        a, b = (result.summary[name] for result in (usual, chosen))
        assert abs(a.value - b.value) < a.error + b.error, name

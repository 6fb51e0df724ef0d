"""Fatigue criteria against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.answers.answer import declared_answers
from swgpar.design.sections import Fatigue
from swgpar.errors import InputError
from swgpar.evaluation.fatigue import _life
from swgpar.evaluation.fatigue_criteria import (
    critical_plane,
    crossland,
    damage,
    fatigue_limits,
    goodman,
    smallest_ball,
)
from swgpar.evaluation.losses import DriveLosses
from swgpar.evaluation.safety_and_life import SafetyAndLife
from swgpar.fem.stress import rotated_tensor
from swgpar.systems.drive import DRIVE

STEEL = Fatigue()
PHASE = 2.0 * np.pi * np.arange(360) / 360


def tension(mean: float, amplitude: float) -> np.ndarray:
    stress = np.zeros((360, 1, 6))
    stress[:, 0, 0] = mean + amplitude * np.cos(PHASE)
    return stress


def turned(stress: np.ndarray, seed: int = 1) -> np.ndarray:
    """Tensors in another frame: rotated about z, and then about x."""
    stress = rotated_tensor(stress, np.full(stress.shape[:-1], 0.3 + seed))
    cycled = stress[..., [1, 2, 0, 4, 5, 3]]  # x -> z, y -> x, z -> y
    return rotated_tensor(cycled, np.full(stress.shape[:-1], 0.7))


@pytest.mark.parametrize(("mean", "amplitude"), [(0.0, 300.0), (200.0, 250.0), (-300.0, 100.0)])
def test_goodman_of_alternating_tension(mean: float, amplitude: float) -> None:
    """In any frame; a compressive mean has no effect."""
    expected = amplitude / (0.86 * 560.0) + max(mean, 0.0) / 1250.0
    for stress in (tension(mean, amplitude), turned(tension(mean, amplitude))):
        found = critical_plane(stress, STEEL, plane=False)
        assert found.utilisation[0] == pytest.approx(expected, rel=1e-9)
        assert found.amplitude[0] == pytest.approx(amplitude) and found.mean[0] == pytest.approx(
            mean
        )
    assert critical_plane(tension(mean, amplitude), STEEL, plane=True).utilisation[
        0
    ] == pytest.approx(expected)


def test_crossland_at_the_fatigue_limits() -> None:
    """Alternating tension and alternating torsion at their limits both give 1; a mean counts by its
    pressure."""
    limit, shear = fatigue_limits(STEEL)
    torsion = np.zeros((360, 1, 6))
    torsion[:, 0, 3] = shear * np.cos(PHASE)
    for stress in (tension(0.0, limit), torsion, turned(tension(0.0, limit)), turned(torsion)):
        assert crossland(stress, STEEL)[0] == pytest.approx(1.0, rel=2e-4)
    alpha = 3.0 * shear / limit - np.sqrt(3.0)
    assert crossland(tension(300.0, limit), STEEL)[0] == pytest.approx(
        1.0 + alpha * 100.0 / shear, rel=2e-4
    )


def test_crossland_of_tension_and_torsion_out_of_phase() -> None:
    """With equal parts in the deviator the path is a circle: the ball is that of one of both
    parts."""
    limit, shear = fatigue_limits(STEEL)
    stress = tension(0.0, limit)
    stress[:, 0, 3] = limit / np.sqrt(3.0) * np.sin(PHASE)
    assert crossland(stress, STEEL)[0] == pytest.approx(1.0, rel=2e-4)


def test_smallest_ball() -> None:
    """Segment, triangle, and a cloud on a sphere in five dimensions with points inside; several at
    once."""
    rng = np.random.default_rng(3)
    sphere = rng.normal(size=(400, 5))
    sphere *= 7.0 / np.linalg.norm(sphere, axis=1, keepdims=True)
    sphere[200:] *= rng.uniform(0.0, 1.0, (200, 1))
    segment, triangle = np.zeros((400, 5)), np.zeros((400, 5))
    segment[:, 2] = np.linspace(-1.0, 3.0, 400)
    corners = np.array([[0.0, 1.0], [-np.sqrt(0.75), -0.5], [np.sqrt(0.75), -0.5]])
    triangle[:, :2] = corners[np.arange(400) % 3]
    found = smallest_ball(np.stack([sphere + 100.0, segment, triangle, np.ones((400, 5))], axis=1))
    assert found == pytest.approx([7.0, 2.0, 1.0, 0.0], rel=3e-4, abs=1e-9)
    assert (found[:3] >= np.array([7.0, 2.0, 1.0]) * (1.0 - 1e-3)).all()


def test_life_by_basquin() -> None:
    """A sine with a mean does the damage of one cycle at Goodman's amplitude; below the limit it
    does none."""
    pytest.importorskip("rainflow")
    fatigue = Fatigue(surface_factor=1.0)
    values = 200.0 + 600.0 * np.cos(PHASE)
    amplitude = 600.0 / (1.0 - 200.0 / 1250.0)
    cycles = 0.5 * (amplitude / 1875.0) ** (1.0 / -0.087)
    assert damage(values, fatigue) == pytest.approx(1.0 / cycles, rel=1e-9)
    assert damage(np.roll(values, 77), fatigue) == pytest.approx(1.0 / cycles, rel=1e-9)
    assert damage(0.5 * values, fatigue) == 0.0


@pytest.mark.parametrize(
    "of_cycle, damaged, turns",
    [(0.0, 0.0, None), (1e-6, 3e-6, 1e6 / 3.0), (float("inf"), None, 0.0)],
)
def test_life_without_end_and_without_any(
    of_cycle: float, damaged: float | None, turns: float | None
) -> None:
    """A cycle of a third of a turn."""
    found = _life(of_cycle, 2.0 * np.pi / 3.0, 2000.0)
    assert found.damage_per_turn == (damaged if damaged is None else pytest.approx(damaged))
    assert found.life_turns == (turns if turns is None else pytest.approx(turns))
    assert (found.life_hours is None) == (turns is None)


def test_rainflow_counts_every_cycle() -> None:
    """Two large cycles, and a small one on the way of one of them that is above the limit."""
    pytest.importorskip("rainflow")
    fatigue = Fatigue(surface_factor=1.0, fatigue_limit=400.0, shear_fatigue_limit=250.0)
    turning = np.array([800.0, -800.0, 500.0, -500.0, 800.0, -800.0])
    single = [damage(np.array([a, -a]), fatigue) for a in (800.0, 500.0)]
    assert damage(turning, fatigue) == pytest.approx(2.0 * single[0] + single[1], rel=1e-9)


def test_utilisation_grows_with_the_load() -> None:
    assert goodman(np.array([200.0]), np.array([100.0]), STEEL) * 2.0 == pytest.approx(
        goodman(np.array([400.0]), np.array([200.0]), STEEL)
    )


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (
            "fatigue.fatigue_limit=2000",
            "fatigue.fatigue_limit = 2000 is out of range: allowed above 0 to 1250 MPa",
        ),
        (
            "fatigue.shear_fatigue_limit=200",
            "fatigue.shear_fatigue_limit = 200 is out of range: allowed 323.3",
        ),
        ("fatigue.shear_fatigue_limit=600", "allowed above 0 to 560 MPa"),
        ("fatigue.yield_strength=2000", "allowed above 0 to 1250 MPa"),
        ("fatigue.surface_factor=0", "fatigue.surface_factor"),
        ("fatigue.basquin_exponent=0.1", "fatigue.basquin_exponent"),
        ("losses.loss_factor=-1", "losses.loss_factor"),
        ("losses.bearing_diameter=0", "losses.bearing_diameter"),
        ("fatigue.limit=3", "fatigue.limit"),
    ],
)
def test_bad_input_is_refused(override: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        swgpar.load_design(DESIGN, [override])
    assert words in str(error.value)


def test_strengths_of_steel_are_for_steel_alone() -> None:
    given = [
        "fatigue.tensile_strength=50",
        "fatigue.yield_strength=45",
        "fatigue.fatigue_limit=15",
        "fatigue.shear_fatigue_limit=9",
        "fatigue.basquin_coefficient=75",
        "fatigue.basquin_exponent=-0.1",
    ]
    plastic = 'flexible_spline.material.name="PLA"'
    assert swgpar.load_design(DESIGN, [plastic, *given]).fatigue.tensile_strength == 50.0
    for n, one in enumerate(given):
        with pytest.raises(InputError) as error:
            swgpar.load_design(DESIGN, [plastic, *given[:n], *given[n + 1 :]])
        assert f"{one.split('=')[0]} is missing: the default is that of a steel" in str(error.value)


def test_a_run_has_figures_and_quantities() -> None:
    """The nodes with the least safety are those of the fields; every quantity of studies has a
    value."""
    pytest.importorskip("rainflow")
    sampled = [
        *PLANE,
        "steps.samples=2",
        "steps.rotation=9",
        "fatigue.size_factor=1.0",
        "losses.loss_factor=1e-3",
    ]
    design = swgpar.load_design(DESIGN, sampled)
    result = swgpar.run(design, RECIPE)
    found, fields = result.summary.fatigue, result.fatigue.fields
    names = list(found.regions)
    sound = np.isin(
        fields["region"], [k for k, name in enumerate(names) if not found.regions[name].warning]
    )
    for criterion in ("goodman", "crossland", "yield"):
        place = found.least[criterion]
        values = fields[f"safety_{criterion}"][sound]
        assert values.min() == pytest.approx(place.safety)
        assert fields["region"][sound][values.argmin()] == names.index(place.region)
    worst, values = found.least["goodman"], result.fatigue_cycle["normal_stress_MPa"]
    assert worst.amplitude_MPa == pytest.approx(0.5 * np.ptp(values))
    assert worst.mean_MPa == pytest.approx(0.5 * (values.max() + values.min()))
    assert found.phases == len(values) == 2 * 20
    assert found.life.cycles_per_turn == pytest.approx(2.0 * 42.0 / 40.0)
    assert found.root_factor is None and list(found.remarks())[-1].startswith(
        "the strengths in [fatigue]"
    )
    # without windows, and with a load
    absent = {"fatigue.root_factor", "losses.no_load_torque", "losses.starting_torque"}
    known = {kind.name for kind in (*SafetyAndLife.kinds(design), *declared_answers(DriveLosses))}
    assert known - absent <= set(DRIVE.measure(result).values) & set(DRIVE.quantities(design))
    assert {"haigh", "safety"} <= set(result.plot.names)
    assert len(result.plot.haigh().axes) == 2 and result.plot.safety().axes


def test_windows_scale_the_tooth_root() -> None:
    """Stresses grow by the factor of their region, those without one stay."""
    pytest.importorskip("rainflow")
    sampled = [*PLANE, "steps.samples=2", "steps.rotation=9", "fatigue.size_factor=1.0"]
    sampled += ["steps.start_levels=1"]  # a coarser mesh, for the error of the drive's mesh
    plain, scaled = (
        swgpar.run(
            swgpar.load_design(DESIGN, [*sampled, f"output.root_stress={flag}"]), "plane_coarse"
        ).summary
        for flag in ("false", "true")
    )
    root, factor = scaled.root_stress, scaled.fatigue.root_factor
    assert factor == pytest.approx(root.s1 / root.on_mesh) and factor > 1.0
    factors = scaled.fatigue.factors
    assert set(factors) == {"tooth root", "rim inside"} and factors["tooth root"] == factor
    for region, values in plain.fatigue.regions.items():
        by = factors.get(region, 1.0)
        found = scaled.fatigue.regions[region].safety["goodman"]
        assert found == pytest.approx(values.safety["goodman"] / by, rel=1e-5)
    strength = scaled.design.fatigue.yield_strength
    of_yield = strength / scaled["largest.fs_vm_off_corners"].value
    assert scaled.fatigue.least["yield"].safety == pytest.approx(of_yield, rel=1e-5)
    relative = scaled.fatigue.mesh_error / scaled.fatigue.least["goodman"].safety
    assert relative == pytest.approx(root.total_error / root.s1)

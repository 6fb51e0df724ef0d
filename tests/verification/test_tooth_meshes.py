"""Stiffness, contact ratio and phase of the meshes of a planetary stage from their teeth."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from swgpar.gear_trains.planetary_stage.tooth_meshes import plane_pair
from swgpar.gear_trains.planetary_stage.tooth_meshes.helical import (
    HelicalTeeth,
    mesh_cycle,
    stiffnesses,
)
from swgpar.gear_trains.planetary_stage.tooth_meshes.iso_6336 import C_M, single_stiffness
from swgpar.gear_trains.planetary_stage.tooth_meshes.pairs import GearMesh, ToothedGear
from swgpar.gear_trains.planetary_stage.tooth_meshes.plane_pair import TipRelief

ANGLE = np.radians(20.0)
STEEL = 206e3, 0.3


def teeth(sun: int, ring: int, shift: float = 0.0, helix: float = 0.0) -> HelicalTeeth:
    numbers = sun, (ring - sun) // 2, ring
    return HelicalTeeth(numbers, 10.0, ANGLE, helix, (1.0, 1.25, shift), 200.0, STEEL)


def place_of_flank(gear: ToothedGear, turn: float, side: int, pitch: complex, u: complex) -> float:
    """Where a flank of a tooth that is turned by an angle crosses the line of action.

    side : -1 the leading flank of a gear that turns clockwise, 1 the trailing one
    """

    def across(radius: float) -> float:
        angle = turn + side * float(plane_pair.half_angle(gear, np.array([radius]))[0])
        return float(((radius * np.exp(1j * angle) - pitch) * np.conj(u)).imag)

    above_fillet = gear.root_radius + plane_pair.FILLET * gear.module
    low, high = max(gear.base_radius, above_fillet) * (1.0 + 1e-9), 1.02 * gear.tip_radius
    radius = brentq(across, low, high, xtol=1e-12)
    angle = turn + side * float(plane_pair.half_angle(gear, np.array([radius]))[0])
    return float(((radius * np.exp(1j * angle) - pitch) * np.conj(u)).real)


@pytest.mark.parametrize(
    ("sun", "ring", "shift"), [(21, 99, 0.0), (30, 90, 0.0), (24, 84, 0.3), (25, 77, -0.2)]
)
def test_phase_by_flanks_that_turn(sun: int, ring: int, shift: float) -> None:
    """Flanks of the planet, drawn and turned clockwise, cross both lines of action: the leading one
    on the side of the sun, the trailing one on that of the ring."""
    stage = teeth(sun, ring, shift).transverse
    planet, (at_sun, at_ring) = stage.planet, stage.meshes
    radius, pitch = planet.pitch_radius, 2.0 * np.pi / planet.teeth
    cycles = []
    for mesh, point, u, side in (
        (at_sun, -radius, -np.sin(ANGLE) + 1j * np.cos(ANGLE), -1),
        (at_ring, radius, -np.sin(ANGLE) - 1j * np.cos(ANGLE), 1),
    ):
        middle = mesh.two_pairs * mesh.base_pitch
        centre = np.angle(point) if point < 0 else 0.0

        def off(turn: float) -> float:
            return place_of_flank(planet, turn, side, point, u) - middle  # noqa: B023

        half = float(plane_pair.half_angle(planet, np.array([radius]))[0])
        near = centre - side * half - mesh.two_pairs * pitch  # at the pitch point, and turned on
        turn = brentq(off, near - 0.05 * pitch, near + 0.05 * pitch)
        assert off(turn - 0.01 * pitch) == pytest.approx(0.01 * mesh.base_pitch, rel=1e-6)
        cycles.append(-turn / pitch)  # the planet turns clockwise
    behind = (cycles[1] - cycles[0] + 0.5) % 1.0 - 0.5
    assert stage.phase == pytest.approx(behind, abs=1e-9)


def test_contact_ratios() -> None:
    """By the lengths between tip circles: of standard gears, and of a ring with an outer one."""
    sun, planet, ring = 24, 30, 84
    stage = teeth(sun, ring).transverse
    for mesh, (a, b, sign) in zip(stage.meshes, ((sun, planet, 1), (planet, -ring, -1))):
        r1, r2 = 5.0 * a, 5.0 * abs(b)
        lengths = [
            np.sqrt((r1 + 10.0) ** 2 - (r1 * np.cos(ANGLE)) ** 2),
            np.sqrt((r2 + sign * 10.0) ** 2 - (r2 * np.cos(ANGLE)) ** 2),
        ]
        path = lengths[0] + sign * lengths[1] - (r1 + sign * r2) * np.sin(ANGLE)
        assert mesh.contact_ratio == pytest.approx(path / (10.0 * np.pi * np.cos(ANGLE)))


def test_stiffness_by_the_standard() -> None:
    """Near 14 and 20 N/(mm µm), which the standard gives for steel gears without computation; half
    of the modulus halves it, and loads below 100 N/mm soften it."""
    sun, _ = stiffnesses(teeth(24, 96), 300.0, "iso_6336")
    assert 1e-3 * sun.single == pytest.approx(14.0, rel=0.1)
    assert 1e-3 * sun.mean == pytest.approx(20.0, rel=0.1)
    rack = {"dedendum": 1.25, "angle": ANGLE, "helix": 0.0}
    whole, half, light = (
        single_stiffness((24.0, 36.0), (0.0, 0.0), **rack, modulus=E, load=load)
        for E, load in ((206.0, 300.0), (103.0, 300.0), (206.0, 100.0 / 16.0))
    )
    assert half == pytest.approx(0.5 * whole) and light == pytest.approx(0.5 * whole)


@pytest.mark.parametrize(
    ("teeth", "shifts", "helix", "single"),
    [
        ((19.0, 17.0), (0.617, 0.802), 0.0, 14.686762),
        ((18.0, 36.0), (0.389, 0.504), 0.0, 14.195069),
        ((24.0, 95.0), (0.480, 0.669), 10.0, 15.402808),
    ],
)
def test_the_standard_by_a_public_program(
    teeth: tuple[float, float], shifts: tuple[float, float], helix: float, single: float
) -> None:
    """Drivetrain (gfsReboucas) has these for the stages of the 5 MW reference gearbox. For helical
    teeth it takes the virtual numbers of teeth by the base helix angle: 4e-4."""
    rack = {"dedendum": 1.25, "angle": ANGLE, "helix": np.radians(helix)}
    ours = single_stiffness(teeth, shifts, **rack, modulus=206.0, load=300.0)
    assert ours == pytest.approx(single, rel=5e-4 if helix else 1e-7)


@pytest.mark.parametrize(("sun", "ring"), [(21, 99), (40, 120)])
def test_plane_elements_beside_the_standard(sun: int, ring: int) -> None:
    """At 100 N/mm plane elements are between the standard and its theoretical stiffness, which is
    1 / C_M of it, for outer gears, and within 5 % of the latter for a ring."""
    by_standard, by_elements = (
        stiffnesses(teeth(sun, ring), 100.0, method) for method in ("iso_6336", "plane")
    )
    outer, inner = (p.single / s.single for p, s in zip(by_elements, by_standard, strict=True))
    assert 1.05 < outer < 1.0 / C_M and abs(C_M * inner - 1.0) < 0.05
    for plane, standard in zip(by_elements, by_standard, strict=True):
        assert plane.variation == pytest.approx(standard.variation, rel=0.03)


def test_stiffness_of_a_stiffer_load_and_finer_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    """More load widens the contact and stiffens it. Elements of half the size change 0.35 %."""
    mesh: GearMesh = teeth(21, 99).transverse.meshes[0]
    light, heavy = (plane_pair.pair_stiffness(mesh, load, *STEEL).single for load in (100.0, 800.0))
    plane = 2.0 * (1.0 - 0.3**2) / (np.pi * 206e3)
    # both half widths grow with the root of the load
    expected = 1.0 / light - plane * np.log(8.0)
    assert 1.0 / heavy == pytest.approx(expected, rel=2e-3)
    monkeypatch.setattr(plane_pair, "ACROSS", 32)
    monkeypatch.setattr(plane_pair, "ALONG", 48)
    plane_pair.pair_stiffness.cache_clear()
    assert plane_pair.pair_stiffness(mesh, 100.0, *STEEL).single == pytest.approx(light, rel=5e-3)
    plane_pair.pair_stiffness.cache_clear()


def test_relief_that_makes_the_approach_constant() -> None:
    """Linear relief along all of the path with two pairs, as deep at the tips as the load presses a
    pair together, takes as much from one pair as it gives to the other."""
    mesh = teeth(21, 99).transverse.meshes[0]
    (begin, end), load, stiff = mesh.path, 150.0, 14e3
    place = np.linspace(begin, end, 9)
    first = np.linspace(begin, begin + mesh.base_pitch, 50, endpoint=False)
    relief = TipRelief(load / stiff, mesh.contact_ratio - 1.0)
    found = plane_pair.approach(mesh, place, np.full(9, stiff), relief, load, first)
    np.testing.assert_allclose(found, load / stiff, rtol=1e-12)


def test_relief_lets_one_pair_carry_longer() -> None:
    """A pair carries once the approach closes its gap: forces of both pairs are the load. Deep
    relief softens the mesh and lowers its variation."""
    mesh = teeth(21, 99).transverse.meshes[0]
    found = [
        plane_pair.pair_stiffness(mesh, 100.0, *STEEL, TipRelief(depth, 0.3))
        for depth in (0.0, 1e-9, 5e-3, 20e-3)
    ]
    assert found[1].mean == pytest.approx(found[0].mean, rel=2e-3)
    assert np.all(np.diff([one.mean for one in found[1:]]) < 0.0)
    assert np.all(np.diff([one.variation for one in found[1:]]) < 0.0)
    (begin, end), first = mesh.path, np.array([mesh.path[0] + 0.02 * mesh.base_pitch])
    place, relief = np.linspace(begin, end, 99), TipRelief(3e-3, 0.3)
    pairs = np.linspace(10e3, 14e3, 99)
    (near,) = plane_pair.approach(mesh, place, pairs, relief, 100.0, first)
    at = np.array([first[0], first[0] + mesh.base_pitch])
    closed = np.maximum(near - relief.gap(mesh, at), 0.0)
    assert (closed > 0.0).any()
    assert np.interp(at, place, pairs) @ closed == pytest.approx(100.0)


def test_helical_teeth_smooth_the_cycle() -> None:
    """An overlap ratio of one leaves no variation of the first harmonic."""
    helix = float(np.arctan(np.pi * 10.0 / 200.0))
    cycle = mesh_cycle(teeth(21, 99, helix=helix), 300.0, "iso_6336")
    assert cycle.overlap == pytest.approx(1.0)
    assert np.sinc(cycle.overlap) == pytest.approx(0.0, abs=1e-12)

"""Inertia of the rim: natural frequencies of rings, rings that flow along their own curve, and what
`swgpar check` says of them."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DESIGN
from swgpar import load_design
from swgpar.checks.inertia import inertia_remarks, negligible_speeds
from swgpar.errors import InputError
from swgpar.geometry.rim_inertia import RimInertia

DENSE = "material.density=7850.0"


def rim(lobes: int = 2) -> RimInertia:
    return RimInertia(58.0, 1.0, 1.0, 210e3, 7850.0, lobes, 1.0)


@pytest.mark.parametrize("lobes", [2, 3])
def test_a_wave_at_the_natural_frequency_of_a_ring_at_rest_needs_no_force(lobes: int) -> None:
    """Hoppe's ring: p² = n² (n² - 1)² / (n² + 1) E I / (rho A R⁴)."""
    n, radius = lobes, 0.058
    stiff = 210e9 * 1e-6 / 12.0 / (7850.0 * radius**4)
    frequency = np.sqrt(n**2 * (n**2 - 1) ** 2 / (n**2 + 1) * stiff)
    assert rim(lobes).share_of_bending(0.0, frequency / n) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("lobes", [2, 3])
@pytest.mark.parametrize("speed", [10.0, 500.0])
def test_a_rim_that_flows_along_a_standing_wave_has_no_inertia(lobes: int, speed: float) -> None:
    one = rim(lobes)
    assert abs(one.share_of_bending(speed, 0.0)) < 1e-12 * one.share_of_bending(0.0, speed)
    assert one.hoop_stress(speed) == pytest.approx(1e-6 * 7850.0 * (0.058 * speed) ** 2)


def test_a_ring_by_its_lagrangian() -> None:
    """Both speeds at once: the kinetic energy of a ring that bends without extension, by
    quadrature."""
    n, radius, amplitude, spin, wave = 2, 58.0, 0.01, 300.0, 120.0
    angle = 2.0 * np.pi * np.arange(4000) / 4000
    passing = wave - spin

    def energy(u: float) -> float:
        outward = u * np.cos(n * angle) - (n**2 - 1) ** 2 * u**2 / (4 * n**2 * radius)
        along = -u / n * np.sin(n * angle)
        fast_outward = u * n * passing * np.sin(n * angle)
        fast_along = u * passing * np.cos(n * angle)
        # the second order along the rim makes its second order outward the same all round
        around = fast_along + spin * (radius + outward)
        return float(((fast_outward - spin * along) ** 2 + around**2).mean())

    found = (energy(amplitude) + energy(-amplitude) - 2.0 * energy(0.0)) / (2.0 * amplitude**2)
    one = rim()
    stiffness = 210e3 / 12.0 * (n**2 - 1) ** 2 / radius**4 / (1e-12 * 7850.0)
    assert one.share_of_bending(spin, wave) == pytest.approx(2.0 * found / stiffness, rel=1e-6)


def speeds(*overrides: str) -> dict[str, float]:
    design = load_design(DESIGN, overrides)
    return negligible_speeds(design.rim_inertia, design.kinematics)


def test_speeds_follow_from_the_layout() -> None:
    fixed = speeds(DENSE)
    turning = speeds(DENSE, "drive.layout=wave_generator_fixed")
    assert not speeds()
    assert len(fixed) == 2 and len(turning) == 1
    of_rotation = next(name for name in fixed if "rotation" in name)
    # the rim turns 21 times as fast as with the ring gear fixed
    assert fixed[of_rotation] == pytest.approx(21.0 * turning[of_rotation])


def test_a_fast_input_is_said() -> None:
    turning = [DENSE, "drive.layout=wave_generator_fixed"]
    (least,) = speeds(*turning).values()
    for factor, count in ((0.99, 0), (1.01, 1)):
        design = load_design(DESIGN, [*turning, f"load.input_speed={factor * least}"])
        assert len(inertia_remarks(design.rim_inertia, design.speeds, design.load)) == count
    first, _ = speeds(DENSE).values()
    for factor, count in ((0.99, 0), (10.0, 1)):
        design = load_design(DESIGN, [DENSE, f"load.input_speed={factor * first}"])
        said = inertia_remarks(design.rim_inertia, design.speeds, design.load)
        assert len(said) == count
    # forces of inertia grow with the square of the speed
    assert "is 100 % of the forces" in said[0] and "takes them from the cam" in said[0]
    default = load_design(DESIGN, [DENSE])
    assert not inertia_remarks(default.rim_inertia, default.speeds, default.load)
    speed = f"load.input_speed={2.0 * first}"
    acting = load_design(DESIGN, [DENSE, "load.inertia=true", speed])
    assert not inertia_remarks(acting.rim_inertia, acting.speeds, acting.load)


BEARING = ("micro_geometry.wg_slope=0", "wave_generator.bearing.balls=20")
BEARING += ("wave_generator.bearing.ball_diameter=2", "wave_generator.bearing.race_thickness=0.5")
BOLTED = ("cup.attachment=bolted", "cup.bolts=6", "cup.bolt_circle=20", "cup.washer_diameter=3")
CARRIED = tuple(f"output_bearing.{kind}_stiffness=1e5" for kind in ("radial", "axial", "tilting"))


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ((), "the density of flexible_spline is missing: load.inertia = true needs it"),
        ((DENSE, "load.input_speed=1e5"), r"load.input_speed = 100000 is out of range: allowed ab"),
        ((DENSE, "stiffness.torque=0.2"), "not available with a load program"),
        ((DENSE, "deviations.flexible_spline.eccentricity=0.01"), r"with \[deviations\]"),
        ((DENSE, *BOLTED), "sectors are alike"),
        ((DENSE, *CARRIED, "output_bearing.radial_force=5"), "a radial force or a tilting moment"),
        (
            ("flexible_spline.material={E=210e3, nu=0.3, density=7850.0}", *BEARING),
            "the density of bearing is missing",
        ),
    ],
)
def test_forces_of_inertia_that_are_refused(overrides: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        load_design(DESIGN, [*overrides, "load.inertia=true"])


def test_the_largest_speed_of_forces_of_inertia_is_that_of_a_natural_wave() -> None:
    with pytest.raises(InputError) as caught:
        load_design(DESIGN, [DENSE, "load.inertia=true", "load.input_speed=1e5"])
    most = float(str(caught.value).split("above 0 to ")[1].split()[0])
    design = load_design(DESIGN, [DENSE, "load.inertia=true", f"load.input_speed={0.999 * most}"])
    assert design.rim_inertia.share_of_bending(*design.speeds) == pytest.approx(1.0, rel=0.01)


def test_inertia_of_a_deflected_ring_at_rest_is_its_mass_by_its_acceleration() -> None:
    """A point moves by u cos n (a - w t) outward and (u / n) sin n (a - w t) along: the work of its
    inertia on that motion over the energy of bending, by quadrature."""
    one, wave = rim(3), 200.0
    n, u = one.lobes, 0.01
    angle = 2.0 * np.pi * np.arange(720) / 720
    outward, along = u * np.cos(n * angle), -u / n * np.sin(n * angle)
    accelerated = -((n * wave) ** 2) * np.array([outward, along])
    density = 1e-12 * one.density * one.mass_thickness
    inertia = -density * float(np.mean(accelerated[0] * outward + accelerated[1] * along))
    curvature = (n**2 - 1) * outward / one.radius**2
    bending = one.modulus * one.thickness**3 / 12.0 * float(np.mean(curvature**2))
    assert one.share_of_bending(0.0, wave) == pytest.approx(inertia / bending, rel=1e-12)

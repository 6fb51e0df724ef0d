"""The involute flank with its fillet: external teeth by a rack, internal by a shaper (3.3.1).

Generation about the pitch point I, with the gear's axis at (0, -r_P) from it: while the gear turns
clockwise by psi (the generating angle) the rack moves by r_P psi, or the shaper turns by psi N /
N_g (eq. 3.15). By the equation of meshing (eq. 3.14) the cutter touches the gear where its normal
passes through I. So

- the straight flank of the rack and the shaper's involute, of pressure angle alpha, touch at K = w
n with
  n = (cos alpha, s sin alpha), w = r_b (psi + alpha_P), where alpha_P is half the angular thickness
  of the tooth;
- the rounded cutter tip, radius rho about C(psi), touches at K = C (1 + rho / |C|), n = -C / |C|.

The flank is x = R(psi) (K - O): K in the gear's frame. s = +1 for external, -1 for internal teeth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.rotation import rotated
from swgpar.input.require import require
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.teeth import Teeth

Center = Callable[[Floats], tuple[Floats, Floats]]
"""Centre C (n, 2) mm of the cutter's rounded tip, and dC/dpsi (n, 2), at psi (n,)."""


@dataclass(frozen=True)
class Cutter(Teeth):
    """Gear and cutter of one reference profile: external teeth by a rack, internal by a shaper; mm.

    tip_radius : rounding of the cutter's teeth
    shift : of the cutter outwards, in modules;  cutter_teeth : teeth of the shaper
    c_P : angular tooth thickness reduction; below 1 the cutter's teeth are thicker
    """

    tip_radius: float
    shift: float
    cutter_teeth: int = 0
    c_P: float = 1.0

    @property
    def r_base(self) -> float:
        """Base radius (eq. 3.12)."""
        return self.r_pitch * np.cos(self.pressure_angle)

    @property
    def half_thickness(self) -> float:
        """Half the angular thickness of the gear's teeth at the pitch circle, alpha_P."""
        return (
            0.5 * np.pi * self.c_P + 2.0 * self.sign * self.shift * np.tan(self.pressure_angle)
        ) / self.n_teeth

    @property
    def depth(self) -> float:
        """How far the cutter's teeth reach beyond the pitch circle."""
        return self.dedendum - self.sign * self.shift * self.module

    @property
    def r_tip_circle(self) -> float:
        """Addendum radius."""
        return self.r_pitch + self.sign * self.addendum + self.shift * self.module

    @property
    def r_root_circle(self) -> float:
        """Dedendum radius."""
        return self.r_pitch - self.sign * self.depth

    @property
    def r_cutter(self) -> float:
        """Pitch radius of the shaper."""
        return 0.5 * self.cutter_teeth * self.module

    def contact_distance(self, radius: float) -> float:
        """Distance w from the pitch point at which the involute reaches `radius`; mm."""
        base = np.sqrt(radius**2 - self.r_base**2)
        return self.sign * (base - self.r_base * np.tan(self.pressure_angle))


def _check_tip(cut: Cutter, limit: float, name: str) -> None:
    """The rounding must leave the cutter's tooth a flat tip: below `limit`, mm."""
    angle, radius = np.degrees(cut.pressure_angle), cut.tip_radius
    allowed = "are smaller angles, for which the cutter's tooth does not end in a point"
    require(limit > 0.0, f"{name}.pressure_angle", angle, allowed)
    allowed = f"above 0 to below {limit:.6g} mm, where the cutter's tooth has no flat tip left"
    require(radius < limit, f"{name}.cutter_radius", radius, allowed)


def _rack_tip(cut: Cutter, name: str) -> tuple[float, float, Center]:
    """Generating angles at the ends of the fillet, and C (n, 2) with dC/dpsi (n, 2)."""
    tangent, rho = np.tan(cut.pressure_angle), cut.tip_radius
    rise = (1.0 - np.sin(cut.pressure_angle)) / np.cos(cut.pressure_angle)
    # centre of the rounding: from the tooth's centre line, and below the pitch line
    flank = cut.half_thickness * cut.r_pitch + cut.depth * tangent
    across, below = flank + rho * rise, cut.depth - rho
    _check_tip(cut, min((0.5 * np.pi * cut.module - flank) / rise, cut.depth), name)

    def center(psi: Floats) -> tuple[Floats, Floats]:
        c = np.stack((across + cut.r_pitch * psi, np.full_like(psi, -below)), axis=-1)
        return c, np.stack((np.full_like(psi, cut.r_pitch), np.zeros_like(psi)), axis=-1)

    # psi = (c_x - across) / r_P; c_x = -below cot(alpha) where the normal is the flank's, 0 at the
    # root
    return (-below / tangent - across) / cut.r_pitch, -across / cut.r_pitch, center


def _shaper_tip(cut: Cutter, name: str) -> tuple[float, float, Center]:
    """The same as `_rack_tip` for the tip of a shaper's tooth."""
    alpha, rho, ratio = cut.pressure_angle, cut.tip_radius, cut.n_teeth / cut.cutter_teeth
    r_g, r_b = cut.r_cutter, cut.r_cutter * np.cos(alpha)
    r_c = r_g + cut.depth - rho

    def margin(radius: float) -> float:
        """Polar angle from the middle of the shaper's tooth to the centre of such a rounding."""
        roll = np.arccos(r_b / (r_g + cut.depth - radius))
        thickness = np.pi / cut.cutter_teeth - cut.half_thickness * ratio
        return thickness + np.tan(alpha) - alpha - (np.tan(roll) - roll) - radius / r_b

    limit = cut.depth
    if margin(limit) < 0.0 < margin(0.0):
        limit = root_between(margin, 0.0, limit, xtol=1e-12 * cut.module)
    _check_tip(cut, limit if margin(0.0) > 0.0 else 0.0, name)
    offset = np.pi / cut.cutter_teeth - margin(rho)

    def center(psi: Floats) -> tuple[Floats, Floats]:
        angle = offset + ratio * psi
        c = np.stack((r_c * np.sin(angle), r_c * np.cos(angle) - r_g), axis=-1)
        return c, ratio * r_c * np.stack((np.cos(angle), -np.sin(angle)), axis=-1)

    # C on the line of action, at the distance w_c from I on the far side of the flank's contact
    w_c = np.sqrt(r_c**2 - r_b**2) - r_b * np.tan(alpha)
    return (-np.arcsin(w_c * np.cos(alpha) / r_c) - offset) / ratio, -offset / ratio, center


GeneratingContact = Callable[[Floats], tuple[Floats, Floats, Floats, Floats]]
"""K (n, 2) mm, dK/dpsi (n, 2), angle of the normal (n,) rad and its rate (n,) at psi (n,)."""


def _curve(
    cut: Cutter, name: str, ends: tuple[float, float], contact: GeneratingContact
) -> CurvedSegment:
    """Segment from the generating angle ends[0] to ends[1].

    `contact` gives K (n, 2), dK/dpsi (n, 2), the angle of n and its derivative (n,).
    """
    first, span = ends[0], ends[1] - ends[0]

    def local(t: Floats) -> CurvePoints:
        psi = first + span * t
        k, dk, normal, dnormal = contact(psi)
        arm = k + (0.0, cut.r_pitch)
        point = rotated(arm, psi)
        # velocity in the gear's frame, in components of the fixed one: dK + the rotation of the arm
        velocity = dk + np.stack((-arm[:, 1], arm[:, 0]), axis=-1)
        angle = normal - cut.sign * 0.5 * np.pi
        speed = span * (velocity[:, 0] * np.cos(angle) + velocity[:, 1] * np.sin(angle))
        return CurvePoints(point, angle + psi, speed, span * (dnormal + 1.0))

    return CurvedSegment(name, local)


def involute(cut: Cutter, name: str = "profile") -> ToothProfile:
    """Build the flank: involute from the addendum circle, fillet down to the dedendum circle.

    name : section of the design file, for messages. Raises InputError where there is no flank.
    """
    _check_sizes(cut, name)
    s, alpha, r_b, rho = cut.sign, cut.pressure_angle, cut.r_base, cut.tip_radius
    w_tip = cut.contact_distance(cut.r_tip_circle)
    if not cut.external:
        _check_shaper(cut, w_tip, name)
    first, last, center = (_rack_tip if cut.external else _shaper_tip)(cut, name)
    normal = np.array([np.cos(alpha), s * np.sin(alpha)])
    c = center(np.array([first]))[0][0]
    w_form = -float(np.hypot(*c)) - rho
    if r_b * np.tan(alpha) + s * w_form <= 0.0:
        raise InputError(
            f"{name}.cutter_radius = {rho:g} undercuts the teeth: allowed are a larger radius, "
            f"more teeth or a larger "
            "profile.shift, so that the involute begins above its base circle"
        )

    def flank(psi: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        k = (r_b * (psi + cut.half_thickness))[:, None] * normal
        dk, angle = np.broadcast_to(r_b * normal, k.shape), np.full_like(psi, s * alpha)
        return k, dk, angle, np.zeros_like(psi)

    def fillet(psi: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        c, dc = center(psi)
        reach = np.hypot(c[:, 0], c[:, 1])
        rate = (c[:, 0] * dc[:, 1] - c[:, 1] * dc[:, 0]) / reach**2
        across = np.stack((-c[:, 1], c[:, 0]), axis=-1) / reach[:, None]
        k = c * (1.0 + rho / reach)[:, None]
        return k, dc + (rho * rate)[:, None] * across, np.arctan2(-c[:, 1], -c[:, 0]), rate

    ends = w_tip / r_b - cut.half_thickness, w_form / r_b - cut.half_thickness
    segments = _curve(cut, "involute", ends, flank), _curve(cut, "fillet", (first, last), fillet)
    profile = ToothProfile(segments, cut.external, cut.r_tip_circle, cut.r_root_circle, cut.n_teeth)
    if not cut.external:
        _check_trimming(cut, profile, center, name)
    return profile


def _check_sizes(cut: Cutter, name: str) -> None:
    """The base circle must lie inside the teeth, and the pitch circle must cross them."""
    inside = f"lies inside the addendum circle ({cut.r_tip_circle:.6g} mm)"
    allowed = f"are angles whose base circle ({cut.r_base:.6g} mm) {inside}"
    angle = np.degrees(cut.pressure_angle)
    require(cut.r_tip_circle > cut.r_base, f"{name}.pressure_angle", angle, allowed)
    low, high = sorted(
        (-cut.sign * cut.addendum / cut.module, cut.sign * cut.dedendum / cut.module)
    )
    fits = cut.depth > 0.0 and cut.addendum + cut.sign * cut.shift * cut.module > 0.0
    where = "where the pitch circle crosses the teeth"
    allowed = f"above {low:g} to below {high:g} modules, {where}"
    require(fits, f"{name}.shift", cut.shift, allowed)


def _check_shaper(cut: Cutter, w_tip: float, name: str) -> None:
    """The shaper's involute must exist where it cuts the ring's tips: above its base circle."""
    least = int(np.ceil(2.0 * w_tip / (cut.module * np.sin(cut.pressure_angle)) + 1e-9))
    why = "an involute down to the ring's tips, and a shaper smaller than the ring"
    fits = least <= cut.cutter_teeth < cut.n_teeth
    allowed = f"{least} to {cut.n_teeth - 1} ({why})"
    require(fits, f"{name}.cutter_teeth", cut.cutter_teeth, allowed)


def _check_trimming(cut: Cutter, profile: ToothProfile, center: Center, name: str) -> None:
    """The shaper's tips must pass the ring's tips without cutting them on their way in and out."""
    psi = np.linspace(-np.pi, np.pi, 7201) * cut.cutter_teeth / cut.n_teeth
    x, y = rotated(center(psi)[0] + (0.0, cut.r_pitch), psi).T
    reach = np.hypot(x, y)
    near = (reach > cut.r_tip_circle - cut.tip_radius) & (
        np.abs(np.arctan2(x, y)) < np.pi / cut.n_teeth
    )
    points = np.stack((np.abs(x), y), axis=-1)[near]
    # short of the addendum circle only the edge of the top land can be met
    to_edge = np.linalg.norm(points - profile.point(0.0), axis=1)
    clear = np.where(reach[near] > cut.r_tip_circle, profile.distance(points)[0], to_edge)
    passes = clear.min(initial=np.inf) >= cut.tip_radius - 1e-6 * cut.module
    allowed = "are fewer teeth, so that the shaper does not trim the tips of the ring's teeth"
    require(passes, f"{name}.cutter_teeth", cut.cutter_teeth, allowed)

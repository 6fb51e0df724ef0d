"""The shape of the bent flexible spline on the cam.

A thin ring bends without stretching. Its shape on the cam, or on the balls of a bearing, is the one
with the least bending energy that does not enter them (`swgpar.geometry.bent_ring`). A cup adds
Love's inextensional modes, which grow linearly from the closed end and move the wall axially.
"""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.geometry.bent_ring import bent_ring, ring_on_points
from swgpar.geometry.rotation import rotated

NEAR = 0.003
"""Gap below which the inner surface is laid on the cam, over half of the deflection: wider gaps
stay open."""

PENETRATION = 1e-5
"""Depth over the module to which it is laid into cam or race, so that the contact acts at once."""

BALL_APPROACH = 1e-3
"""Approach of the balls, over their diameter, to which an outer race is laid: of the order of that
under load."""

BORE_POINTS = 1440
"""Points of the bent bore between which the race follows it."""


class BentSpline:
    """The bent flexible spline as a field of displacements, on the cam or on the balls with their
    race.

    shape : of the ring
    missed : material angles (n,) rad and heights (n,) mm by which the shape lies below the balls
    """

    def __init__(self, design: DriveDesign) -> None:
        self.design = design
        self.inset = PENETRATION * design.drive.module
        self.radius = design.inner_radius + 0.5 * design.flexible_spline.rim
        around = design.inner_radius, self.radius, design.wave_generator.lobes
        self.missed = np.zeros(1), np.zeros(1)
        self.half = 0.5 * design.wave_generator.width
        self.end = design.cup_sizes.rest_plane if design.has_cup else 0.5 * design.drive.face_width
        self.surface = design.grown_cam_surface()
        if design.bearing is None:
            self.shape = bent_ring(design.cam(), *around)
        else:
            balls = _over_balls(design)
            self.shape = ring_on_points(balls, *around, shifts=not design.has_cup)
            self.missed = self._missed_over(balls)

    def bore(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Material angles (n,) rad of the bore at mid-width, angles and distances, mm, from the
        axis."""
        theta = np.linspace(-np.pi, np.pi, BORE_POINTS, endpoint=False)
        inside = np.full_like(theta, self.design.inner_radius)
        x, y, _ = self.section(theta, inside, np.zeros_like(theta)).T
        return theta, np.arctan2(-x, y), np.hypot(x, y)

    def _missed_over(self, balls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `missed`: many balls lie closer to each other than the shape's shortest wave follows.

        balls : (n, 2) mm, points over them
        """
        theta, place, distance = self.bore()
        around = np.angle(np.exp(1j * (place - theta)))
        at = np.arctan2(-balls[:, 0], balls[:, 1])
        gap = np.interp(at, place, distance, period=2.0 * np.pi) - np.hypot(*balls.T)
        material = at - np.interp(at, place, around, period=2.0 * np.pi)
        return material, np.maximum(-gap, 0.0)

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) mm of points (n, 3) mm of the undeformed spline."""
        x, y, z = points.T
        radius, theta = np.hypot(x, y), np.arctan2(-x, y)
        within = np.clip(z, -self.half, self.half)
        share, on_cam = self._share(z), self._share(within)
        gap, near = self._gap(theta, within), NEAR * 0.5 * self.design.deflection
        lift = np.where(gap < near, -gap - self.inset, 0.0)
        moved = self.section(theta, radius, z) - points
        moved[:, :2] += (lift * share / on_cam)[:, None] * np.column_stack(
            [-np.sin(theta), np.cos(theta)]
        )
        if self.design.has_cup:
            moved[:, 2] = self._axial(theta, radius)
            plate = self._on_plate(radius, z)
            moved[plate] = self._closed_end(theta[plate], radius[plate], z[plate])
        return moved

    def _gap(self, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Gap (n,) mm of bent sections to what they are laid on: the cam, or the race, which does
        not lean along with the wall."""
        if self.design.bearing is not None:
            return (self._share(z) - 1.0) * self._waves(theta)[0]
        bore = self.section(theta, np.full_like(theta, self.design.inner_radius), z)
        gap, *_ = self.surface.evaluate(bore)
        return gap

    def _share(self, z: np.ndarray) -> np.ndarray:
        """Deflection at z (n,) mm over that at mid-width."""
        if self.design.drive.model != "cup":
            return np.ones_like(z)
        return np.clip((self.end - z) / self.end, 0.0, None)

    def section(self, theta: np.ndarray, radius: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Positions (n, 3) mm of points of bent sections, which stay normal to the middle line."""
        outward, around, slope = self._waves(theta)
        share, height = self._share(z), radius - self.radius
        lean = share * (around - slope) / self.radius
        # in the radial and the circumferential direction, the latter counter-clockwise
        along = self.radius + share * outward + height * np.cos(lean)
        across = share * around + height * np.sin(lean)
        return rotated(np.column_stack([-across, along, z]), theta)

    def _waves(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Radial and circumferential displacement (n,) mm at mid-width, slope of the first."""
        outward = np.interp(theta, *self.missed, period=2.0 * np.pi)
        around, slope = np.zeros_like(theta), np.zeros_like(theta)
        for order, amplitude in zip(self.shape.orders, self.shape.amplitudes):
            wave = amplitude * np.exp(1j * order * theta)
            outward += wave.real
            if order:
                around -= wave.imag / order
                slope -= wave.imag * order
        return outward, around, slope

    def _axial(self, theta: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Axial displacement (n,) mm of the wall by Love's modes and its lean."""
        outward, _, _ = self._waves(theta)
        moved = (radius - self.radius) * outward
        for order, amplitude in zip(self.shape.orders[1:], self.shape.amplitudes[1:]):
            moved += self.radius / order**2 * (amplitude * np.exp(1j * order * theta)).real
        return moved / self.end

    def _on_plate(self, radius: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Which points (n,) belong to the closed end or flange, with most of the fillet."""
        wall, margin = self.design.cup_sizes.wall, 0.5 * self.design.flexible_spline.rim
        if wall.outwards:
            beyond = radius > wall.outer.points[-1, 1] + margin
        else:
            beyond = radius < wall.inner.points[-1, 1] - margin
        return beyond & ((z > wall.back + wall.length) | wall.is_on_plate(radius, z))

    def _closed_end(self, theta: np.ndarray, radius: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) mm of the closed end or flange, a plate that bends with the wall."""
        deflection, slope, around = (np.zeros_like(radius) for _ in range(3))
        for order, amplitude in zip(self.shape.orders[1:], self.shape.amplitudes[1:]):
            wave = amplitude * np.exp(1j * order * theta) / self.end
            power, terms = self._plate(order)
            shape = self.radius * (radius / self.radius)[:, None] ** power @ terms
            deflection += shape * wave.real
            slope += (radius / self.radius)[:, None] ** (power - 1.0) @ (power * terms) * wave.real
            around -= order * shape / radius * wave.imag
        if self.design.cup.attachment == "clamped":
            held = self.design.cup.is_attached(
                np.column_stack([-radius * np.sin(theta), radius * np.cos(theta)])
            )
            deflection[held] = slope[held] = around[held] = 0.0
        height = self.end - z
        return rotated(np.column_stack([-height * around, height * slope, deflection]), theta)

    def _plate(self, order: float) -> tuple[np.ndarray, np.ndarray]:
        """Powers (4,) of the radius and factors (4,) in the deflection of a plate by such waves.

        They solve the biharmonic equation. The bore, or the rim of a flange, is free; with a
        clamped ring the plate ends there and neither deflects nor leans. The other edge has the
        wall's deflection and lean.
        """
        cup = self.design.cup
        edge = (cup.clamping_radius or cup.edge) / self.radius
        nu = self.design.materials["flexible_spline"].poisson
        power = np.array([order, -order, order + 2.0, 2.0 - order])

        def derivative(at: float, times: int) -> np.ndarray:
            return np.prod([power - k for k in range(times)], axis=0) * at ** (power - times)

        value, slope, bend, third = (derivative(edge, times) for times in range(4))
        moment = bend + nu * (slope / edge - order**2 * value / edge**2)
        laplacian_slope = third + bend / edge - slope / edge**2
        laplacian_slope -= order**2 * (slope / edge**2 - 2.0 * value / edge**3)
        shear = laplacian_slope - (1.0 - nu) * order**2 / edge * (slope / edge - value / edge**2)
        at_edge = [moment, shear] if cup.clamping_radius is None else [value, slope]
        conditions = [derivative(1.0, 0), derivative(1.0, 1), *at_edge]
        return power, np.linalg.solve(conditions, [1.0 / order**2, 1.0, 0.0, 0.0])


class BentRace:
    """The outer race of a bearing on its balls, inside of the flexible spline around it."""

    def __init__(self, design: DriveDesign) -> None:
        spline = BentSpline(design)
        _, place, distance = spline.bore()
        self.bore = place, distance - spline.inset
        self.design, self.spline = design, spline
        spline.radius = design.inner_radius - 0.5 * design.bearing.race_thickness

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) mm of points (n, 3) mm of the undeformed race."""
        x, y, z = points.T
        radius, theta = np.hypot(x, y), np.arctan2(-x, y)
        middle = np.zeros_like(z)
        outside = np.full_like(theta, self.design.inner_radius)
        surface = self.spline.section(theta, outside, middle)[:, :2]
        distance = np.hypot(*surface.T)
        place = np.arctan2(-surface[:, 0], surface[:, 1])
        bore = np.interp(place, *self.bore, period=2.0 * np.pi)
        moved = self.spline.section(theta, radius, middle)
        moved[:, :2] += (bore / distance - 1.0)[:, None] * surface
        moved[:, 2] = z
        return moved - points


def _over_balls(design: DriveDesign) -> np.ndarray:
    """Points (n, 2) mm over the balls, on the outside of a race that they have approached."""
    bearing = design.bearing
    angle = np.radians(bearing.first_ball) + 2.0 * np.pi / bearing.balls * np.arange(bearing.balls)
    centre, normal, _ = design.grown_ball_lines()(angle)
    above = (0.5 - BALL_APPROACH) * bearing.ball_diameter - design.ball_clearance
    return centre + (above + bearing.race_thickness) * normal


def bent_bodies(design: DriveDesign) -> dict[str, BentSpline | BentRace]:
    """What is bent, by body: the flexible spline on the unturned cam, or on its bearing with the
    outer race."""
    bent: dict[str, BentSpline | BentRace] = {FLEXIBLE_SPLINE: BentSpline(design)}
    return bent if design.bearing is None else bent | {OUTER_RACE: BentRace(design)}

"""The shape of the bent flexible spline on the cam.

A thin ring bends without stretching. Its shape on the cam is the one with the least bending energy
that does not enter the cam. A cup adds Love's inextensional modes, which grow linearly from the
closed end and move the wall axially.
"""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.geometry.neutral_line import bent_ring
from swgpar.geometry.rotation import rotated

NEAR = 0.003
"""Gap below which the inner surface is laid on the cam, over half of the deflection: wider gaps
stay open."""

PENETRATION = 1e-5
"""Depth over the module to which it is laid into the cam, so that the contact acts at once."""

BALL_APPROACH = 1e-3
"""Approach of the balls, over their diameter, to which an outer race is laid: of the order of that
under load."""


class BentSpline:
    """The bent flexible spline as a field of displacements.

    inset : mm, by which its inner surface lies inside of the cam's; without it that of contact
    """

    def __init__(self, design: DriveDesign, inset: float | None = None) -> None:
        self.design = design
        self.inset = PENETRATION * design.drive.module if inset is None else inset
        self.radius = design.inner_radius + 0.5 * design.flexible_spline.rim
        self.amplitudes = bent_ring(
            design.cam(), design.inner_radius, self.radius, design.wave_generator.lobes
        )
        self.order = float(design.wave_generator.lobes) * np.arange(len(self.amplitudes))
        self.half = 0.5 * design.wave_generator.width
        self.end = design.cup_sizes.rest_plane if design.has_cup else 0.5 * design.drive.face_width
        self.surface = design.grown_cam_surface()

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) mm of points (n, 3) mm of the undeformed spline."""
        x, y, z = points.T
        radius, theta = np.hypot(x, y), np.arctan2(-x, y)
        within = np.clip(z, -self.half, self.half)
        share, on_cam = self._share(z), self._share(within)
        gap, *_ = self.surface.evaluate(
            self.section(theta, np.full_like(theta, self.design.inner_radius), within)
        )
        near = NEAR * 0.5 * self.design.deflection
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
        outward, around, slope = (np.zeros_like(theta) for _ in range(3))
        for amplitude, order in zip(self.amplitudes, self.order):
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
        for amplitude, order in zip(self.amplitudes[1:], self.order[1:]):
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
        for amplitude, order in zip(self.amplitudes[1:], self.order[1:]):
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
    """The outer race of a bearing, bent along with the flexible spline around it.

    inset : mm, by which its outer surface lies inside of the cam's
    """

    def __init__(self, design: DriveDesign, inset: float) -> None:
        self.spline, self.inset = BentSpline(design, inset), inset
        self.spline.radius = design.inner_radius - 0.5 * design.bearing.race_thickness

    def displacement(self, points: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) mm of points (n, 3) mm of the undeformed race."""
        spline, (x, y, z) = self.spline, points.T
        radius, theta = np.hypot(x, y), np.arctan2(-x, y)
        surface = spline.section(theta, np.full_like(theta, spline.design.inner_radius), z)
        gap, normal, _ = spline.surface.evaluate(surface)
        moved = spline.section(theta, radius, z) - points
        return moved - (gap + self.inset)[:, None] * normal * (1.0, 1.0, 0.0)


def bent_bodies(design: DriveDesign) -> dict[str, BentSpline | BentRace]:
    """What is bent, by body: the flexible spline on the unturned cam, or on its bearing with the
    outer race."""
    bearing = design.bearing
    if bearing is None:
        return {FLEXIBLE_SPLINE: BentSpline(design)}
    inset = bearing.clearance + BALL_APPROACH * bearing.ball_diameter
    return {
        OUTER_RACE: BentRace(design, inset),
        FLEXIBLE_SPLINE: BentSpline(design, inset + PENETRATION * design.drive.module),
    }

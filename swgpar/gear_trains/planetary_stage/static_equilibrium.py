"""Static equilibrium of planetary stages with errors, many at once, for a place of the carrier.

Unknowns are the coordinates of sun, planets and carrier, and the displacements w of the ring in the
directions of its mesh forces, which the stiffness C⁻¹ holds: C is the flexibility of the ring on
its supports at the meshes. Meshes have backlash, bearings of planets have clearance. The potential
energy is convex, and Newton's method with a line search goes down to its minimum from any start.
What nothing holds, such as an unloaded planet within its clearance, stays where it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.planetary_parts.model import (
    SUN,
    PlanetaryModel,
    base_radii,
    bearing_rows,
    carrier_index,
    fixed_deflection_rows,
    planet_index,
    ring_index,
)
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.gear_trains.planetary_stage.errors import LOADED, MeshErrors, StageErrors
from swgpar.vibration.backlash import force

TOLERANCE, MAX_ITERATIONS, MAX_HALVINGS = 1e-9, 100, 40
"""Largest residual over the forces of the load; limits of Newton's method and its line search."""

HELD = 1e-9
"""Part of the largest stiffness that holds what nothing else holds, in each iteration anew."""


@dataclass(frozen=True)
class Equilibrium:
    """Some trains at rest.

    displacements : (trains, unknowns) m
    mesh : (trains, m) N, forces of the meshes, positive on the loaded flank
    bearing : (trains, planets, 2) N, forces of the carrier on the planets, outward and along
    """

    displacements: np.ndarray
    mesh: np.ndarray
    bearing: np.ndarray


@dataclass(frozen=True)
class _Place:
    """What holds and loads the trains at a place of the carrier.

    springs : (unknowns, unknowns) N/m, without meshes and bearings of planets
    load : (unknowns,) N;  mesh : (m,) N/m;  added : (trains, m) m, by errors
    """

    springs: np.ndarray
    load: np.ndarray
    mesh: np.ndarray
    added: np.ndarray


class StaticStage:
    """Trains with given errors under the load of a design."""

    def __init__(
        self, train: PlanetaryModel, design: PlanetaryStageDesign, errors: StageErrors
    ) -> None:
        self.train, self.design, self.errors = train, design, MeshErrors(train, design, errors)
        self.count, self.bearing = design.planet.count, design.planet.bearing
        self.first_of_ring = carrier_index(design) + 3
        self.size = self.first_of_ring + self.count
        self.rows = fixed_deflection_rows(design, self.size)
        self.rows[self.count :, self.first_of_ring :] = np.eye(self.count)
        self.bearings = bearing_rows(design, self.size)
        self.pin, self.clearance = errors.pin, 1e-6 * design.planet.clearance
        first = ring_index(design)
        self.ring_flexibility = np.linalg.inv(train.constant[first:, first:])
        self.last = self._without_gaps()

    def at(self, t: float) -> Equilibrium:
        """Equilibrium at a time in s, sought from that of the last call.

        Raises ConvergenceError.
        """
        place = self._place(t)
        scale = np.abs(place.load).max()
        z = np.broadcast_to(self.last, (len(place.added), self.size)).copy()
        for _ in range(MAX_ITERATIONS):
            residual, tangent = self._residual(z, place)
            going = np.abs(residual).max(axis=1) > TOLERANCE * scale
            if not going.any():
                break
            largest = np.abs(np.diagonal(tangent, axis1=1, axis2=2)).max()
            tangent = tangent[going] + HELD * largest * np.eye(self.size)
            step = np.zeros_like(z)
            step[going] = np.linalg.solve(tangent, -residual[going, :, None])[..., 0]
            z += self._part(z, step, place)[:, None] * step
        else:
            angle = np.degrees(self.design.carrier.speed * t)
            raise ConvergenceError(
                f"the equilibrium of the planetary stage did not converge at {angle:g} deg"
            )
        self.last = z
        forces, bearing, _ = self._forces(z, place)
        return Equilibrium(z, LOADED * forces, -bearing)

    def _place(self, t: float) -> _Place:
        mesh, added = self.train.mesh.at(t), self.errors.at(t)
        return _Place(self._springs(t), self._load(t), mesh, added)

    def _springs(self, t: float) -> np.ndarray:
        design, k = self.design, np.zeros((self.size, self.size))
        carrier, radius = carrier_index(design), base_radii(design)[0]
        k[SUN, SUN] = k[SUN + 1, SUN + 1] = design.sun.bearing
        k[SUN + 2, SUN + 2] = design.sun.torsional / radius**2
        k[carrier, carrier] = k[carrier + 1, carrier + 1] = design.carrier.bearing
        first = self.first_of_ring
        k[first:, first:] = np.linalg.inv(self._flexibility(t))
        return k

    def _flexibility(self, t: float) -> np.ndarray:
        """Displacement (planets, planets) of the ring at the meshes per force there, m/N."""
        train, design = self.train, self.design
        rows = train.deflection_rows(t)[self.count :, ring_index(design) :]
        within = train.local_flexibility(np.array([t]))[0] @ train.on_ring
        return rows @ self.ring_flexibility @ rows.T + np.diag(within)

    def _load(self, t: float) -> np.ndarray:
        """Forces of torque and gravity; the ring's own weight is left out."""
        design, load = self.design, np.zeros(self.size)
        carrier = carrier_index(design)
        angle = np.radians(design.load.down) - design.carrier.speed * t

        def weight(mass: float, turned: float) -> np.ndarray:
            return mass * design.load.gravity * np.array([np.cos(turned), np.sin(turned)])

        load[SUN : SUN + 2] = weight(design.sun.mass, angle)
        load[carrier : carrier + 2] = weight(design.carrier.mass, angle)
        load[carrier + 2] = design.load.torque / base_radii(design)[2]
        for k, psi in enumerate(design.angles):
            first = planet_index(k)
            load[first : first + 2] = weight(design.planet.mass, angle - psi)
        return load

    def _without_gaps(self) -> np.ndarray:
        """Equilibrium (unknowns,) at the start without errors and clearance, all meshes in contact
        on their loaded flanks: a first guess."""
        place = self._place(0.0)
        stiff = place.springs + self.rows.T @ (place.mesh[:, None] * self.rows)
        for rows in self.bearings:
            stiff += self.bearing * rows.T @ rows
        closed = self.rows.T @ (place.mesh * LOADED * self.train.half_backlash)
        return np.linalg.lstsq(stiff, place.load + closed, rcond=None)[0]

    def _forces(self, z: np.ndarray, place: _Place) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces (trains, m) of meshes and (trains, planets, 2) of bearings at displacements, and
        the deflections of the bearings."""
        meshes = force(place.mesh, z @ self.rows.T + place.added, self.train.half_backlash)
        stretch = np.einsum("kin,sn->ski", self.bearings, z) - self.pin
        length = np.linalg.norm(stretch, axis=2, keepdims=True)
        over = np.maximum(length - self.clearance, 0.0)
        unit = np.divide(stretch, length, out=np.zeros_like(stretch), where=length > 0.0)
        return meshes, self.bearing * over * unit, stretch

    def _residual(self, z: np.ndarray, place: _Place) -> tuple[np.ndarray, np.ndarray]:
        """Residual (trains, unknowns) N and tangent (trains, unknowns, unknowns) N/m."""
        meshes, bearing, stretch = self._forces(z, place)
        residual = z @ place.springs + meshes @ self.rows - place.load
        residual += np.einsum("kin,ski->sn", self.bearings, bearing)
        touching = (meshes != 0.0) * place.mesh
        of_meshes = np.einsum("mi,sm,mj->sij", self.rows, touching, self.rows, optimize=True)
        held = self.bearing * self._direction_stiffness(stretch)
        of_bearings = np.einsum(
            "kin,skij,kjm->snm", self.bearings, held, self.bearings, optimize=True
        )
        return residual, place.springs + of_meshes + of_bearings

    def _direction_stiffness(self, stretch: np.ndarray) -> np.ndarray:
        """Tangent (trains, planets, 2, 2) of bearings of unit stiffness at their deflections."""
        if self.clearance == 0.0:
            return np.broadcast_to(np.eye(2), (*stretch.shape, 2))
        length = np.linalg.norm(stretch, axis=2)[..., None, None]
        beyond = length > self.clearance
        along = stretch[..., :, None] * stretch[..., None, :]
        along = np.divide(along, length**2, out=np.zeros_like(along), where=beyond)
        across = np.divide(length - self.clearance, length, out=np.zeros_like(length), where=beyond)
        return beyond * (along + across * (np.eye(2) - along))

    def _energy(self, z: np.ndarray, place: _Place) -> tuple[np.ndarray, np.ndarray]:
        """Potential energy (trains,) and the sum of the sizes of its parts, N·m."""
        meshes, bearing, _ = self._forces(z, place)
        held = 0.5 * ((z @ place.springs) * z).sum(axis=1)
        held += 0.5 * (meshes**2 / place.mesh).sum(axis=1)
        held += 0.5 * (bearing**2).sum(axis=(1, 2)) / self.bearing
        return held - z @ place.load, held + np.abs(z) @ np.abs(place.load)

    def _part(self, z: np.ndarray, step: np.ndarray, place: _Place) -> np.ndarray:
        """Part (trains,) of the step that lowers the energy of each train, to round-off."""
        part, (before, size) = np.ones(len(z)), self._energy(z, place)
        for _ in range(MAX_HALVINGS):
            after, _ = self._energy(z + part[:, None] * step, place)
            worse = after > before + 1e-13 * size
            if not worse.any():
                break
            part[worse] *= 0.5
        return part

"""A smooth solid ring in the plane, by this program's elements: waves of it beside curved beams."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import coo_matrix, eye, kron

from support.element_mesh import ElementMesh
from swgpar.materials.isotropic import Isotropic
from swgpar.vibration.curved_beam import BeamSection


class SolidRing:
    """Plane stress, centre line of radius 1 m, width 1 m, density 1 kg/m³, E in Pa.

    Displacements with n waves are u cos(n a) outward and w sin(n a) along, with u and w of each of
    the `layers` + 1 circles of nodes.
    """

    E, NU = 210e9, 0.3

    def __init__(self, thickness: float, around: int = 480, layers: int = 10) -> None:
        self.layers, self.angle = layers, 2.0 * np.pi * np.arange(around) / around
        self.radius = 1.0 + thickness * np.linspace(-0.5, 0.5, layers + 1)
        self.section = BeamSection.rectangle(self.E, self.NU, 1.0, 1.0, thickness, 1.0)
        r, a = np.meshgrid(self.radius, self.angle)
        points = np.stack([r * np.cos(a), r * np.sin(a), 0.0 * r], axis=-1).reshape(-1, 3)
        self.number = np.arange(len(points)).reshape(r.shape)
        here, ahead = self.number, np.roll(self.number, -1, axis=0)
        quads = np.stack([here[:, :-1], here[:, 1:], ahead[:, 1:], ahead[:, :-1]], axis=-1)
        quads = quads.reshape(-1, 4)
        mesh = ElementMesh(points, quads, Isotropic(E=self.E, nu=self.NU))
        plane = np.flatnonzero(np.arange(3 * len(points)) % 3 < 2)
        self.stiffness = mesh.tangent(np.zeros_like(points)).tocsc()[plane][:, plane]
        corner, mass = points[quads][:, :, :2], np.zeros((len(quads), 4, 4))
        for x, y in itertools.product((-(3.0**-0.5), 3.0**-0.5), repeat=2):
            shape = 0.25 * np.array(
                [(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)]
            )
            slope = 0.25 * np.array([[y - 1, 1 - y, 1 + y, -1 - y], [x - 1, -1 - x, 1 + x, 1 - x]])
            area = np.abs(np.linalg.det(slope @ corner))
            mass += area[:, None, None] * np.outer(shape, shape)
        i, j = np.repeat(quads, 4, axis=1).ravel(), np.tile(quads, (1, 4)).ravel()
        scalar = coo_matrix((mass.ravel(), (i, j)), shape=2 * (len(points),))
        self.mass = kron(scalar, eye(2)).tocsc()

    def wave(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness and mass of u and w of all circles, (2 layers + 2, 2 layers + 2), N/m and
        kg."""
        circles, basis = self.layers + 1, np.zeros((self.mass.shape[0], 2 * self.layers + 2))
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        u, w = np.cos(n * self.angle), np.sin(n * self.angle)
        for k, nodes in enumerate(self.number.T):
            basis[2 * nodes, k], basis[2 * nodes + 1, k] = u * cosine, u * sine
            basis[2 * nodes, circles + k] = -w * sine
            basis[2 * nodes + 1, circles + k] = w * cosine
        return basis.T @ (self.stiffness @ basis), basis.T @ (self.mass @ basis)

    def frequency(self, n: int) -> float:
        """Lowest natural frequency with n waves, rad/s."""
        return float(np.sqrt(eigh(*self.wave(n), eigvals_only=True)[0]))

    def flexibility(self, n: int, at_bore: bool) -> np.ndarray:
        """(2, 2): u and w per force of n waves along each, in the mean of the section or at the
        bore."""
        weights = np.zeros(self.layers + 1)
        weights[0] = 1.0
        if not at_bore:
            weights = np.full(self.layers + 1, 1.0 / self.layers)
            weights[[0, -1]] *= 0.5
        picked = np.kron(np.eye(2), weights).T
        return np.asarray(picked.T @ np.linalg.solve(self.wave(n)[0], picked))


def beam_flexibility(section: BeamSection, n: int, at: float) -> np.ndarray:
    """The same of a curved beam, at the distance `at` (m) outside its centre line."""
    r = section.radius
    stretch = np.array([1.0, n, 0.0]) / r
    bend, shear = (stretch - [0.0, 0.0, n]) / r, np.array([-n / r, -1.0 / r, 1.0])
    parts = (
        (section.E * section.area, stretch),
        (section.E * section.bending, bend),
        (section.shear, shear),
    )
    stiffness = np.pi * r * sum(k * np.outer(e, e) for k, e in parts)
    rows = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, at]])
    return np.asarray(rows @ np.linalg.solve(stiffness, rows.T))

"""
Ring on a cam, beside theory
============================

A smooth elastic ring on a rigid surface, computed by the elements, the contact and the solver
of the drive. Thin-ring theory gives its stress on an elliptical cam and its shape between two
supports.
"""

# ranks: 1 2

import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI
from plain_ring import PlainRingDesign, RingCounts, RingModel

from swgpar.geometry.cams import EllipticalCam, taut_length
from swgpar.geometry.cams.simplified import simplified
from swgpar.materials import Isotropic

STEEL = Isotropic(E=210e3, nu=0.29)
COUNTS = RingCounts(sectors=60, radial=2, axial=1)

# %%
# A ring of inner radius r = 58.2 mm on an ellipse with the semi-axes r ± 1 mm. Its curvature at
# the major axis grows from 1 / r to a / b². Bending of a ring of thickness t then has the stress
# E (t / 2) (a / b² - 1 / r) at its outer surface. The ellipse is longer than the circle, which
# adds a mean tension.

inner_radius = 58.2
cam = EllipticalCam(inner_radius + 1.0, inner_radius - 1.0)
thicknesses = [0.5, 1.0, 1.5, 2.0]
computed = []
for thickness in thicknesses:
    ring = PlainRingDesign(2.0 * (inner_radius + thickness), thickness, 10.0, True, STEEL)
    model = RingModel(ring, COUNTS, cam, np.radians(15.0), MPI.COMM_WORLD)
    model.mount()
    computed.append(model.stresses()["s1"])
    model.destroy()

t = np.array(thicknesses)
bending = STEEL.E * 0.5 * t * (cam.a / cam.b**2 - 1.0 / inner_radius)
tension = STEEL.E * (taut_length(cam) / (2.0 * np.pi * inner_radius) - 1.0)
for row in zip(t, computed, bending + tension):
    print("t = {:.1f} mm   s1 {:6.1f} MPa   thin ring {:6.1f} MPa".format(*row))

figure, axes = plt.subplots(figsize=(6.5, 3.8), layout="constrained")
axes.plot(t, computed, "o", label="computed, plane stress")
axes.plot(t, bending + tension, "--", label="thin ring, bending and tension")
axes.plot(t, bending, ":", label="thin ring, bending")
axes.set(xlabel="thickness (mm)", ylabel="largest s1 (MPa)", xlim=(0.0, 2.2), ylim=(0.0, None))
axes.legend()

# %%
# A ring between two round supports that move apart by a small distance. Two opposite forces P
# deflect a thin ring outwards by
# P R³ / (E I) (((π/2 - θ) cos θ + sin θ) / 4 - 1/π), θ from the forces.

ring = PlainRingDesign(outer_diameter=136.0, thickness=4.5, width=10.0, plane=True, material=STEEL)
model = RingModel(
    ring,
    RingCounts(120, 2, 1),
    simplified(ring.inner_radius, 32.5),
    np.radians(20.0),
    MPI.COMM_WORLD,
)
travel = 0.001
model.spread(travel)
angles = np.radians(np.arange(0.0, 91.0, 7.5))
outward = np.array([-model.dial(angle) for angle in angles]) / travel
model.destroy()

shape = 0.25 * ((0.5 * np.pi - angles) * np.cos(angles) + np.sin(angles)) - 1.0 / np.pi
figure, axes = plt.subplots(figsize=(6.5, 3.8), layout="constrained")
axes.plot(np.degrees(angles), outward, "o", label="computed, plane stress")
axes.plot(np.degrees(angles), shape / shape[0], "--", label="thin ring, two forces")
axes.axhline(0.0, color="0.6", linewidth=0.8)
axes.set(
    xlabel="angle from the supports (deg)",
    ylabel="outward displacement / travel",
    xticks=np.arange(0, 91, 15),
)
axes.legend()
plt.show()

"""
Three lobes
===========

A drive of 120 and 123 teeth meshes at three places. Its ratio is -40, where two lobes and a
difference of two teeth would give -60. A third of it is modelled.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(DRIVERS / "three_lobes.toml")
print(f"ratio {design.kinematics.ratio:g}, radial deflection {0.5 * design.deflection:g} mm")

# %%
# The cam is as long as the inner circumference of the spline. The figure shows how far it lies
# outside or inside of that circle.

outline = design.cam().outline(720)
angle = np.degrees(np.unwrap(np.arctan2(-outline[:, 0], outline[:, 1])))
figure, axes = plt.subplots(layout="constrained")
axes.plot(angle, np.hypot(*outline.T) - design.inner_radius)
axes.set(xlabel="angle from the major axis (degrees)", ylabel="radius less that of the spline (mm)")
plt.show()

# %%
# The run takes one period. The stress wave passes every tooth three times per turn.

short = design.with_values({"steps.rotation": 3.0, "output.root_stress": False})
result = swgpar.run(short, mesh="plane_coarse")
print(f"the model is one of {result.summary.copies} equal parts of the drive")
result.plot.stress()
plt.show()

# %%
# The deformed drive, all three parts of it.

grid = result.grid(whole=True).warp_by_vector("displacement")
points = grid.points[:, :2]
figure, axes = plt.subplots(figsize=(6.0, 6.0), layout="constrained")
image = axes.scatter(*points.T, c=grid.point_data["vm"], s=0.5, cmap="turbo")
figure.colorbar(image, label="von Mises (MPa)", shrink=0.8)
axes.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
plt.show()

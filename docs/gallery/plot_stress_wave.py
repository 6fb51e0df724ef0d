"""
Stress wave around the spline
=============================

The cam bends the rim of the flexible spline into an oval. A point of the rim passes two lobes
per revolution of the cam. This script draws the stress on the inner surface over the angle
from the major axis.
"""

# ranks: 1 2

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(DRIVERS / "plane_half_turn.toml", {"steps.rotation": 0.0})
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 2, "rim": 2}
result = swgpar.run(design, mesh={"flexible_spline": gear, "ring_gear": gear})

# %%
# The points of the inner surface, and the angle of each from the major axis, which is +y. The
# plane model is one layer of elements: one of its two faces is enough.

points, _ = result.mesh("flexible_spline")
radius = np.hypot(points[:, 0], points[:, 1])
inner = np.isclose(radius, radius.min()) & np.isclose(points[:, 2], points[:, 2].min())
angle = np.degrees(np.arctan2(points[inner, 0], points[inner, 1]))
order = np.argsort(angle)

# %%
# The hoop stress is the component along the tangent t of the deformed surface: t · σ t. The
# rotation of the rim is small enough to take the undeformed tangent.

xx, xy, _, yy, _, _ = result.field("stress")[inner].T
x, y = points[inner, 0] / radius[inner], points[inner, 1] / radius[inner]
hoop = xx * y**2 - 2.0 * xy * x * y + yy * x**2
mises = result.field("vm")[inner]

# %%
# The model covers half of the drive. The other half is the same, rotated by 180°.
# The dashed line is the bending stress of a smooth ring as thick as the rim, on an ellipse:
# 3/4 E t d cos 2θ / r². The teeth stiffen the rim, which raises the stress between them.

rim, middle = design.flexible_spline.rim, radius.min() + 0.5 * design.flexible_spline.rim
amplitude = 0.75 * design.material.E * rim * design.deflection / middle**2
theta = np.linspace(-180.0, 180.0, 721)

figure, axes = plt.subplots(figsize=(8.5, 4.2), layout="constrained")
for shift, labels in ((0.0, ("hoop stress", "von Mises stress")), (180.0, ("_", "_"))):
    axes.plot(angle[order] + shift, hoop[order], color="tab:blue", linewidth=1.0, label=labels[0])
    axes.plot(angle[order] + shift, mises[order], color="tab:red", linewidth=1.0, label=labels[1])
axes.plot(
    theta,
    -amplitude * np.cos(np.radians(2.0 * theta)),
    "--",
    color="0.3",
    label="smooth ring, bending",
)
axes.set(
    xlabel="angle from the major axis (deg)",
    ylabel="stress on the inner surface (MPa)",
    xlim=(-180.0, 180.0),
    xticks=np.arange(-180, 181, 45),
)
axes.grid(alpha=0.3)
axes.legend()
plt.show()

"""
A drive from catalogue numbers
==============================

Ratio, diameter and torque are what a catalogue gives. ``swgpar.new``, on the command line
``swgpar new mine.toml --ratio 100 --diameter 50 --torque 12``, makes a checked design from them.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

path = Path(tempfile.mkdtemp()) / "mine.toml"
design = swgpar.new(path, ratio=100, diameter=50.0, torque=12.0)

# %%
# The file has every key with its meaning. Its head and the first section:

print(*path.read_text(encoding="utf-8").splitlines()[:30], sep="\n")

# %%
# What follows from it. A clearance above zero says that the undeformed teeth do not overlap.

derived = swgpar.check(design)
for name in (
    "d, diametral deflection (mm)",
    "r_fs, inner radius of the spline (mm)",
    "cup thickness (mm)",
    "tooth height, flexible spline (mm)",
    "smallest flank clearance, kinematic (mm)",
):
    print(f"{name:45} {derived[name]:.4g}")

# %%
# The teeth at the major axis. The flexible spline is moved outwards by half of the deflection.


def teeth(flank, angles, shift):
    """Outline of teeth whose centre lines have the given angles from +y."""
    right = flank.point(np.linspace(0.0, flank.length, 200))
    tooth = np.vstack([right[::-1] * [-1.0, 1.0], right])
    for angle in angles:
        c, s = np.cos(angle), np.sin(angle)
        yield tooth @ np.array([[c, -s], [s, c]]) + [0.0, shift]


spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
pitches = np.arange(-3, 4)
figure, axes = plt.subplots(figsize=(8.0, 3.4), layout="constrained")
outline = np.vstack(
    list(teeth(spline, 2 * np.pi * pitches / spline.n_teeth, 0.5 * design.deflection))
)
low, high = design.major_semi_axis, ring.r_root_circle + 0.5 * design.drive.module
axes.fill_between(*outline.T, low, color="tab:blue", alpha=0.5, label="flexible spline")
outline = np.vstack(list(teeth(ring, 2 * np.pi * (pitches + 0.5) / ring.n_teeth, 0.0)))
axes.fill_between(*outline.T, high, color="tab:orange", alpha=0.5, label="ring gear")
half = 2.5 * np.pi * design.drive.module
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", xlim=(-half, half), ylim=(low, high))
figure.legend(loc="outside lower center", ncols=2)

# %%
# The plane model of the same numbers runs in seconds, for a first look at the stress around the
# spline. It carries a small torque only: it has no cup that holds the spline.

plane = swgpar.new(ratio=100, diameter=50.0, torque=1.0, model="plane")
quick = plane.with_values({"steps.samples": 2, "output.root_stress": False})
gear = {"tip": 2, "layers": 1, "flank": 4, "root": 3, "under": 1, "rim": 2}
result = swgpar.run(quick, mesh={"flexible_spline": gear, "ring_gear": gear})
figure = result.plot.stress_around()
plt.show()

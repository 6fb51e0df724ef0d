"""
Conjugate teeth
===============

The flank of the ring gear as the envelope of the flank of the flexible spline, beside the quadruple
arc: profile, distance of the flanks, and how the teeth share the load.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar
from swgpar.profiles.mesh_gap import OutlinePair, outline

DRIVERS = Path(__file__).parents[2] / "drivers"
arcs = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {
        "steps.samples": 4,
        "steps.rotation": 3.0,
        "output.fields": False,
        "output.root_stress": False,
    },
)
designs = {
    "quadruple arc": arcs,
    "conjugate": arcs.with_values({"ring_gear.profile": {"type": "conjugate", "r_root": 0.2}}),
}

# %%
# Half of a tooth space of the ring gear. Both flanks go through the pitch circle.

figure, axes = plt.subplots(figsize=(6.0, 4.2), layout="constrained")
for name, design in designs.items():
    flank = design.profile("ring_gear")
    axes.plot(*flank.point(np.linspace(0.0, flank.length, 400)).T, label=f"ring gear, {name}")
axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
axes.legend(loc="lower right")

# %%
# Smallest distance between the undeformed flanks of a pair of teeth, while the cam passes it. Where
# the conjugate flank is zero, the pair is in contact.

angle = np.linspace(-8.0, 8.0, 161)
figure, axes = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
for name, design in designs.items():
    gears = (outline(design.profile(gear)) for gear in ("flexible_spline", "ring_gear"))
    gap = OutlinePair(*gears, design.tooth_motion()).facing_gaps(np.radians(angle))
    axes.plot(angle, 1000.0 * gap, label=name)
axes.set(xlabel="tooth, from the major axis (degrees)", ylabel="distance of the flanks (µm)")
axes.set_ylim(-2.0, 20.0)
axes.grid(alpha=0.3)
axes.legend()

# %%
# Rigid teeth: a conjugate pair has next to no transmission error.

for name, design in designs.items():
    derived = swgpar.check(design)
    error = derived["transmission error of rigid teeth (arcsec)"]
    print(f"{name:14} transmission error {error:.4f} arc seconds")

# %%
# Elastic teeth under 2 N·m. With conjugate teeth fewer teeth share the load, because the contact is
# confined to the neighbourhood of the major axis.

gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
mesh = {"flexible_spline": gear, "ring_gear": gear}
figure, axes = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
for name, design in designs.items():
    result = swgpar.run(design, mesh=mesh)
    sharing, pairs = result.summary.load_sharing, result.pairs
    share = 100.0 * sharing.teeth_share.mean
    print(f"{name:14} {share:.2f} % of the teeth in contact", end=", ")
    print(f"largest force of a pair {sharing.largest_force_N:.0f} N")
    position = (pairs["angle_deg"] + 90.0) % 180.0 - 90.0
    axes.plot(position, pairs["force_N"], "o", label=name)
axes.set(xlabel="tooth, from the major axis (degrees)", ylabel="normal force (N)", ylim=(0.0, None))
axes.grid(alpha=0.3)
axes.legend()
plt.show()

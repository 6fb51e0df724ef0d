"""
Torque sweep
============

One design under five output torques. ``with_values`` returns a new, checked design.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
TORQUES = [0.5, 1.0, 2.0, 4.0, 8.0]  # N·m
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {"steps.samples": 4, "steps.rotation": 3.0, "output.fields": False},
)
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
mesh = {"flexible_spline": gear, "ring_gear": gear}

results = [swgpar.run(design.with_values({"load.torque": t}), mesh=mesh) for t in TORQUES]

# %%
# Stresses are means over the rotation of the largest value over the body. On an elliptical cam
# the bending of the rim dominates: the stress of the spline hardly depends on the torque.

figure, axes = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
labels = {
    "fs_s1": "flexible spline, s1",
    "fs_s3": "flexible spline, |s3|",
    "fs_vm": "flexible spline, von Mises",
    "rg_vm": "ring gear, von Mises",
}
for name, label in labels.items():
    axes.plot(TORQUES, [r.summary.rotation.means[name] for r in results], "o-", label=label)
axes.set(xlabel="output torque (N·m)", ylabel="stress (MPa)", ylim=(0.0, None))
axes.legend(fontsize=8)

# %%
# The mean input torque is that of the energy balance. More teeth share a higher torque.

figure, axes = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
input_torque = [r.summary["mean.wg_torque_Nmm"].value for r in results]
axes.plot(TORQUES, input_torque, "o", label="computed")
axes.plot(
    TORQUES, 1000.0 * np.array(TORQUES) / abs(design.kinematics.ratio), "--", label="torque / ratio"
)
axes.set(xlabel="output torque (N·m)", ylabel="mean input torque (N·mm)")
axes.legend(loc="upper left")
count = axes.twinx()
pairs = [r.history["pairs_in_contact"][-4:].mean() for r in results]
count.plot(TORQUES, pairs, "s:", color="tab:green")
count.set_ylabel("pairs of flanks in contact", color="tab:green")
count.set_ylim(0.0, 12.0)
plt.show()

"""
Friction between the flanks
===========================

Friction between the flanks raises the input torque. The difference to torque / ratio is the
heat of the flanks. Wave generator and pins are frictionless in the model.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
FRICTION = [0.0, 0.1, 0.2]
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {"load.torque": 10.0, "steps.samples": 4, "steps.rotation": 6.0, "output.fields": False},
)
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
mesh = {"flexible_spline": gear, "ring_gear": gear}
results = [swgpar.run(design.with_values({"contact.friction": mu}), mesh=mesh) for mu in FRICTION]

# %%
# The efficiency of the tooth contact is the input torque of the frictionless drive over the
# mean input torque.

ideal = 1000.0 * design.load.torque / abs(design.kinematics.ratio)
for mu, result in zip(FRICTION, results):
    torque = result.summary["mean.wg_torque_Nmm"].value
    print(f"friction {mu:.1f}   input torque {torque:6.2f} N·mm   efficiency {ideal / torque:.4f}")

figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")
for mu, result in zip(FRICTION, results):
    loaded = result.history["step"].astype(int) >= 3
    angle = result.history["wg_angle_deg"][loaded]
    left.plot(angle, result.history["wg_torque_Nmm"][loaded], "o-", label=f"μ = {mu:g}")
left.axhline(ideal, color="0.4", linestyle="--", linewidth=0.8)
left.set(xlabel="angle of the wave generator (deg)", ylabel="input torque (N·mm)")
left.legend(loc="center right")
stress = np.array([[r.summary.rotation.means[n] for r in results] for n in ("fs_s1", "fs_vm")])
right.plot(FRICTION, stress.T, "o-", label=["flexible spline, s1", "flexible spline, von Mises"])
right.set(
    xlabel="coefficient of friction", ylabel="mean of the largest stress (MPa)", xticks=FRICTION
)
right.legend(fontsize=8)
plt.show()

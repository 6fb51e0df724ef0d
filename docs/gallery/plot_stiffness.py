"""
Torsional stiffness and hysteresis
==================================

The wave generator is locked. The output torque goes from zero to its largest value, to its
negative, and back. The rotation of the output shows stiffness, backlash and friction.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {
        "stiffness.torque": 10.0,
        "stiffness.positions": 2,
        "stiffness.points": 4,
        "stiffness.mesh_error": False,
        "output.fields": False,
    },
)
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
mesh = {"flexible_spline": gear, "ring_gear": gear}

# %%
# The plane model is the toothed section alone. Without the cup it is far stiffer than a drive.

result = swgpar.run(design.with_values({"contact.friction": 0.1}), mesh=mesh)
for name, unit in {"K1": "N·m/rad", "K2": "N·m/rad", "K3": "N·m/rad"}.items():
    found = result.summary.stiffness
    value, spread = getattr(found, name), getattr(found.spread, name)
    print(f"{name}  {value:9.0f} {unit}, spread over positions {spread:.0f}")
print(f"lost motion {found.lost_motion:.4f}, hysteresis {found.hysteresis:.4f} arc minutes")

figure = result.plot.torque_against_rotation()

# %%
# Without friction both branches are the same. A run then computes one way of the loop.

free = swgpar.run(design, mesh=mesh)
figure, axes = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
for label, one in {"friction 0.1": result, "no friction": free}.items():
    here = one.program["wg_angle_deg"] == 0.0
    axes.plot(one.program["rotation_arcmin"][here], one.program["torque_Nm"][here], label=label)
axes.set(xlabel="rotation of the output (arc minutes)", ylabel="output torque (N·m)")
axes.legend()
plt.show()

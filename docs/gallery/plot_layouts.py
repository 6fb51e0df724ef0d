"""
Layouts: which member is fixed
==============================

With the ring gear fixed, the flexible spline is the output and turns against the wave
generator. With the spline fixed, the ring gear is the output and turns with it. With the
wave generator fixed, the ring gear drives the flexible spline.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
mesh = {"flexible_spline": gear, "ring_gear": gear}
reference = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {"steps.samples": 8, "steps.rotation": 6.0, "output.fields": False},
)
results = {
    layout: swgpar.run(reference.with_values({"drive.layout": layout}), mesh=mesh)
    for layout in ("ring_fixed", "spline_fixed", "wave_generator_fixed")
}

# %%
# The ratios of the first two differ by one, the stresses by less than a percent. The third
# is the first one seen from its wave generator: the stresses are the same.

for layout, result in results.items():
    means, ratio = result.summary.rotation.means, result.summary.ratio
    driven = result.summary.rotation.input  # of the ring gear, where the wave generator stands
    torque = driven.torque_Nmm if driven else means["wg_torque_Nmm"]
    print(f"{layout:20} ratio {ratio:7.3f}   s1 {means['fs_s1']:6.1f} MPa", end="   ")
    print(f"input torque {torque:8.2f} N·mm, expected {2000.0 / abs(ratio):7.2f} in size")

# %%
# The angle is drawn in periods of the motion: one pitch of the gear against which the wave
# generator turns.

figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
for (layout, result), teeth in zip(results.items(), (122, 120, 122)):
    loaded = result.history["step"].astype(int) >= 3
    periods = result.history["wg_angle_deg"][loaded] * teeth / 360.0
    expected = result.summary.rotation.wg_torque_expected_Nmm
    axes[0].plot(periods, result.history["fs_s1"][loaded], "o-", markersize=3, label=layout)
    axes[1].plot(periods, result.history["wg_torque_Nmm"][loaded] / expected, "o-", markersize=3)
axes[0].set(xlabel="periods", ylabel="largest s1 of the spline (MPa)")
axes[1].set(xlabel="periods", ylabel="torque of the wave generator / expected")
axes[0].legend()
for panel in axes:
    panel.grid(alpha=0.3)
plt.show()

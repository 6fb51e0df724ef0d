"""
Transmission error and torque ripple
====================================

Two periods of the motion, sampled at 16 angles each. The transmission error is the angle of
the output less the angle of the wave generator divided by the ratio.
"""

# ranks: 1 2

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
pitch = 360.0 / design.drive.teeth_rg
design = design.with_values({"steps.samples": 16, "steps.rotation": 2.0 * pitch})
gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
result = swgpar.run(design, mesh={"flexible_spline": gear, "ring_gear": gear})

# %%
# Both curves repeat after one pitch of the ring gear, 360° / 122 = 2.95°.

loaded = result.history["step"].astype(int) >= 3
angle = result.history["wg_angle_deg"][loaded]
torque = result.history["wg_torque_Nmm"][loaded]
error = 3600.0 * (result.history["output_angle_deg"][loaded] - angle / design.kinematics.ratio)
error -= error.mean()

figure, (upper, lower) = plt.subplots(2, 1, figsize=(7.5, 5.5), sharex=True, layout="constrained")
upper.plot(angle, error, "o-", markersize=3)
upper.set(ylabel="transmission error (arc seconds)")
lower.plot(angle, torque, "o-", markersize=3, color="tab:orange")
lower.axhline(
    1000.0 * design.load.torque / abs(design.kinematics.ratio), color="0.4", linestyle="--"
)
lower.set(xlabel="angle of the wave generator (deg)", ylabel="input torque (N·mm)")
for axes in (upper, lower):
    axes.grid(alpha=0.3)

# %%
# The summary has the peak-to-peak value, and the ripple of the input torque as a share of its
# mean.

print(f"transmission error {result.summary.rotation.transmission_error_arcsec:.3f} arc seconds")
print(f"torque ripple      {100.0 * result.summary.rotation.torque_ripple:.2f} %")

# %%
# The amplitudes by harmonics of the period.

period = slice(0, design.steps.samples)
amplitudes = 2.0 * np.abs(np.fft.rfft(error[period])) / design.steps.samples
figure, axes = plt.subplots(figsize=(7.5, 3.0), layout="constrained")
axes.bar(np.arange(1, len(amplitudes)), amplitudes[1:])
axes.set(xlabel="harmonic of the period", ylabel="amplitude (arc seconds)")
plt.show()

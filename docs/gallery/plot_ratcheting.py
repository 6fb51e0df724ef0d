"""
Ratcheting torque
=================

The wave generator is locked, and the output is rotated until the teeth jump over. A small drive in
the plane, with low teeth: cam and ring gear's outside are rigid, and high teeth would not let go.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DATA = Path(__file__).parents[2] / "tests" / "data"
low = {"r_tip": 0.1, "r_addendum": 1.0, "straight_l": 0.05, "r_dedendum": 2.0, "r_root": 0.3}
design = swgpar.load_design(
    DATA / "small.toml",
    {
        "drive.model": "plane",
        "drive.addendum_coef": 0.1,
        "flexible_spline.profile": low,
        "ring_gear.profile": low,
        "micro_geometry": {},
        "ratcheting.increment": 0.01,
    },
)
result = swgpar.run(design, mesh=DATA / "tiny.toml")

# %%
# The torque rises, reaches its peak and falls.

figure = result.plot.torque_against_rotation()
plt.show()

# %%
# The summary has the peak and what gave way.

found = result.summary.ratcheting
print(f"largest torque: {found.peak_torque_Nm:.3g} N·m, found: {found.is_peak}")
print(f"at {found.peak_rotation_pitches:.2f} pitches of the output")
print(f"what gives way: {found.gave_way}; the run ended because: {found.ended}")

"""
Tooth profiles
==============

The kinds of tooth profile, drawn from the curves that the mesh is built on. One flank goes
from the addendum circle to the dedendum circle as a chain of arcs, lines and generated curves.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
PROFILES = {
    "quadruple arc": {
        "type": "quadruple_arc",
        "r_tip": 0.3,
        "r_addendum": 1.0,
        "straight_l": 0.2,
        "r_dedendum": 2.0,
        "r_root": 0.3,
    },
    "double arc": {"type": "double_arc", "r_addendum": 0.7, "r_dedendum": 0.6},
    "involute": {"type": "involute", "cutter_radius": 0.2},
    "trapezoid": {"type": "trapezoid", "r_tip": 0.05, "r_root": 0.2},
    "arcs by their centres": {
        "type": "common_tangent",
        "r_addendum": 1.0,
        "c_addendum": 0.22,
        "e_addendum": 0.14,
        "r_dedendum": 1.3,
        "c_dedendum": 0.51,
        "e_dedendum": 0.24,
        "r_root": 0.3,
    },
    "s-shaped": {"type": "s_shaped", "r_root": 0.25},
    "cycloid": {"type": "cycloid", "r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.2},
}


def with_profile(profile: dict) -> object:
    """The reference drive with one kind of profile on both gears."""
    design = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
    ring = profile | ({"cutter_teeth": 80} if profile["type"] == "involute" else {})
    return design.with_values({"flexible_spline.profile": profile, "ring_gear.profile": ring})


designs = {name: with_profile(profile) for name, profile in PROFILES.items()}

# %%
# The right flank of a tooth of the flexible spline. Each segment of the chain has a colour.
# The dotted lines are the addendum, the pitch and the dedendum circle.

figure, axes = plt.subplots(1, len(designs), figsize=(14.0, 2.6), sharey=True, layout="constrained")
for panel, (name, design) in zip(axes, designs.items()):
    flank = design.profile("flexible_spline")
    for start, end in zip(flank.breaks[:-1], flank.breaks[1:]):
        panel.plot(*flank.point(np.linspace(start, end, 50)[1:-1]).T, linewidth=2.5)
    pitch = 0.5 * design.drive.module * design.drive.teeth_fs
    x = np.linspace(0.0, 1.6, 30)
    for radius in (flank.r_tip_circle, pitch, flank.r_root_circle):
        panel.plot(x, np.sqrt(radius**2 - x**2), ":", color="0.4", linewidth=1.0)
    panel.set(title=name, xlabel="x (mm)", aspect="equal", xlim=(0.0, 1.6))
axes[0].set_ylabel("y (mm)")

# %%
# Both gears at the major axis. The teeth of the flexible spline are moved outwards by half of
# the deflection. The flanks touch when the torque closes the backlash.


def teeth(flank, angles, shift):
    """Outline of teeth whose centre lines have the given angles from +y."""
    right = flank.point(np.linspace(0.0, flank.length, 200))
    left = right[::-1] * [-1.0, 1.0]
    tooth = np.vstack([left, right])
    for angle in angles:
        c, s = np.cos(angle), np.sin(angle)
        yield tooth @ np.array([[c, -s], [s, c]]) + [0.0, shift]


figure, axes = plt.subplots(1, len(designs), figsize=(14.0, 2.2), sharey=True, layout="constrained")
for panel, (name, design) in zip(axes, designs.items()):
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    pitches = np.arange(-3, 4)
    spline_angles = 2.0 * np.pi * pitches / spline.n_teeth
    ring_angles = 2.0 * np.pi * (pitches + 0.5) / ring.n_teeth
    outline = np.vstack(list(teeth(spline, spline_angles, 0.5 * design.deflection)))
    panel.fill_between(*outline.T, 58.0, color="tab:blue", alpha=0.5, label="flexible spline")
    outline = np.vstack(list(teeth(ring, ring_angles, 0.0)))
    panel.fill_between(*outline.T, 63.0, color="tab:orange", alpha=0.5, label="ring gear")
    panel.set(title=name, xlabel="x (mm)", aspect="equal", xlim=(-5.0, 5.0), ylim=(58.5, 62.8))
axes[0].set_ylabel("y (mm)")
axes[0].legend(loc="lower center", fontsize=8)
plt.show()

"""
Cams of the wave generator
==========================

The kinds of cam, drawn from the curves that the contact search uses. All have the same
major semi-axis. The second figure shows how far each cam lies outside or inside the
undeformed inner surface of the flexible spline.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
CAMS = {
    "elliptical": {"type": "elliptical"},
    "harmonic": {"type": "harmonic"},
    "simplified": {"type": "simplified", "C": 0.97},
    "arcs": {"type": "arcs", "beta": 45.0},
    "parabolic": {"type": "parabolic", "a_p": 0.0095, "C_p": 0.45, "r_c": 12.0},
    "parabolic, asymmetric": {
        "type": "asymmetric_parabolic",
        "right": {"a_p": 0.0095, "C_p": 0.45, "r_c": 12.0},
        "left": {"a_p": 0.0097, "C_p": 0.51, "r_c": 10.0},
    },
    "3-4-5 polynomial": {
        "type": "polar",
        "radius": "s = 2 * theta / pi; a - (a - b) * (10 * s**3 - 15 * s**4 + 6 * s**5)",
    },
    "four rollers": {"type": "four_roller", "beta": 25.0, "r_4": 15.0},
    "two rollers": {"type": "two_roller", "r_2": 20.0},
}

reference = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
designs = {
    name: reference.with_values({"wave_generator": {"face_width": 10.0, **keys}})
    for name, keys in CAMS.items()
}

# %%
# The outlines. The dashed circle is the inner surface of the undeformed spline. The distance of
# the cams from it is drawn 5 times as large; the rollers are true to scale.

columns = (len(designs) + 1) // 2
figure, rows = plt.subplots(2, columns, figsize=(12.0, 5.4), sharey=True, layout="constrained")
axes = rows.ravel()
for panel in axes[len(designs) :]:
    panel.set_axis_off()
angle = np.linspace(0.0, 2.0 * np.pi, 721)
for panel, (name, design) in zip(axes, designs.items()):
    outline = design.cam().outline(3600)
    rollers = {"four rollers": 4, "two rollers": 2}.get(name, 0)
    if not rollers:
        radius = np.hypot(*outline.T)
        outline *= (1.0 + 4.0 * (1.0 - design.inner_radius / radius))[:, None]
    circle = design.inner_radius * np.stack([np.sin(angle), np.cos(angle)])
    for part in np.array_split(outline, rollers or 1):
        panel.plot(*np.vstack([part, part[:1]]).T, color="tab:orange")
    panel.plot(*circle, "--", color="0.6", linewidth=0.8)
    panel.set(aspect="equal", xlabel="x (mm)")
    panel.set_title(name, fontsize=9)
for panel in rows[:, 0]:
    panel.set_ylabel("y (mm)")

# %%
# The radial distance of the cams from that circle, over the angle from the major axis.
# Rollers leave the spline free between them.

figure, panel = plt.subplots(figsize=(8.0, 4.5), layout="constrained")
edges = np.linspace(-90.0, 90.0, 361)
for name, design in designs.items():
    x, y = design.cam().outline(7200).T
    around = np.degrees(np.arctan2(x, y))
    radius = np.hypot(x, y)
    outside = [
        radius[(around >= low) & (around < high)].max(initial=0.0)
        for low, high in zip(edges[:-1], edges[1:])
    ]
    panel.plot(
        (edges[:-1] + edges[1:]) / 2.0, np.subtract(outside, design.inner_radius), label=name
    )
panel.axhline(0.0, color="0.6", linewidth=0.8)
panel.set(
    xlabel="angle from the major axis (deg)",
    ylabel="outside the inner surface (mm)",
    xlim=(-90.0, 90.0),
    ylim=(-2.0, 1.2),
    xticks=np.arange(-90, 91, 30),
)
panel.legend(loc="lower center", ncols=3)
plt.show()

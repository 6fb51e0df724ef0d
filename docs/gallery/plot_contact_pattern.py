"""
Contact pattern of the cup drive
================================

The reference cup drive under 20 N·m, on a mesh that is coarser than those of the package. The
pressure on the flanks shows where the teeth touch: with crowned flanks the contact should end
inside the face width.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(
    DRIVERS / "cup_45deg.toml",
    {"steps.rotation": 0.0, "steps.pins": False, "solver.rtol": 1e-6},
)
gear = {"tip": 2, "layers": 1, "flank": 3, "root": 2, "under": 1, "rim": 1}
mesh = {
    "flexible_spline": gear,
    "ring_gear": gear,
    "face_width": {"elements": 4},
    "cup": {"cylinder": 2, "fillet": 1, "closed_end": 1},
}
result = swgpar.run(design, mesh=mesh)

# %%
# ``flank_pressure`` gives nodal means of the pressure over the arc length from the tip and the
# coordinate z along the face width. The open end of the cup is at negative z.

flanks = result.flank_pressure()
peak = flanks.pressure.max(axis=(1, 2, 3))
teeth = [tooth for tooth in range(len(peak)) if peak[tooth] > 0.02 * peak.max()]
figure, axes = plt.subplots(
    1, len(teeth), figsize=(2.8 * len(teeth) + 1.0, 3.8), sharey=True, layout="constrained"
)
for panel, tooth in zip(axes, teeth):
    side = flanks.pressure[tooth].max(axis=(1, 2)).argmax()
    image = panel.contourf(
        flanks.z,
        flanks.s,
        flanks.pressure[tooth, side],
        levels=20,
        vmin=0.0,
        vmax=peak.max(),
        cmap="magma",
    )
    panel.set(title=f"tooth {tooth}", xlabel="z (mm)")
axes[0].set_ylabel("arc length from the tip (mm)")
axes[0].invert_yaxis()
scale = plt.cm.ScalarMappable(plt.Normalize(0.0, peak.max()), "magma")
figure.colorbar(scale, ax=axes, label="contact pressure, nodal mean (MPa)")

# %%
# The deformed drive. The cup is bent most in front of its open end.

result.plot.deformed()

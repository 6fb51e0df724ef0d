"""
Flexible ball bearing
=====================

The plane reference drive with 24 balls between its cam and its flexible spline. The inner race is
fitted on the cam, the outer race is an elastic ring. Two angles show how a ball moves towards the
major axis.
"""

# ranks: 1 2

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
drive = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
radius = drive.inner_radius  # mm
design = drive.with_values(
    {
        "wave_generator.bearing": {
            "balls": 24,
            "ball_diameter": round(0.14 * radius, 1),
            "race_thickness": round(0.026 * radius, 2),
        },
        "steps.rotation": 4.0,
        "steps.increment": 4.0,
        "output.fields": False,
        "output.root_stress": False,  # there are no windows with a bearing
    },
)
result = swgpar.run(design, mesh="plane_coarse")

# %%
# Loads of the balls around the bearing. Those at both ends of the major axis carry most.

result.plot.ball_loads()
plt.show()

# %%
# The summary has the largest load, the share of the bearing in the compliance and the rating life.

bearing = result.summary.bearing
share = bearing.torsional_share
print(f"largest ball load: {bearing.largest_load_N:.0f} N")
print(f"its pressure: {bearing.largest_pressure_MPa:.0f} MPa")
print(f"share of the torsional compliance: {100 * share.bearing:.0f} %")
print(f"of it the balls: {100 * share.balls:.0f} %")
print(f"rating life L10: {bearing.life.L10_hours:.3g} h")

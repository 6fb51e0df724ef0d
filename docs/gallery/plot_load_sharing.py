"""
Load sharing between teeth
==========================

How many pairs of flanks carry the torque of the plane reference drive, and how much each of them.
"""

# ranks: 1 2

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {"load.torque": 10.0, "output.fields": False, "output.root_stress": False},
)
result = swgpar.run(design, mesh="plane_coarse")

# %%
# Force and torque of every pair around the circumference, over one period.

figure = result.plot.load_sharing()
plt.show()

# %%
# The summary counts.

for answer in result.summary.load_sharing.answers():
    print(f"{answer.text}: {answer.value:.4g} {answer.unit}")

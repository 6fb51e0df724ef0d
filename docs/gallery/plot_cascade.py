"""
Load sharing of a cascade gearbox
=================================

A rack drives eight pinions with flexible units. How do they share the load?
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"

# %%
# The gearbox of the driver, with five gearboxes with random pitch errors instead of 1000.

design = swgpar.load_design(
    DRIVERS / "cascade.toml",
    {"population.gearboxes": 5, "tolerances.samples": 1000},
)
result = swgpar.run(design)

# %%
# Load shares at rest in direction B. Backlash between the gears G1 of a pair delays the even
# pinions. The different stiffnesses of the flexible units spread the shares.

result.plot.load_sharing_static_B()

# %%
# In motion, over one period of the rack force. Tooth meshing makes the shares vary.

result.plot.load_sharing_dynamic()

# %%
# Print and computation at 120 kN at rest. A share of 0.125 is perfect load sharing.

published = design.published["static_B_120"]
computed = result.summary.quantities["static_B_120"]
pinions = range(1, 9)
figure, panel = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
panel.bar([k - 0.2 for k in pinions], published, 0.4, label="published")
panel.bar([k + 0.2 for k in pinions], computed, 0.4, label="computed")
panel.axhline(0.125, color="k", linewidth=0.8, linestyle=":")
panel.set(xlabel="pinion", ylabel="load share at 120 kN", xticks=pinions)
panel.set_ylim(0.09, 0.16)
panel.legend()
plt.show()

"""
Gear pair with backlash
=======================

Two gears under torque and white noise. With less torque the gears lose contact, and the
mesh deflection is no longer normally distributed. Statistical linearisation is compared
with Monte Carlo simulation.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"

# %%
# The driver has three pairs of torques: no impact, impacts on one flank, and impacts on
# both flanks. Fewer samples, larger steps and a shorter time make
# it faster here.

design = swgpar.load_design(
    DRIVERS / "gear_pair.toml",
    {
        "monte_carlo.samples": 2000,
        "time.end": 0.01,
        "time.step": 2.5e-5,
        "time.rows": 100,
    },
)
result = swgpar.run(design)

# %%
# The standard deviation of the mesh deflection over time. The linearisations are exact
# without impacts. They underestimate the deviation where contact is lost.

names = {"monte_carlo": "Monte Carlo", "energy": "energy-based", "force": "force-based"}
styles = {"monte_carlo": "k-", "energy": "C0--", "force": "C1:"}
history = result.history
figure, panels = plt.subplots(1, 3, figsize=(11.0, 3.6), layout="constrained")
for case, (panel, torque) in enumerate(zip(panels, design.load.input), start=1):
    rows = history["case"] == case
    for method, name in names.items():
        column = history[f"{method}_deviation_mesh_deflection_um"]
        time = 1e3 * history["time_s"][rows]
        panel.plot(time, column[rows], styles[method], label=name)
    panel.set(title=f"input torque {torque:,.0f} N·m", xlabel="time (ms)")
panels[0].set_ylabel("standard deviation of\nthe mesh deflection (µm)")
panels[0].legend(fontsize=8)

# %%
# The density of the mesh deflection at the end of the third case. Within the backlash the
# mesh carries no force.

result.plot.case_3_density()

"""
Planetary train in the wind
===========================

The planetary train of a wind turbine with an elastic ring gear. Turbulent wind acts on the
carrier. Statistical linearisation gives mean and standard deviation.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"

# %%
# One revolution of the carrier for three rim thicknesses. The linearisation takes 500 steps
# here, and there are few simulations.

design = swgpar.load_design(
    DRIVERS / "planetary.toml",
    {
        "time.linearised_steps": 500,
        "time.steps": 500,
        "monte_carlo.samples": 32,
    },
)
result = swgpar.run(design)

# %%
# The rotation of the carrier, linearised and simulated, as a displacement at the radius of
# the planet centres.

result.plot.carrier_rotation()

# %%
# The outward displacement of the ring at planet 1. It has six cycles in a revolution, one
# for each support. A thicker rim makes it much smaller.

table = result.tables["rims"]
figure, panel = plt.subplots(figsize=(7.5, 4.0), layout="constrained")
for rim in design.ring.rims:
    rows = table["rim_mm"] == rim
    column = table["mean_ring_contact_radial_um"][rows]
    panel.plot(table["time_s"][rows], column, label=f"rim {rim:g} mm")
panel.set(
    xlabel="time (s)",
    ylabel="mean outward displacement\nof the ring at planet 1 (µm)",
)
panel.set_ylim(0.0, 18.0)
panel.legend(ncols=3)
plt.show()

"""
Elastic ring
============

Bending modes of a ring of curved beams, and its displacement under moving loads.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"

# %%
# The modes of a free ring with tooth masses. Tooth masses lower the frequencies against
# the smooth ring.

toothed = swgpar.run(swgpar.load_design(DRIVERS / "ring_modes.toml"))
toothed.plot.mode_shapes()

# %%
# Frequencies of the toothed ring and of the free smooth ring.

modes = toothed.tables["modes"]
figure, panel = plt.subplots(figsize=(6.5, 3.8), layout="constrained")
panel.plot(modes["mode"], modes["free_ring_Hz"], "o--", label="smooth ring, closed form")
panel.plot(modes["mode"], modes["frequency_Hz"], "s-", label="with tooth masses")
panel.set(xlabel="mode", ylabel="natural frequency (Hz)")
panel.legend()

# %%
# A ring on six supports under three moving loads with white noise. The outward displacement
# of the point under the first load has six cycles in a revolution, one for each support.

design = swgpar.load_design(
    DRIVERS / "ring_moving_load.toml",
    {
        "moving_load.speeds": [22.0],
        "moving_load.sweep_speeds": 2,
        "moving_load.steps": 360,
        "moving_load.samples": 2,
        "published": {},
    },
)
history = swgpar.run(design).history
degrees = np.degrees(history["angle_rad"])
mean = 1e6 * history["mean_moving_point_m"]
figure, panel = plt.subplots(figsize=(7.5, 3.8), layout="constrained")
panel.plot(degrees, mean)
panel.set(
    xlabel="angle of the first load (deg)",
    ylabel="mean outward displacement (µm)",
    xlim=(0.0, 360.0),
)
panel.set_xticks(np.arange(0, 361, 60))
plt.show()

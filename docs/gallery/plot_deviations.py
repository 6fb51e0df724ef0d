"""
Transmission error with deviations
==================================

One turn of the wave generator of the plane reference drive. The ring gear has random pitch errors
of ISO 1328-1 grade 6 and is 10 µm off the axis.
"""

# ranks: 1 2

from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {
        "deviations.ring_gear.pitch_grade": 6,
        "deviations.ring_gear.eccentricity": 0.01,
        "output.root_stress": False,
        "output.fields": False,
    },
)
result = swgpar.run(design, mesh="plane_coarse")

# %%
# The error over the turn, and its orders. Both waves pass the ring gear in every turn, so that even
# orders are the largest.

result.plot.transmission_error_spectrum()
plt.show()

# %%
# The summary names the causes.

error = result.summary.transmission_error
print(f"{error.peak_to_peak:.1f} arc seconds peak to peak")
for line in error.spectrum[:5]:
    print(f"order {line.order:g}: {line.amplitude:.2f} arc seconds, {line.cause}")

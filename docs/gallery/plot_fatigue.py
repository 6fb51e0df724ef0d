"""
Fatigue over a turn of the wave generator
=========================================

The plane drive under its torque. Every tooth is at another phase of the cycle that all teeth go
through. So six angles of one period give the stress of a tooth over half a turn at 360 phases, and
with it the safety against fatigue. The strengths are the defaults of ``[fatigue]``, those of a
steel like 30CrNiMo8: replace them by those of your material.
"""

from pathlib import Path

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml", {"fatigue": {}, "losses": {}, "output.fields": False}
)
result = swgpar.run(design)
found = result.summary.fatigue
for criterion in ("goodman", "crossland"):
    place = found.least[criterion]
    print(f"{criterion}: {place.safety:.2f}, {place.region}, radius {place.radius:.2f} mm")

# %%
# Haigh's diagram of all nodes. Below it the normal stress where the safety is the least: the tooth
# is bent with the rim twice per turn, and once per half turn its flank carries.

result.plot.haigh()

# %%
# The safety on the sector. Roots and the inside of the rim are stressed most.

result.plot.safety()

# %%
# The losses follow from the same cycle, from the pairs of flanks, and from the force of the cam.

for answer in result.summary.losses.answers():
    print(f"{answer.text}: {answer.value:.3g} {answer.unit}")

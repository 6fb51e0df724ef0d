"""Optimisation files: the gear pair with few samples, in two variables."""

from __future__ import annotations

from support.paths import DRIVERS

FREQUENCY = "natural frequency 2 (rad/s)"
OPTIMISATION = f"""
[optimise]
design = {str(DRIVERS / "gear_pair.toml")!r}
set = ["monte_carlo.samples=20", "time.end=1e-4", "time.rows=2"]
evaluations = 12
first = [{{ "mesh.stiffness" = 2e9 }}]

[[optimise.variable]]
keys = ["mesh.stiffness"]
low = 1e9
high = 1e11
log = true

[[optimise.variable]]
keys = ["gear_1.mass", "gear_2.mass"]
low = -50.0
high = 200.0

[[optimise.objective]]
quantity = "{FREQUENCY}"
goal = "maximise"

[[optimise.constraint]]
quantity = "damping ratio 1"
at_most = 0.5
"""

FROM_START = OPTIMISATION.replace(
    'keys = ["gear_1.mass", "gear_2.mass"]\nlow = -50.0', 'keys = ["gear_1.mass"]\nlow = 20.0'
)
"""The same in keys of one value each, so that the design file is a point of the search."""

"""Overrides that make the gear trains of drivers/ small."""

from __future__ import annotations

SMALL = {
    "cascade": ("population.gearboxes=30", "population.hold=0.01", "load.period=0.05", "tolerances.samples=100"),
    "gear_pair": ("monte_carlo.samples=5000", "time.end=0.0005", "time.rows=10"),
    "planetary": ("monte_carlo.samples=300", "time.steps=20", "time.linearised_steps=20", "time.rows=10"),
    "ring_moving_load": (
        "ring.elements=12",
        "moving_load.steps=36",
        "moving_load.sweep_speeds=4",
        "moving_load.samples=60",
    ),
}
"""By the name of the design file."""

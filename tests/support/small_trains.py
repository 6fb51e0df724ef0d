"""Overrides that make the gear trains of drivers/ small; samples do not divide evenly between two
ranks."""

from __future__ import annotations

SMALL = {
    "cascade": (
        "population.gearboxes=31",
        "population.hold=0.01",
        "load.period=0.05",
        "tolerances.samples=101",
    ),
    "gear_pair": ("monte_carlo.samples=5001", "time.end=0.0005", "time.rows=10"),
    "planetary": (
        "monte_carlo.samples=301",
        "time.steps=20",
        "time.linearised_steps=20",
        "time.rows=10",
    ),
    "ring_moving_load": (
        "ring.elements=12",
        "moving_load.steps=36",
        "moving_load.sweep_speeds=4",
        "moving_load.samples=61",
    ),
}
"""By the name of the design file."""

"""Gear trains of drivers/ with overrides that make them small, and results with numbers of one's
own.

Samples do not divide evenly between two ranks.
"""

from __future__ import annotations

from collections.abc import Mapping

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.result import TrainResult, TrainSummary
from swgpar.results.quantity import Quantity
from swgpar.results.table import Columns

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
    "planetary_stage": ("load.positions=20", "tolerances.samples=31", "tolerances.positions=6"),
    "ring_moving_load": (
        "ring.elements=12",
        "moving_load.steps=36",
        "moving_load.sweep_speeds=4",
        "moving_load.samples=61",
    ),
}
"""By the name of the design file."""


def result_with(
    quantities: Mapping[str, float | list[float]], history: Columns
) -> TrainResult[TrainDesign]:
    """A result of a ring with these quantities, that took 2 s."""
    design = load_design(DRIVERS / "ring_moving_load.toml")
    assert isinstance(design, TrainDesign)
    known = {name: Quantity(name) for name in quantities}
    return TrainResult(history, {}, TrainSummary(quantities, 1, {}, 2.0, {}, design, known))

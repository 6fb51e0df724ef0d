"""What a run of a cascade gearbox gives by name, and values derived from its design."""

from __future__ import annotations

from swgpar.gear_trains.cascade.design import MESH_COUNTS, PAIRS, PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS, FLYWHEEL, masses, rigid_displacements
from swgpar.gear_trains.cascade.static_sharing import path_gap_angles
from swgpar.gear_trains.cascade.tolerance_stack_up import standard_deviation
from swgpar.gear_trains.published import number_label
from swgpar.results.quantity import Quantity

RANKED_TOLERANCES = (
    "pitch deviation pinion",
    "runout pinion",
    "pitch deviation rack",
    "runout rack",
    "position pinion",
    "axle angle pinion",
)
"""Tolerances of the rack and the pinions, in the order of Table 2."""

SINGLE = {
    "overloaded_static": "number of gearboxes overloaded at rest",
    "overloaded_dynamic": "number of gearboxes overloaded at any time at constant rack force",
    "largest_static_share": "largest load share at rest of all gearboxes with errors",
    "largest_dynamic_mean_share": "largest mean load share in motion of all gearboxes with errors",
    "largest_dynamic_share": "largest load share at any time at constant rack force, all gearboxes "
    "with errors",
}
"""Numbers of the population."""

AT_FORCE = {
    "static_B": "at rest at {0:g} kN, direction B",
    "static_A": "at rest at {0:g} kN, direction A",
    "static_equal_B": "at rest at {0:g} kN, odd and even pinions, equal flexible units",
    "dynamic_B": "in motion at {0:g} kN, direction B",
    "dynamic_mean_B": "in motion at {0:g} kN, means of odd and even pinions",
}
"""Load shares at a rack force."""

LIMITS = {
    "equal": "without gaps and with constant stiffness",
    "B": "at rest in direction B",
    "A": "at rest in direction A",
}
"""Loads at which the flexible units reach their largest deformation."""


def quantities(design: CascadeDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    ranks = "Spearman's rank correlations of the stack-up of rack and pinion with "
    stack_up = "largest sample of the tolerance stack-up of"
    crossing = "lowest rack force at which the load shares of two pinions are equal,"
    braked = "load shares with the flywheel braked, direction"
    known = {
        "spearman_rack_pinion": Quantity(
            ranks + ", ".join(RANKED_TOLERANCES), count=len(RANKED_TOLERANCES)
        ),
        "largest_error_rack_pinion": Quantity(f"{stack_up} rack and pinion", "µm"),
        "largest_error_g1_g1": Quantity(f"{stack_up} two gears G1", "µm"),
        "first_crossing_static": Quantity(f"{crossing} at rest, direction B", "kN"),
        "first_crossing_dynamic": Quantity(f"{crossing} in motion, direction B", "kN"),
        "braked_B": Quantity(f"{braked} B", count=PINIONS),
        "braked_A": Quantity(f"{braked} A", count=PINIONS),
        **{name: Quantity(meaning) for name, meaning in SINGLE.items()},
        "natural_frequencies": Quantity(
            "natural frequencies, the first of the free rotation", "Hz", count=DOFS
        ),
        "best_even_units": Quantity(
            "flexible units whose place at the even pinions gives the least largest load share at "
            "rest, direction B",
            count=PAIRS,
        ),
        "largest_share_best_units": Quantity("largest load share at rest with these units"),
    }
    if design.flex_unit.largest_deformation is not None:
        for name, meaning in LIMITS.items():
            limit = f"when the first flexible unit has its largest deformation, {meaning}"
            known[f"limit_load_{name}"] = Quantity(f"pinion loads {limit}", "kN", count=PINIONS)
            known[f"limit_total_{name}"] = Quantity(f"rack force {limit}", "kN")
    for force in design.load.forces:
        for name, meaning in AT_FORCE.items():
            count = 2 if name in ("static_equal_B", "dynamic_mean_B") else PINIONS
            shares = f"load shares {meaning.format(force)}"
            known[f"{name}_{number_label(force)}"] = Quantity(shares, count=count)
        for side in ("B", "A"):
            known[f"lateral_{side}_{number_label(force)}"] = Quantity(
                f"force across the rack at rest at {force:g} kN, direction {side}", "kN"
            )
    return known


def derived(design: CascadeDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    units, displacements, mass = FlexUnits.of(design), rigid_displacements(design), masses(design)
    frequencies, radius = natural_frequencies(design), design.radius("pinion")
    reduced = mass * displacements**2
    backlash = 1e3 * radius * path_gap_angles(design, "B")
    values = {
        "speed ratio of flywheel and pinions": design.ratio,
        "pitch radius of the pinions (mm)": 1e3 * radius,
        "mass of all gears reduced to the rack (kg)": reduced.sum(),
        "mass of the flywheel reduced to the rack (kg)": reduced[FLYWHEEL],
        "stiffness of a flexible unit at the pinion (N/mm)": 1e-3 * units.stiffness / radius**2,
        "backlash of the path of odd pinions in direction B (mm)": backlash[0],
        "backlash of the path of even pinions in direction B (mm)": backlash[1],
        "lowest natural frequency (Hz)": frequencies[1],
        "highest natural frequency (Hz)": frequencies[-1],
    }
    for kind in MESH_COUNTS:
        values[f"standard deviation of {kind} errors (µm)"] = 1e6 * standard_deviation(design, kind)
    return {name: float(value) for name, value in values.items()}

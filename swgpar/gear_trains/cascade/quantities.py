"""Quantities of a cascade gearbox: results that can be compared with published values, derived
values of the design."""

from __future__ import annotations

from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS, FLYWHEEL, masses, rigid_displacements
from swgpar.gear_trains.cascade.static_sharing import MESH_COUNTS, path_gap_angles
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


def quantities(design: CascadeDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    known = {
        "spearman_rack_pinion": Quantity(
            f"Spearman's rank correlations of the stack-up of rack and pinion with "
            f"{', '.join(RANKED_TOLERANCES)}",
            count=len(RANKED_TOLERANCES),
        ),
        "largest_error_rack_pinion": Quantity(
            "largest sample of the tolerance stack-up of rack and pinion", "µm"
        ),
        "largest_error_g1_g1": Quantity(
            "largest sample of the tolerance stack-up of two gears G1", "µm"
        ),
        "first_crossing_static": Quantity(
            "lowest rack force at which the load shares of two pinions are equal, at rest, "
            "direction B",
            "kN",
        ),
        "first_crossing_dynamic": Quantity(
            "lowest rack force at which the load shares of two pinions are equal, in motion, "
            "direction B",
            "kN",
        ),
        "braked_B": Quantity("load shares with the flywheel braked, direction B", count=PINIONS),
        "braked_A": Quantity("load shares with the flywheel braked, direction A", count=PINIONS),
        "overloaded_static": Quantity("number of gearboxes overloaded at rest"),
        "overloaded_dynamic": Quantity(
            "number of gearboxes overloaded at any time at constant rack force"
        ),
        "largest_static_share": Quantity("largest load share at rest of all gearboxes with errors"),
        "largest_dynamic_mean_share": Quantity(
            "largest mean load share in motion of all gearboxes with errors"
        ),
        "largest_dynamic_share": Quantity(
            "largest load share at any time at constant rack force, all gearboxes with errors"
        ),
        "natural_frequencies": Quantity(
            "natural frequencies, the first of the free rotation", "Hz", count=DOFS
        ),
    }
    for force in design.load.forces:
        name = number_label(force)
        known[f"static_B_{name}"] = Quantity(
            f"load shares at rest at {force:g} kN, direction B", count=PINIONS
        )
        known[f"static_A_{name}"] = Quantity(
            f"load shares at rest at {force:g} kN, direction A", count=PINIONS
        )
        known[f"static_equal_B_{name}"] = Quantity(
            f"load shares at rest at {force:g} kN, odd and even pinions, equal flexible units",
            count=2,
        )
        known[f"dynamic_B_{name}"] = Quantity(
            f"load shares in motion at {force:g} kN, direction B", count=PINIONS
        )
        known[f"dynamic_mean_B_{name}"] = Quantity(
            f"load shares in motion at {force:g} kN, means of odd and even pinions", count=2
        )
    return known


def derived(design: CascadeDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    units, displacements, mass = FlexUnits.of(design), rigid_displacements(design), masses(design)
    frequencies = natural_frequencies(design)
    backlash = 1e3 * design.radius("pinion") * path_gap_angles(design, "B")
    out = {
        "speed ratio of flywheel and pinions": design.ratio,
        "pitch radius of the pinions (mm)": 1e3 * design.radius("pinion"),
        "mass of all gears reduced to the rack (kg)": float(mass @ displacements**2),
        "mass of the flywheel reduced to the rack (kg)": float(
            mass[FLYWHEEL] * displacements[FLYWHEEL] ** 2
        ),
        "stiffness of a flexible unit at the pinion (N/mm)": 1e-3
        * units.stiffness
        / design.radius("pinion") ** 2,
        "backlash of the path of odd pinions in direction B (mm)": backlash[0],
        "backlash of the path of even pinions in direction B (mm)": backlash[1],
        "lowest natural frequency (Hz)": frequencies[1],
        "highest natural frequency (Hz)": frequencies[-1],
    }
    for kind in MESH_COUNTS:
        out[f"standard deviation of {kind} errors (µm)"] = 1e6 * standard_deviation(design, kind)
    return {name: float(value) for name, value in out.items()}

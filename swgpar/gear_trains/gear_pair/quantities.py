"""What a run of a gear pair gives by name, and values derived from its design."""

from __future__ import annotations

from itertools import product

from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.model import mesh_force, pair_modes
from swgpar.gear_trains.published import SAMPLING_ERROR, STATISTICS
from swgpar.results.quantity import Quantity
from swgpar.vibration.linearisation import EQUIVALENT

VALUES = {
    "gear_1_displacement": "displacement y1 of gear 1",
    "gear_2_displacement": "displacement y2 of gear 2",
    "relative_rotation": "relative rotation z = r1 θ1 - r2 θ2",
    "mesh_deflection": "mesh deflection y1 - y2 + z",
}
"""Coordinates and the mesh deflection, all along the line of action: name -> meaning; all in m."""


def quantities(design: GearPairDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    known = {"sampling_error_percent": SAMPLING_ERROR}
    for case in range(1, len(design.load.input) + 1):
        share = f"share of samples of case {case}"
        known[f"out_of_contact_{case}"] = Quantity(f"{share} out of contact at the end")
        known[f"back_flank_{case}"] = Quantity(f"{share} in contact on the back flank at the end")
        for (kind, statistic), method, (name, meaning) in product(
            STATISTICS.items(), EQUIVALENT, VALUES.items()
        ):
            known[f"error_{kind}_{method}_{name}_{case}"] = Quantity(
                f"error of the {method}-based {statistic} of the {meaning} against Monte Carlo, "
                f"case {case}",
                "%",
            )
    return known


def derived(design: GearPairDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    frequencies, ratios = pair_modes(design)
    values = {f"natural frequency {k} (rad/s)": w for k, w in enumerate(frequencies, start=1)}
    values |= {f"damping ratio {k}": ratio for k, ratio in enumerate(ratios, start=1)}
    for case in range(len(design.load.input)):
        values[f"mesh force of case {case + 1} (N)"] = mesh_force(design, case)
    values["time step times the highest frequency"] = design.step * frequencies[-1]
    return {name: float(value) for name, value in values.items()}

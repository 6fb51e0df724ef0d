"""Quantities of a drive that studies tabulate: their names, meanings and units, and their values in a summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.summary import MEANS, PANCAKE_STRESSES
from swgpar.evaluation.program_results import COLUMNS as PROGRAM_COLUMNS
from swgpar.load.load_states import Stage
from swgpar.results.history import COLUMNS, columns_of
from swgpar.systems.protocol import Quantity

MAIN = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")
"""Columns whose means over the rotation tables and figures show."""

STEP_COLUMNS = tuple(
    column.name
    for drives in ("all", "wave generator fixed")
    for column in columns_of(drives)
    if column.name not in ("step", "wall_s")
)
"""Columns of the history that are quantities at the ends of the steps."""

GROUPS = range(Stage.DEFLECT, Stage.ROTATE + 1)
"""Steps with quantities of their own; all increments of the rotation count as the last one."""


RESOLVED = {
    "root.s1": Quantity("largest tension at the teeth under load, by windows", "MPa"),
    "root.s1_error": Quantity("its error by the windows and by the mesh of the drive", "MPa"),
    "root.mean_s1": Quantity("the same over one period, mean", "MPa"),
    "contact.pressure": Quantity("largest pressure of the flanks under load, off edges", "MPa"),
    "contact.on_edge": Quantity("whether a contact under load lies on an edge: 1 or 0", ""),
}
"""Quantities of runs with `output.root_stress`, which a study has to set."""

SHARING = {
    "sharing.pairs": Quantity("pairs of flanks in contact, mean over the rotation", ""),
    "sharing.largest_pairs": Quantity("pairs of flanks in contact, most over the rotation", ""),
    "sharing.teeth_share": Quantity("share of the flexible spline's teeth in contact, mean over the rotation", ""),
    "sharing.largest_force_share": Quantity("largest share of one tooth in the force of all pairs", ""),
    "sharing.largest_force": Quantity("largest force of one pair", "N"),
    "sharing.largest_line_load": Quantity("largest line load of one pair", "N/mm"),
}
"""Quantities of the load sharing."""

FATIGUE = {
    "fatigue.goodman": Quantity("least safety factor by Goodman", ""),
    "fatigue.crossland": Quantity("least safety factor by Crossland", ""),
    "fatigue.yield": Quantity("least safety factor against yield", ""),
    "fatigue.amplitude": Quantity("amplitude of the normal stress where Goodman's safety is the least", "MPa"),
    "fatigue.mean": Quantity("its mean", "MPa"),
    "fatigue.life_turns": Quantity("life by Basquin, turns of the wave generator", ""),
    "fatigue.life_hours": Quantity("life by Basquin", "h"),
}
"""Quantities of designs with [fatigue]; a life without end is left out."""

PROGRAM_FATIGUE = {
    **{name: quantity for name, quantity in FATIGUE.items() if "life" not in name},
    "fatigue.life_programs": Quantity("life by Basquin, passages of the load program", ""),
}
"""Quantities of designs with [fatigue] and a load program."""

LOSSES = {
    "losses.torque": Quantity("input torque that the losses take", "N·mm"),
    "losses.flank_friction": Quantity("its part by friction of the flanks", "N·mm"),
    "losses.hysteresis": Quantity("its part by hysteresis of the flexible spline", "N·mm"),
    "losses.bearing": Quantity("its part by friction of the wave generator's bearing", "N·mm"),
    "losses.efficiency": Quantity("efficiency", ""),
}
"""Quantities of designs with [losses]; without a torque there is no efficiency."""


STIFFNESS = {
    "stiffness.K1": Quantity("torsional stiffness up to the first break point", "N·m/rad"),
    "stiffness.K2": Quantity("torsional stiffness between the break points", "N·m/rad"),
    "stiffness.K3": Quantity("torsional stiffness above the second break point", "N·m/rad"),
    "stiffness.lost_motion": Quantity("lost motion", "arc minutes"),
    "stiffness.hysteresis": Quantity("width of the loop at zero torque", "arc minutes"),
    "stiffness.backlash": Quantity("rotation without torque between the flanks", "arc minutes"),
    "stiffness.loop_work": Quantity("area of the loop", "N·mm"),
}
"""Quantities of designs with [stiffness]: means over the positions. Names end as in the summary."""

RATCHETING = {
    "ratcheting.peak_torque_Nm": Quantity("largest torque of the output", "N·m"),
    "ratcheting.peak_rotation_deg": Quantity("rotation of the output there", "deg"),
}
"""Quantities of designs with [ratcheting]. Names end as in the summary."""


TRANSMISSION = {
    "transmission_error.peak_to_peak": Quantity("transmission error, peak to peak", "arcsec"),
    "transmission_error.amplitude": Quantity("transmission error, half of peak to peak", "arcsec"),
    "transmission_error.torque_mean": Quantity("torque of the wave generator over the same angles, mean", "N·mm"),
    "transmission_error.torque_peak_to_peak": Quantity(
        "torque of the wave generator over the same angles, peak to peak", "N·mm"
    ),
}
"""Quantities of runs with `steps.samples`, over their period, and of those with [deviations], over whole turns."""


BEARING = {
    "bearing.largest_load": Quantity("largest ball load under load", "N"),
    "bearing.pressure": Quantity("largest pressure of a ball on a race under load", "MPa"),
    "bearing.mean_load": Quantity("mean ball load under load", "N"),
    "bearing.load_ripple": Quantity("range of the largest ball load over its mean", ""),
    "bearing.torsional_share": Quantity("share of the bearing in the torsional compliance", ""),
    "bearing.radial_share": Quantity("share of the bearing in the radial compliance", ""),
    "bearing.life_turns": Quantity("rating life L10 of the bearing, turns of the wave generator", ""),
    "bearing.life_hours": Quantity("rating life L10 of the bearing", "h"),
}
"""Quantities of drives with a bearing."""

HOUSING = {
    "housing.s1": Quantity("largest tension in the housing under load", "MPa"),
    "housing.vm": Quantity("largest von Mises stress in the housing under load", "MPa"),
    "housing.bulge": Quantity("largest radial displacement of the ring gear's outer surface under load", "µm"),
}
"""Quantities of drives with an elastic housing."""


def quantities(design: DriveDesign) -> dict[str, Quantity]:
    """Known quantities of a design: "mean.fs_s1" over the rotation, "step1.fs_s1" at the end of a step, and so on."""

    def quantity(column: str, when: str) -> Quantity:
        return Quantity(f"{COLUMNS[column].label or column}, {when}", COLUMNS[column].unit)

    if design.has_program:
        further = (PROGRAM_FATIGUE if design.fatigue else {}) | (BEARING if design.bearing else {})
        return program_quantities(design) | further | (HOUSING if design.housing else {})
    stresses = () if design.dynamic_spline is None else PANCAKE_STRESSES
    known = {f"mean.{name}": quantity(name, "mean over the rotation") for name in (*MEANS, *stresses)}
    if design.resolves_root_stress:
        known |= RESOLVED
    known |= SHARING
    for section, names in ((design.fatigue, FATIGUE), (design.losses, LOSSES)):
        known |= names if section else {}
    known |= TRANSMISSION
    for section, names in ((design.bearing, BEARING), (design.housing, HOUSING)):
        known |= names if section else {}
    columns = list(STEP_COLUMNS)
    if design.wave_generator_is_fixed:
        known["input.torque"] = Quantity("torque of the driven ring gear, mean over the rotation", "N·mm")
    else:
        columns = [name for name in columns if COLUMNS[name].drives == "all"]
    return known | {f"step{k}.{name}": quantity(name, f"end of step {k}") for k in GROUPS for name in columns}


def main_quantities(known: Mapping[str, Quantity]) -> tuple[str, ...]:
    """Names of those of `quantities` that tables and figures show."""
    for group in (STIFFNESS, RATCHETING):
        if group.keys() <= known.keys():
            return tuple(group)
    if "mean.fs_s1" not in known:
        return tuple(name for name in known if name.endswith((".torque_Nm", ".rotation_arcmin")))
    return tuple(f"mean.{name}" for name in MAIN)


def describe_names(known: Mapping[str, Quantity]) -> str:
    """What a refusal of an unknown name says is allowed, of `quantities`."""
    if "mean.fs_s1" not in known:
        return ", ".join(known)
    names = f"mean. with {', '.join(MEANS)}, or step1. to step{GROUPS[-1]}. with a column of history.csv"
    names = f"{names}; {', '.join(SHARING)}; with [fatigue] {', '.join(FATIGUE)}; with [losses] {', '.join(LOSSES)}"
    names += f", or {', '.join(TRANSMISSION)}"
    names += f"; with output.root_stress = true {', '.join(RESOLVED)}; with a bearing {', '.join(BEARING)}"
    return f"{names}; with a housing {', '.join(HOUSING)}"


def program_quantities(design: DriveDesign) -> dict[str, Quantity]:
    """Quantities of a design with a load program: at the end of its stages, or of what is generated from it."""
    if design.stiffness:
        return STIFFNESS
    if design.ratcheting:
        return RATCHETING
    return {
        f"program.{stage.name}.{name}": Quantity(f"{name} at the end of {stage.name}", unit)
        for stage in design.load.program
        for name, unit in PROGRAM_COLUMNS.items()
        if name not in ("step", "stage")
    }


def measured(
    summary: Mapping[str, Any], history: Mapping[str, np.ndarray], pairs: Mapping[str, np.ndarray]
) -> dict[str, float]:
    """Values of all quantities of a run. history, pairs : columns of history.csv and pairs.csv"""
    driven = summary.get("input")
    return {
        **values(summary["means"], history),
        **resolved(summary, pairs),
        **sharing(summary),
        **cycle_values(summary),
        **of_program(summary),
        **of_bearing(summary),
        **of_housing(summary),
        **transmission(summary),
        **({"input.torque": driven["torque_Nmm"]} if driven else {}),
    }


def resolved(summary: Mapping[str, Any], pairs: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The quantities of `RESOLVED`, without those that the run does not have."""
    root, contact, found = summary["root_stress"], summary["contact"], {}
    if root:
        found |= {"root.s1": root["s1"], "root.s1_error": root["total_error"]}
        if root["over_period"]:
            found["root.mean_s1"] = root["over_period"]["mean"]
    if contact:
        found["contact.on_edge"] = float(np.any(pairs["edge"]))
        if not contact["edge"]:
            found["contact.pressure"] = contact["pressure_MPa"]
    return found


def sharing(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of `SHARING`, without those that the run does not have."""
    found = summary["load_sharing"]
    if not found:
        return {}
    known = {
        "sharing.pairs": found["pairs"]["mean"],
        "sharing.largest_pairs": found["pairs"]["largest"],
        "sharing.teeth_share": found["teeth_share"]["mean"],
        "sharing.largest_force_share": found["largest_force_share"],
        "sharing.largest_force": found["largest_force_N"],
        "sharing.largest_line_load": found["largest_line_load_Nmm"],
    }
    return {name: value for name, value in known.items() if value is not None}


def cycle_values(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of `FATIGUE` and `LOSSES`, without those that the run does not have."""
    found: dict[str, float | None] = {}
    if fatigue := summary.get("fatigue"):
        worst = fatigue["goodman"]
        found |= {
            "fatigue.goodman": worst["safety"],
            "fatigue.crossland": fatigue["crossland"]["safety"],
            "fatigue.yield": fatigue["yield"]["safety"],
            "fatigue.amplitude": worst["amplitude_MPa"],
            "fatigue.mean": worst["mean_MPa"],
            "fatigue.life_turns": fatigue["life_turns"],
            "fatigue.life_hours": fatigue["life_hours"],
            "fatigue.life_programs": fatigue.get("life_programs"),
        }
    if losses := summary.get("losses"):
        found |= {"losses.torque": losses["loss_torque_Nmm"], "losses.efficiency": losses["efficiency"]}
        found |= {f"losses.{name}": value for name, value in losses["parts_Nmm"].items()}
    return {name: value for name, value in found.items() if value is not None}


def of_program(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of a load program, without those that the run does not have."""
    for group in (STIFFNESS, RATCHETING):
        section = next(iter(group)).partition(".")[0]
        if summary[section]:
            return {name: summary[section][name.partition(".")[2]] for name in group}
    stages = summary["program"] or {}
    return {
        f"program.{stage}.{name}": value
        for stage, row in stages.items()
        for name, value in row.items()
        if name != "step"
    }


def transmission(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of `TRANSMISSION`; none of a run that has no transmission error over a period or a turn."""
    found = summary["transmission_error"]
    if not found:
        return {}
    torque = {f"transmission_error.torque_{name}": found["torque"][name] for name in ("mean", "peak_to_peak")}
    return {f"transmission_error.{name}": found[name] for name in ("peak_to_peak", "amplitude")} | torque


def of_housing(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of `HOUSING`; none of a run without one, or without a load."""
    found = summary.get("housing")
    if not found:
        return {}
    return {"housing.s1": found["s1_MPa"], "housing.vm": found["vm_MPa"], "housing.bulge": found["bulge_um"]}


def of_bearing(summary: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of `BEARING`, without those that the run does not have."""
    bearing = summary.get("bearing")
    if not bearing:
        return {}
    found = {
        "largest_load": bearing["largest_load_N"],
        "pressure": bearing["largest_pressure_MPa"],
        "mean_load": bearing["mean_load_N"],
        "load_ripple": bearing["load_ripple"],
        "torsional_share": bearing["torsional_share"] and bearing["torsional_share"]["bearing"],
        "radial_share": bearing["radial_share"] and bearing["radial_share"]["bearing"],
        "life_turns": bearing["life"]["L10_turns"],
        "life_hours": bearing["life"]["L10_hours"],
    }
    return {f"bearing.{name}": value for name, value in found.items() if value is not None}


def values(means: Mapping[str, float], history: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Quantities of a run from its means and its history, without those of steps that it does not have."""
    found = {f"mean.{name}": value for name, value in means.items()}
    group = np.minimum(history["step"], GROUPS[-1])
    for k in GROUPS:
        for last in np.flatnonzero(group == k)[-1:]:
            found |= {f"step{k}.{name}": float(history[name][last]) for name in STEP_COLUMNS if name in history}
    return found

"""report.html: what a run of a drive gives, on one page that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.report_checks import checks
from swgpar.evaluation.places import OF_REGION
from swgpar.presentation.drive_drawing import draw_drive
from swgpar.presentation.scene import SCRIPT, scene
from swgpar.results.page import Row, Table
from swgpar.results.result_page import result_page

if TYPE_CHECKING:
    from swgpar.drive_results.drive_result import DriveResult

WIDE = ("contact_pattern", "deformed_drive", "loaded_teeth", "cup_section", "safety")
"""Figures that take the width of the page."""

SECTIONS = {
    "stiffness": "torsional stiffness, lost motion, hysteresis ([stiffness])",
    "ratcheting": "ratcheting torque ([ratcheting])",
    "fatigue": "safety and life ([fatigue])",
    "losses": "losses and efficiency ([losses])",
    "bearing": "ball loads and life of the bearing ([wave_generator.bearing])",
    "root_stress": "tension at the teeth with its error (output.root_stress)",
}
"""What a run computes when the design asks for it: entry of the summary -> what it is, and its key."""

FIXED = {
    "ring_fixed": "ring gear fixed",
    "spline_fixed": "flexible spline fixed",
    "wave_generator_fixed": "wave generator fixed, ring gear driven",
}


TEMPLATE = "presentation/drive_report.html.j2"


def drive_report(result: DriveResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary = result.summary
    design = DriveDesign.model_validate(summary["design"])
    view = scene(result)
    found = checks(design, summary, result.history)
    return result_page(
        TEMPLATE,
        f"Strain wave gear {design.drive.teeth_fs}/{design.drive.teeth_rg}, {design.load.torque:g} N·m",
        summary,
        result.folder,
        result.plot.names,
        wide=WIDE,
        scripts=(SCRIPT,) if view else (),
        description=_description(summary),
        look=[check.name for check in found if check.good is False],
        drawings=draw_drive(design),
        answers=Table(["", "value", "unit", "error", "where"], [Row(row) for row in answers(summary)]),
        not_asked=_not_asked(design, summary),
        places=_places(summary["places"]) if summary["places"] else None,
        resolved=bool(summary["root_stress"]),
        # results of earlier versions have none
        regions=_regions(summary["regions"]) if summary.get("regions") else None,
        checks=found,
        scene=view,
        plane=result.is_plane,
    )


def _description(summary: Mapping[str, Any]) -> str:
    drive = summary["design"]["drive"]
    model = {"plane": "plane model", "cup": "cup drive", "pancake": "pancake drive"}[drive["model"]]
    mesh = f"mesh {Path(summary['recipe']).stem}, " if summary["recipe"] else ""
    return (
        f"{model}, ratio {summary['ratio']:g}, {FIXED[drive['layout']]}; {mesh}{summary['elements']} elements, "
        f"{summary['increments']} increments."
    )


def answers(summary: Mapping[str, Any]) -> list[list[Any]]:
    """Rows of what, value, unit, error and where, for what the run has."""
    rows: list[list[Any]] = []

    def add(what: str, value: Any, unit: str = "", error: float | None = None, where: str = "") -> None:
        if value is not None:
            rows.append([what, float(value), unit, _error(error), where])

    if root := summary["root_stress"]:
        add("largest tension at the teeth, s1", root["s1"], "MPa", root["total_error"], _where(root))
        if over := root["over_period"]:
            add("the same, mean over a period", over["mean"], "MPa", over["mean_error"])
    if contact := summary["contact"]:
        where = (
            f"tooth {contact['tooth']}, {contact['flank']} flank, radius {contact['radius_mm']:.2f} mm, "
            f"z {contact['z_mm']:.2f} mm{'; on an edge: no property of the drive' if contact['edge'] else ''}"
        )
        add("largest contact pressure of the flanks", contact["pressure_MPa"], "MPa", None, where)
    if sharing := summary["load_sharing"]:
        pairs = sharing["pairs"]
        span = f"{pairs['smallest']:.0f} to {pairs['largest']:.0f}"
        add("pairs of flanks in contact", pairs["mean"], "", None, span)
        add("teeth in contact", 100.0 * sharing["teeth_share"]["mean"], "%")
        add("largest share of one tooth in the force", 100.0 * sharing["largest_force_share"], "%")
        add("largest force of one pair", sharing["largest_force_N"], "N")
    driven = summary.get("input") or {}
    if driven:
        add("mean torque on the wave generator, which stands", summary["means"].get("wg_torque_Nmm"), "N·mm")
    add("mean input torque", driven.get("torque_Nmm", summary["means"].get("wg_torque_Nmm")), "N·mm")
    if summary["torque_ripple"] is not None:
        add("input torque, largest less smallest over mean", 100.0 * summary["torque_ripple"], "%")
    deviates = summary["design"].get("deviations") is not None
    ideal = ", of the ideal drive" if deviates else ""
    add(f"transmission error, peak to peak{ideal}", summary["transmission_error_arcsec"], "arc seconds")
    if deviates and (turns := summary["transmission_error"]):
        add("the same with deviations, over whole turns", turns["peak_to_peak"], "arc seconds")
    if stiffness := summary["stiffness"]:
        error = stiffness["mesh_error"] or {}
        for name in ("K1", "K2", "K3"):
            add(f"torsional stiffness {name}", stiffness[name], "N·m/rad", error.get(name))
        for name in ("lost_motion", "hysteresis", "backlash"):
            add(name.replace("_", " "), stiffness[name], "arc minutes", error.get(name))
    if ratcheting := summary["ratcheting"]:
        add("largest torque of the output", ratcheting["peak_torque_Nm"], "N·m", None, ratcheting["gave_way"])
    if fatigue := summary.get("fatigue"):
        for name in ("goodman", "crossland", "yield"):
            error = fatigue["mesh_error"] if name == "goodman" else None
            add(f"least safety, {name}", fatigue[name]["safety"], "", error, fatigue[name]["region"])
        add("life", fatigue["life_hours"], "h")
    if losses := summary.get("losses"):
        add("torque of the losses", losses["loss_torque_Nmm"], "N·mm")
        if losses["efficiency"]:
            add("efficiency", 100.0 * losses["efficiency"], "%")
    if bearing := summary.get("bearing"):
        where = f"{bearing['cam_angle_deg']:.0f} degrees from the major axis"
        add("largest ball load", bearing["largest_load_N"], "N", None, where)
        add("rating life of the bearing, L10", bearing["life"]["L10_hours"], "h")
    if housing := summary.get("housing"):
        add("largest von Mises stress in the housing", housing["vm_MPa"], "MPa")
        add("largest radial displacement of the ring gear's outer surface", housing["bulge_um"], "µm")
    return rows


def _not_asked(design: DriveDesign, summary: Mapping[str, Any]) -> list[str]:
    """What the design does not ask for, with the key that does."""
    refused = ("root_stress",) if design.output.root_stress else ()  # asked for, and not available
    return [text for name, text in SECTIONS.items() if not summary.get(name) and name not in refused]


def _where(place: Mapping[str, Any]) -> str:
    region = place["region"] if place["region"] == "inside the tooth" else f"{place['region']} of tooth"
    return (
        f"{region.replace('the tooth', 'tooth')} {place['tooth']}, radius {place['radius']:.2f} mm, "
        f"z {place['z']:.2f} mm, {place['angle_deg']:.1f} degrees from +y"
    )


NO_ERROR = "no estimate of the error on this mesh"

STRESSES = {"s1": "tension s1", "s3": "compression |s3|", "vm": "von Mises"}
BODIES = {"fs": "flexible spline", "rg": "ring gear"}


def _places(places: Mapping[str, Mapping[str, Any]]) -> Table:
    rows = []
    for name, place in places.items():
        body, stress, *apart = name.split("_")
        what = f"{BODIES.get(body, body)}, {STRESSES.get(stress, stress)}" + (
            ", apart from the contact" if apart else ""
        )
        remark = place["warning"] or ("" if place.get("error") is not None else NO_ERROR)
        cells = [what, float(place["value"]), "MPa", _error(place.get("error")), _where(place), remark]
        rows.append(Row(cells))
    return Table(["nodal average", "value", "unit", "error", "where", "remark"], rows)


def _regions(regions: Mapping[str, Mapping[str, Any]]) -> Table:
    found: dict[tuple[str, str], dict[str, Mapping[str, Any]]] = {}
    for name, place in regions.items():
        stress, region = name.split(OF_REGION)
        body, stress = stress.split("_")
        found.setdefault((body, region), {})[stress] = place
    rows = []
    for (body, region), places in found.items():
        cells: list[Any] = [f"{BODIES[body]}, {region}"]
        for stress in ("s1", "vm"):
            place = places.get(stress)
            cells += [float(place["value"]), _error(place["error"])] if place else [None, ""]
        shown = places.get("vm") or places["s1"]
        rows.append(Row([*cells, _where(shown), shown["warning"]]))
    heads = ["region", "s1 (MPa)", "error", "von Mises (MPa)", "error", "where von Mises is", "depends on the mesh"]
    return Table(heads, rows)


def _error(value: float | None) -> str:
    """An error with two digits, without a power of ten and without a break of the line."""
    if value is None:
        return ""
    digits = 1 - int(np.floor(np.log10(value))) if value > 0.0 else 0
    return f"±\u00a0{round(value, digits):.{max(digits, 0)}f}"

"""report.html: what a run of a drive gives, on one page that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.report_checks import Check, checks
from swgpar.evaluation.places import OF_REGION
from swgpar.presentation import scene
from swgpar.presentation.drive_drawing import DRAWING_STYLE, draw_drive
from swgpar.results.html_page import page, table
from swgpar.results.result_page import STYLE as RESULT_STYLE
from swgpar.results.result_page import cards, figures, inputs, versions

if TYPE_CHECKING:
    from swgpar.drive_results.drive_result import DriveResult

STYLE = (
    RESULT_STYLE
    + DRAWING_STYLE
    + scene.STYLE
    + """
.drawings { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22em), 1fr)); gap: 1em; }
.ok { color: #176b17; font-weight: bold; } .look { color: #a40000; font-weight: bold; } .none { color: #666; }
.checks td:nth-child(2) { white-space: nowrap; }
"""
)

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

VERDICTS = {
    True: '<span class="ok">good</span>',
    False: '<span class="look">look</span>',
    None: '<span class="none">not judged</span>',
}


FIXED = {
    "ring_fixed": "ring gear fixed",
    "spline_fixed": "flexible spline fixed",
    "wave_generator_fixed": "wave generator fixed, ring gear driven",
}


def drive_report(result: DriveResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary = result.summary
    design = DriveDesign.model_validate(summary["design"])
    found = checks(design, summary, result.history)
    drive = summary["design"]["drive"]
    title = f"Strain wave gear {drive['teeth_fs']}/{drive['teeth_rg']}, {summary['design']['load']['torque']:g} N·m"
    parts = [f"<h1>{escape(title)}</h1>", _introduction(summary, found)]
    parts += ['<h2>The drive</h2><div class="drawings">', *draw_drive(design), "</div>"]
    parts += [
        "<h2>Answers</h2>",
        cards(["", "value", "unit", "error", "where"], ((row, False) for row in answers(summary))),
        *_not_asked(design, summary),
    ]
    if summary["places"]:
        resolved = f" {RESOLVED}" if summary["root_stress"] else ""
        parts += ["<h3>Largest stresses under load</h3>", f"<p>{NODAL}{resolved}</p>", _places(summary["places"])]
    if summary.get("regions"):  # results of earlier versions have none
        parts += ["<h3>Largest stresses by region</h3>", f"<p>{BY_REGION}</p>", _regions(summary["regions"])]
    parts += ["<h2>Checks</h2>", _checks(found)]
    if drawn := figures(result.folder, result.plot.names, WIDE):
        parts += ["<h2>Figures</h2>", drawn]
    view = scene.scene(result)
    if view:
        parts += ["<h2>View</h2>", view]
    parts += ["<h2>Inputs</h2>", inputs(summary["design"]), "<h2>Program</h2>", versions(summary)]
    return page(title, parts, STYLE)


def _introduction(summary: Mapping[str, Any], found: Iterable[Check]) -> str:
    drive = summary["design"]["drive"]
    look = [check.name for check in found if check.good is False]
    model = {"plane": "plane model", "cup": "cup drive", "pancake": "pancake drive"}[drive["model"]]
    fixed = FIXED[drive["layout"]]
    mesh = f"mesh {Path(summary['recipe']).stem}, " if summary["recipe"] else ""
    verdict = f"Look at: {', '.join(look)}." if look else "All checks that can be judged are good."
    return (
        f"<p>{model}, ratio {summary['ratio']:g}, {fixed}; {escape(mesh)}{summary['elements']} elements, "
        f"{summary['increments']} increments.</p><p class={'bad' if look else 'ok'}>{escape(verdict)}</p>"
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
    missing = [text for name, text in SECTIONS.items() if not summary.get(name) and name not in refused]
    return [f"<p>Not asked for: {escape('; '.join(missing))}.</p>"] if missing else []


def _where(place: Mapping[str, Any]) -> str:
    region = place["region"] if place["region"] == "inside the tooth" else f"{place['region']} of tooth"
    return (
        f"{region.replace('the tooth', 'tooth')} {place['tooth']}, radius {place['radius']:.2f} mm, "
        f"z {place['z']:.2f} mm, {place['angle_deg']:.1f} degrees from +y"
    )


NODAL = (
    "Averages over elements on the mesh of the drive, the largest of all increments under load. Errors are those by "
    "this mesh."
)
RESOLVED = "The tension at the teeth above is resolved on finer meshes of a few teeth."
BY_REGION = "Averages over elements as well. Without an error there is no estimate of it on this mesh."
NO_ERROR = "no estimate of the error on this mesh"

STRESSES = {"s1": "tension s1", "s3": "compression |s3|", "vm": "von Mises"}
BODIES = {"fs": "flexible spline", "rg": "ring gear"}


def _places(places: Mapping[str, Mapping[str, Any]]) -> str:
    rows = []
    for name, place in places.items():
        body, stress, *apart = name.split("_")
        what = f"{BODIES.get(body, body)}, {STRESSES.get(stress, stress)}" + (
            ", apart from the contact" if apart else ""
        )
        remark = place["warning"] or ("" if place.get("error") is not None else NO_ERROR)
        cells = [what, float(place["value"]), "MPa", _error(place.get("error")), _where(place), remark]
        rows.append((cells, False))
    return cards(["nodal average", "value", "unit", "error", "where", "remark"], rows)


def _regions(regions: Mapping[str, Mapping[str, Any]]) -> str:
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
        rows.append(([*cells, _where(shown), shown["warning"]], False))
    heads = ["region", "s1 (MPa)", "error", "von Mises (MPa)", "error", "where von Mises is", "depends on the mesh"]
    return table(heads, rows)


def _error(value: float | None) -> str:
    """An error with two digits, without a power of ten and without a break of the line."""
    if value is None:
        return ""
    digits = 1 - int(np.floor(np.log10(value))) if value > 0.0 else 0
    return f"±\u00a0{round(value, digits):.{max(digits, 0)}f}"


def _checks(found: Iterable[Check]) -> str:
    rows = "".join(
        f"<tr><td class=text>{escape(check.name)}</td><td class=text>{VERDICTS[check.good]}</td>"
        f"<td class=text>{escape(check.text)}</td></tr>"
        for check in found
    )
    head = "<tr><th class=text>check</th><th class=text>verdict</th><th class=text>numbers</th></tr>"
    return f'<div class="scroll cards"><table class="checks">{head}{rows}</table></div>'

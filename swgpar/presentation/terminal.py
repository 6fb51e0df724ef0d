"""What a user sees on the terminal after the run of a drive."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from rich import box
from rich.table import Table

from swgpar.log import console

COLUMNS = {
    "step": ("step", "d"),
    "wg_angle_deg": ("input", ".1f"),
    "output_angle_deg": ("output", ".4f"),
    "fs_s1": ("fs s1", ".1f"),
    "fs_s3": ("fs |s3|", ".1f"),
    "fs_vm": ("fs vm", ".1f"),
    "rg_vm": ("rg vm", ".1f"),
    "wg_torque_Nmm": ("torque", ".2f"),
    "pairs_in_contact": ("pairs", "d"),
    "newton_iterations": ("Newton", "d"),
}
"""Columns of the history: title and format of their values."""


NOTHING = 1e-6
"""Stiffness and lost motion below which 0 is printed: round-off, in arc minutes."""

ORDERS = 5
"""Orders of the transmission error that are shown."""


def print_drive(history: Mapping[str, np.ndarray], summary: Mapping[str, Any]) -> None:
    """Print history and summary of a run; call it on one rank."""
    _print_history({name: values[: summary["increments"]] for name, values in history.items()})
    if further := len(history["step"]) - summary["increments"]:
        end = history["wg_angle_deg"][-1]
        console.print(f"history.csv repeats this period: {further} further rows up to {end:.4g} degrees")
    if places := summary.get("places"):
        _print_places(places)
    if summary["means"]:
        _print_means(summary)
    if summary["stiffness"]:
        _print_stiffness(summary["stiffness"])
    if summary["ratcheting"]:
        _print_ratcheting(summary["ratcheting"])
    if turns := summary["transmission_error"]:
        _print_turns(turns)
    _print_errors(summary)
    console.print(
        f"torque balance error {summary['balance_error_Nmm']:.1e} N·mm; "
        f"{summary['wall_s']:.0f} s on {summary['ranks']} ranks"
    )


def _print_history(history: Mapping[str, np.ndarray]) -> None:
    driven = {"wg_angle_deg": "input_angle_deg", "wg_torque_Nmm": "input_torque_Nmm"}
    names = [driven.get(name, name) if driven.get(name) in history else name for name in COLUMNS]
    title = "largest stresses over the bodies (MPa, nodal averages); torque in N·mm, angles in degrees"
    table = Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))  # fits into 80 columns
    for heading, _ in COLUMNS.values():
        table.add_column(heading, justify="right", no_wrap=True)
    for values in zip(*(history[name] for name in names), strict=True):
        table.add_row(*(format(value, spec) for value, (_, spec) in zip(values, COLUMNS.values(), strict=True)))
    console.print(table)


def _print_means(summary: Mapping[str, Any]) -> None:
    means, driven = summary["means"], summary.get("input")
    of_wave_generator = f"{means['wg_torque_Nmm']:.2f} N·mm (energy balance {summary['wg_torque_expected_Nmm']:.2f})"
    torque = f"input torque {of_wave_generator}"
    if driven:
        torque = (
            f"input torque on the ring gear {driven['torque_Nmm']:.2f} N·mm (energy balance "
            f"{driven['torque_expected_Nmm']:.2f}), on the wave generator, which stands, {of_wave_generator}"
        )
    console.print(
        f"means over the rotation: flexible spline s1 {means['fs_s1']:.1f}, |s3| {means['fs_s3']:.1f}, von Mises "
        f"{means['fs_vm']:.1f} MPa; ring gear von Mises {means['rg_vm']:.1f} MPa; "
        f"{torque}"
    )
    if (ripple := summary["torque_ripple"]) is not None:
        console.print(
            f"over the rotation: input torque varies by {100.0 * ripple:.1f} % of its mean, transmission error by "
            f"{summary['transmission_error_arcsec']:.1f} arc seconds"
        )


def _print_stiffness(found: Mapping[str, Any]) -> None:
    spread, error = found["spread"], found["mesh_error"]

    def value(name: str, spec: str) -> str:
        size, by_mesh, over = (
            0.0 if abs(x) < NOTHING else x for x in (found[name], (error or found)[name], spread[name])
        )
        return f"{size:{spec}}{'' if error is None else f' ± {by_mesh:.2g}'} (spread {over:.2g})"

    console.print(
        f"torsional stiffness up to {found['torque_Nm']:g} N·m over {len(found['positions'])} positions, in N·m/rad: "
        + ", ".join(f"{name} {value(name, '.4g')}" for name in ("K1", "K2", "K3"))
    )
    console.print(
        "in arc minutes: "
        + ", ".join(
            f"{words} {value(name, '.3g')}"
            for name, words in (("lost_motion", "lost motion"), ("hysteresis", "hysteresis"), ("backlash", "backlash"))
        )
    )
    if error is None:
        console.print("the error of the stiffness by the mesh is not known")


def _print_ratcheting(found: Mapping[str, Any]) -> None:
    size = f"{found['peak_torque_Nm']:.4g} N·m" if found["is_peak"] else f"above {found['peak_torque_Nm']:.4g} N·m"
    console.print(
        f"largest torque of the output: {size} at {found['peak_rotation_deg']:.4g} degrees "
        f"({found['peak_rotation_pitches']:.2f} pitches); what gives way: {found['gave_way']}; "
        f"end of the run: {found['ended']}"
    )


def _print_turns(turns: Mapping[str, Any]) -> None:
    """Transmission error over whole turns, or over the period of the ideal drive."""
    where = f"{turns['turns']:.0f} turns with deviations" if turns["turns"] >= 1.0 else "one period of the ideal drive"
    console.print(
        f"transmission error over {where}: {turns['peak_to_peak']:.4g} arc seconds peak to peak; "
        f"torque of the wave generator {turns['torque']['mean']:.2f} N·mm, {turns['torque']['peak_to_peak']:.4g} peak "
        "to peak"
    )
    for line in turns["spectrum"][:ORDERS]:
        console.print(f"  order {line['order']:8.3f}: {line['amplitude']:.3g} arc seconds, {line['cause']}")


def _print_places(places: Mapping[str, Mapping[str, Any]]) -> None:
    """Where the largest stresses under load are, and which of them depend on the mesh."""
    table = Table(
        title="largest under load (MPa, nodal averages), error by the mesh, and where (mm, degrees)",
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
    )
    for heading in ("", "MPa", "error", "region", "tooth", "radius", "z", "angle"):
        table.add_column(heading, justify="left" if heading in ("", "region") else "right", no_wrap=True)
    for name, place in places.items():
        error = "" if place["error"] is None else f"{place['error']:.1f}"
        row = [name.replace("_", " "), f"{place['value']:.1f}", error]
        row.append(place["region"] + ("*" if place["warning"] else ""))
        row += [str(place["tooth"]), f"{place['radius']:.2f}", f"{place['z']:.2f}", f"{place['angle_deg']:.1f}"]
        table.add_row(*row)
    console.print(table)
    for warning in dict.fromkeys(place["warning"] for place in places.values() if place["warning"]):
        console.print(f"* {warning}")


def _print_mesh_error(error: Mapping[str, float]) -> None:
    """What the drive's mesh makes of the means of nodal averages."""
    names = {"fs_s1": "s1", "fs_s3": "|s3|", "fs_vm": "von Mises", "rg_vm": "von Mises of the ring gear"}
    known = ", ".join(f"{words} {error[name]:.0f}" for name, words in names.items() if name in error)
    unknown = " and ".join(words for name, words in names.items() if name not in error)
    if known:
        rest = f"; {unknown} without estimate" if unknown else ""
        console.print(f"errors of these means by the drive's mesh, up to (MPa): {known}{rest}")


def _print_contact(contact: Mapping[str, Any]) -> None:
    on = f" on the {contact['ring'].replace('_', ' ')}" if "ring" in contact else ""
    console.print(
        f"largest contact pressure of the flanks: {contact['pressure_MPa']:.0f} MPa at "
        f"{contact['line_load_Nmm']:.1f} N/mm (tooth {contact['tooth']}, {contact['flank']} flank{on}, radius "
        f"{contact['radius_mm']:.2f}, z {contact['z_mm']:.2f} mm; half width {contact['half_width_mm']:.4f} mm, "
        f"largest shear {contact['shear_MPa']:.0f} MPa)"
    )
    if contact["edge"]:
        console.print(
            "that contact lies on an edge: its pressure is no property of the drive, and the stress at the teeth "
            "may be off by more than its error"
        )


def _print_sharing(sharing: Mapping[str, Any]) -> None:
    pairs = sharing["pairs"]
    console.print(
        f"load sharing: {pairs['mean']:.3g} pairs in contact ({pairs['smallest']:.0f} to {pairs['largest']:.0f}), "
        f"{100.0 * sharing['teeth_share']['mean']:.3g} % of the teeth; one tooth carries up to "
        f"{100.0 * sharing['largest_force_share']:.3g} % of the force, one pair {sharing['largest_force_N']:.4g} N"
    )


def _print_fatigue(found: Mapping[str, Any], *, windows: bool) -> None:
    """windows : whether windows could resolve the stress at the teeth"""
    worst, other = found["goodman"], found["crossland"]
    error = ""  # that of the angles alone says little
    if found["mesh_error"] is not None:
        error = f" ± {float(np.hypot(found['mesh_error'], found['sampling_error'] or 0.0)):.2g}"
    console.print(
        f"least safety against fatigue: {worst['safety']:.3g}{error} by Goodman, {worst['region']} (radius "
        f"{worst['radius']:.2f}, z {worst['z']:.2f} mm; amplitude {worst['amplitude_MPa']:.0f}, mean "
        f"{worst['mean_MPa']:.0f} MPa); {other['safety']:.3g} by Crossland, {other['region']}; "
        f"{found['yield']['safety']:.3g} against yield"
    )
    life, programs = found["life_turns"], found.get("life_programs")
    console.print(
        "life by Basquin: "
        + (
            f"{life:.2g} turns of the wave generator, {found['life_hours']:.2g} h"
            if life is not None
            else f"{programs:.2g} passages of the load program"
            if programs is not None
            else "without end"
        )
    )
    if found["root_factor"]:
        console.print(f"stresses in the tooth root are scaled by {found['root_factor']:.3f}, from windows")
    else:
        console.print(
            "stresses in the tooth root are nodal averages, up to 25 % low"
            + (": set output.root_stress = true" if windows else ": there are no windows in this run")
        )
    console.print(found["warning"], markup=False)  # a section's name is no markup


def _print_losses(losses: Mapping[str, Any]) -> None:
    parts = losses["parts_Nmm"]
    shares = ", ".join(f"{name.replace('_', ' ')} {value:.3g}" for name, value in parts.items())
    efficiency = losses["efficiency"]
    console.print(
        f"losses take {losses['loss_torque_Nmm']:.3g} N·mm of input torque ({shares}); "
        + (f"efficiency {100.0 * efficiency:.1f} %" if efficiency else "this is the no-load torque")
    )


def _print_over_period(over: Mapping[str, Any], count: int) -> None:
    half = over["sampling_error"]
    console.print(
        f"the same over one period: mean {over['mean']:.1f} ± {over['mean_error']:.1f} MPa by the meshes, largest "
        f"{over['maximum']:.1f}, of {count} angles with one window at each further one"
        + ("" if half is None else f" (half as many change the mean by {half:.1f})")
    )


def _print_bearing(bearing: Mapping[str, Any]) -> None:
    console.print(
        f"largest ball load: {bearing['largest_load_N']:.1f} N, {bearing['largest_pressure_MPa']:.0f} MPa, "
        f"{bearing['cam_angle_deg']:.0f} degrees from the major axis; {bearing['mean_load_N']:.1f} N on average"
    )
    if share := bearing["torsional_share"]:
        radial = bearing["radial_share"]
        console.print(
            f"share of the bearing: {100.0 * share['bearing']:.0f} % of the torsional compliance (balls "
            f"{100.0 * share['balls']:.0f} %), {100.0 * radial['bearing']:.0f} % of the radial one (balls "
            f"{100.0 * radial['balls']:.0f} %)"
        )
    console.print("with the bearing the stress at the teeth is not resolved by windows: it is that of nodal averages")
    if bearing["balls_fixed_to_cam"]:
        console.print("the balls are fixed to the cam: ball passing is left out")
    elif not bearing["covers_ball_passing"]:
        console.print(f"a ball passes every {bearing['ball_passing_deg']:.3g} degrees: the run covers less than that")
    life = bearing["life"]
    if life["L10_hours"] is not None:
        console.print(
            f"rating life of the bearing: L10 {life['L10_hours']:.3g} h, {life['L10_turns']:.3g} turns (equivalent "
            f"load {life['equivalent_load_N']:.0f} N of {life['load_rating_N']:.0f} N)"
        )


def _print_housing(housing: Mapping[str, float]) -> None:
    console.print(
        f"housing under load: s1 {housing['s1_MPa']:.1f}, |s3| {housing['s3_MPa']:.1f}, von Mises "
        f"{housing['vm_MPa']:.1f} MPa; the outer surface of the ring gear moves outwards by up to "
        f"{housing['bulge_um']:.3g} µm"
    )


def _print_errors(summary: Mapping[str, Any]) -> None:
    bearing = summary.get("bearing")
    if root := summary.get("root_stress"):
        console.print(
            f"largest tension at the teeth under load, by windows: s1 {root['s1']:.1f} ± {root['total_error']:.1f} "
            f"MPa, {root['region']} of tooth {root['tooth']} (radius {root['radius']:.2f}, z {root['z']:.2f} mm, "
            f"{root['angle_deg']:.1f} degrees); {root['on_mesh']:.1f} MPa by nodal averages of the drive's mesh"
        )
        if root["warning"]:
            console.print(f"the largest tension at the teeth is {root['warning']}")
        if root["period"] and len(root["period"]) == summary["design"]["steps"]["samples"]:
            _print_over_period(root["over_period"], len(root["period"]))
    if contact := summary.get("contact"):
        _print_contact(contact)
    if sharing := summary.get("load_sharing"):
        _print_sharing(sharing)
    if fatigue := summary.get("fatigue"):
        _print_fatigue(fatigue, windows=not (bearing or summary["program"]))
    if losses := summary.get("losses"):
        _print_losses(losses)
    if bearing:
        _print_bearing(bearing)
    if housing := summary.get("housing"):
        _print_housing(housing)
    asked = summary["accuracy"]
    if summary["means"]:
        _print_mesh_error(summary["mesh_error"])
    if asked:
        console.print(
            f"accuracy of that stress: {asked['asked']:g} asked for, {asked['estimated']:.2g} "
            f"estimated{'' if asked['reached'] else ', NOT reached: no finer mesh is taken'}"
        )
    if left_out := summary["condensed_MPa"]:
        console.print(f"condensed sectors leave out {left_out:.2g} MPa of bending stress")
    if error := summary["sampling_error"]:
        console.print(
            f"half as many angles change the means by: s1 {error['fs_s1']:.2f}, |s3| {error['fs_s3']:.2f}, "
            f"von Mises {error['fs_vm']:.2f} MPa"
        )

"""The file of a starter design, with the meaning of every key and sources of the proportions."""

from __future__ import annotations

import shlex
from typing import Any

from swgpar.checks.starter import END, HUB, WALL, Request
from swgpar.checks.starter_teeth import RIM
from swgpar.checks.starter_torques import torque_text
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import printable
from swgpar.input.commented_file import section_lines

SOURCES = "docs/howto/own_drive.md, Proportions"
"""Where the numbers of the sources are."""


def as_toml(request: Request, design: DriveDesign, table: dict[str, Any], name: str) -> str:
    """The design file with the meaning of every key.

    design, table : of `starter_design`;  name : of the file, for the commands in its head
    """
    size = (
        f"bore {request.bore:g} mm"
        if request.diameter is None
        else f"pitch diameter {request.diameter:g} mm"
    )
    drive = design.drive
    shown = printable(name).replace("\n", "\\n")  # a comment ends with its line
    stem, name = shown.removesuffix(".toml"), shlex.quote(shown)
    lines = [
        f"# Strain wave gear: ratio {request.ratio:g}, {size}, torque {request.torque:g} N·m.",
        "# These are given, with the kinds of profile and cam. All other values are assumptions to "
        "start from, after the",
        f"# sources that the sections name ({SOURCES}): sizes of the blank are shares of the",
        f"# pitch diameter, {drive.module * drive.teeth_fs:.5g} mm, those of the teeth multiples "
        "of the module.",
        f"# {torque_text(request, design)}",
        f"#   swgpar check {name}",
        f"#   mpirun -n 2 swgpar run {name} --out {shlex.quote(f'results/{stem}')}",
        f"#   mpirun -n 2 swgpar rate {name} --out {shlex.quote(f'results/{stem}_rating')}",
    ]
    sources = _sources(request)
    for section, content in table.items():
        lines += section_lines(section, getattr(design, section), content, sources)
    return "\n".join(lines) + "\n"


def _sources(request: Request) -> dict[str, str]:
    """What the proportions of a section are taken from."""
    sources = {
        "micro_geometry": "shares of the module in Yagüe-Spaude (2021), Table 7.4",
        "fatigue": "a steel like 30CrNiMo8, quenched and tempered",
        "wave_generator.bearing": "grooves as in US 8,770,064; balls and race are assumptions",
    }
    if request.profile == "s_shaped":
        sources |= {
            "flexible_spline": f"rim up to {RIM[request.lobes]:g} of the pitch diameter: Chinese "
            "Journal of Mechanical Engineering 34 (2021), s10033-021-00621-z",
            "flexible_spline.profile": "US 4,823,638",
            "ring_gear.profile": "envelope of the S-shaped tooth in its exact motion",
        }
    if request.shape != "hat":
        sources["cup"] = (
            f"end of {END:g} rims, clamped within {HUB:g} of the pitch diameter: EP 1 628 045; "
            f"wall of {WALL:g} rims: public drives have 0.6 to 1"
        )
    return sources

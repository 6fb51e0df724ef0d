"""Checks of temperatures and press fits. Each refusal names the key, its value and what is
allowed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import SECTIONS
from swgpar.errors import InputError
from swgpar.input.require import require, require_available

LARGEST = 0.01
"""Largest strain of a growth: strains are small."""

PRESSED = 1e-4
"""Difference of the growths of a frame and of what it holds above which it is said: on steel a
pressure that makes some 20 MPa."""

NEARER = 0.01
"""Growth of a pitch circle against that of the flexible spline (modules) above which it is said:
as much as a backlash of c_P = 0.995."""


def check_growth(design: DriveDesign) -> None:
    """Raise InputError for the first temperature or fit that does not fit the design."""
    rises, frame = design.temperature_rises, design.ring_gear.frame
    for key, where, known in _expansions(design):
        if rises[key] and not known:
            raise InputError(f"{where} is missing: {key}.temperature needs it")
    given = frame.interference or rises["ring_gear.frame"]
    require_available(
        not given or design.frame_is_rigid,
        "ring_gear.frame",
        'ring_gear.housing.outside = "free"',
        'with "held", or without a housing',
    )
    strains = {SECTIONS.get(body, body): one.largest for body, one in design.growths.items()}
    strains["ring_gear.frame"] = design.frame_growth.largest
    strains["wave_generator"] = abs(design.cam_strain)
    for key, strain in strains.items():
        allowed = f"temperatures and fits with strains up to {LARGEST:g}, which are small"
        require(strain <= LARGEST, f"strain of the growth of {key}", strain, allowed)
    _check_race(design)
    condensed = design.solver.condensed_sectors and design.housing is not None
    alike = condensed and design.growths["housing"] == design.growths["ring_gear"]
    require_available(
        not condensed or alike,
        "solver.condensed_sectors = true",
        "a ring gear and a housing that grow differently",
        "false",
    )


def _check_race(design: DriveDesign) -> None:
    """A race that is thicker or thinner by its fit is no longer that of its sizes."""
    if design.bearing is None:
        return
    fit, most = design.bearing.race_interference, 0.1 * design.bearing.race_thickness
    allowed = f"-{most:g} to {most:g} mm (a tenth of race_thickness)"
    require(abs(fit) <= most, "wave_generator.bearing.race_interference", fit, allowed)


def _expansions(design: DriveDesign) -> Iterator[tuple[str, str, bool]]:
    """Sections with a temperature, the key of their expansion and whether it is known."""
    bodies = {SECTIONS.get(body, body): body for body in design.materials}
    for key, body in bodies.items():
        section: Any = design
        for name in key.split("."):
            section = getattr(section, name)
        own = f"{key}.material" if section.material is not None else "material"
        yield key, f"{own}.expansion", design.materials[body].expansion is not None
    wave, frame = design.wave_generator, design.ring_gear.frame
    known = wave.expansion is not None or design.material.expansion is not None
    yield "wave_generator", "wave_generator.expansion", known
    yield "ring_gear.frame", "ring_gear.frame.expansion", frame.expansion is not None


def growth_remarks(design: DriveDesign) -> list[str]:
    """Sentences where a rigid frame presses or pulls what it holds, and where teeth come nearer or
    part."""
    return [*_frame_remarks(design), *_tooth_remarks(design)]


def _tooth_remarks(design: DriveDesign) -> list[str]:
    """A sentence for every pair of gears whose pitch circles do not grow alike."""
    grown = {
        gear: design.growths[gear].across * design.teeth(gear).r_pitch for gear in design.gears
    }
    spline, *rings = design.gears
    return [
        f"teeth of the {spline.replace('_', ' ')} come {1e3 * abs(nearer):.0f} µm "
        f"{'nearer to' if nearer > 0.0 else 'farther from'} those of the {ring.replace('_', ' ')} "
        "by growth, were both free: clearances of rigid teeth are those at "
        "load.reference_temperature"
        for ring in rings
        if abs(nearer := grown[spline] - grown[ring]) > NEARER * design.drive.module
    ]


def _frame_remarks(design: DriveDesign) -> list[str]:
    """A sentence where a rigid frame presses or pulls what it holds."""
    if not design.frame_is_rigid:
        return []
    held = "ring_gear" if design.housing is None else "housing"
    difference = design.growths[held].across - design.frame_growth.across
    if abs(difference) <= PRESSED:
        return []
    does, name = "presses" if difference > 0.0 else "pulls", held.replace("_", " ")
    return [
        f"the rigid frame {does} the {name}, which if it were free would be "
        f"{1e6 * abs(difference):.0f} µm/m {'larger' if difference > 0.0 else 'smaller'}: "
        "[ring_gear.frame] has temperature, expansion and fit of the frame"
    ]

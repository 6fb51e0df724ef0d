"""Drawings of what the keys of a section are, those of the documents (docs/drawings)."""

from __future__ import annotations

from pathlib import Path

from nicegui import ui

from swgpar.design.drive_design import DriveDesign

FOLDER = Path(__file__).parent / "drawings"
"""The files, which scripts/app_drawings.py makes."""

ADDRESS = "/drawings"

TEETH = "drive_teeth", "tip_relief"
DRAWINGS = {
    "drive": ("drive_teeth", "drive_front"),
    "flexible_spline": TEETH,
    "ring_gear": TEETH,
    "ring_gear.housing": ("housing",),
    "ring_gear.frame": ("housing",),
    "dynamic_spline": ("drive_pancake", *TEETH),
    "wave_generator": ("cam_sizes", "cams"),
    "wave_generator.bearing": ("bearing",),
    "cup": ("drive_section", "cup_shapes", "end_contours", "cup_attachment"),
    "micro_geometry": ("crowning", "slope"),
    "material": ("material",),
    "contact": ("contact_laws",),
    "load": ("load_stages",),
    "steps": ("load_stages",),
    "deviations": ("deviations",),
    "output": ("output",),
    "output_bearing": ("output_bearing",),
}
"""By sections; those of profiles follow from the type."""


def drawings_of(design: DriveDesign, section: str) -> tuple[str, ...]:
    """Names of the drawings of a section of a design, by its dotted name; none where its keys
    have no shape."""
    gear, _, part = section.rpartition(".")
    if part == "profile":
        return (f"profile_{getattr(design, gear).profile.type}",)
    return DRAWINGS.get(section, ())


def show_drawings(section: str, names: tuple[str, ...]) -> None:
    """Show drawings of a section."""
    with ui.dialog() as dialog, ui.card().classes("swgpar-drawings"):
        ui.label(f"[{section}]").props("role=heading aria-level=2").classes("text-bold")
        for name in names:
            picture = ui.element("img").classes("w-full")
            picture.props["src"] = f"{ADDRESS}/{name}.png"
            picture.props["alt"] = f"keys of [{section}]: {name.replace('_', ' ')}"
        ui.button("close", on_click=dialog.close).props("flat dense")
    dialog.open()

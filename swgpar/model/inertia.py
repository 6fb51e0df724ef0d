"""Forces of inertia of the bodies that the wave deforms."""

from __future__ import annotations

from swgpar.constraints.wave_inertia import WaveInertia
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.fem.elements import Elements


def inertia_terms(design: DriveDesign, elements: Elements) -> list[WaveInertia]:
    """Those of flexible spline and outer race at `load.input_speed`."""
    bodies = [name for name in (FLEXIBLE_SPLINE, OUTER_RACE) if name in elements.bodies]
    lobes = design.wave_generator.lobes
    return [WaveInertia(elements.bodies[name], lobes, *design.speeds) for name in bodies]

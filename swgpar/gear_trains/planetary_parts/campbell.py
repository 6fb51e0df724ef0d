"""Campbell diagram of a planetary train, drawn from the table of its modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.planetary_parts.natural_modes import KINDS
from swgpar.gear_trains.planetary_parts.sections import PlanetaryParts
from swgpar.gear_trains.result import TrainResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST_FREQUENCY = 1.0
"""In Hz, of modes that are drawn: those of a sun that floats are lower."""

DRAWN = 24
"""Number of modes that are drawn, the lowest."""


def campbell(result: TrainResult[PlanetaryParts]) -> Figure:
    """Natural frequencies by kind and harmonics of the mesh frequency against the speed."""
    table, design = result.tables["modes"], result.summary.design
    first = int(np.argmax(table["frequency_Hz"] > LEAST_FREQUENCY))
    frequencies, kinds = (table[name][first:][:DRAWN] for name in ("frequency_Hz", "kind"))
    lowest, highest = frequencies[[0, -1]]
    teeth, harmonics = design.ring.teeth, range(1, design.mesh.harmonics + 1)
    speed = np.geomspace(
        0.7 * min(design.carrier.speed, 2.0 * np.pi * lowest / (teeth * harmonics[-1])),
        max(design.carrier.speed, 2.0 * np.pi * highest / teeth),
        200,
    )
    title = "natural frequencies and harmonics of the mesh frequency"
    figure, (axis,) = axes(title, "speed of the carrier (rad/s)", "frequency (Hz)")
    for number, kind in enumerate(KINDS):
        for k, frequency in enumerate(frequencies[kinds == kind]):
            label = None if k else kind
            axis.axhline(frequency, color=f"C{number}", lw=0.6, label=label)
    for j in harmonics:
        label = "harmonics of the mesh" if j == 1 else None
        axis.loglog(speed, j * teeth * speed / (2.0 * np.pi), "k", lw=0.8, label=label)
    axis.axvline(design.carrier.speed, color="k", ls=":", label="speed of the carrier")
    axis.set_ylim(0.5 * lowest, 2.0 * highest)
    axis.set_xlim(speed[0], speed[-1])
    axis.legend(fontsize=8, ncols=2)
    return figure

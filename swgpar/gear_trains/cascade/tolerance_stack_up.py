"""Tolerance stack-up of every kind of mesh by Monte Carlo, with Spearman's rank correlation
(sections 2.2 to 2.4, 3.1).

Each tolerance is a normal variable whose limits lie at a given number of standard deviations (eq.
1), turned into a displacement of the flanks along the pitch line:

- pitch deviation E_pu = (0.3 m_n + 1.25 sqrt(d) + 7) 2^(0.5 (Q - 5)) µm (eq. 4; the 7 and both
  signs are lost in the text and are those of ISO 1328-1, of which the printed factors are);
- runout E_r = (0.24 m_n + sqrt(d) + 5.6) 2^(0.5 (Q - 5)) µm (eq. 5, likewise), radial: times the
  tangent of the pressure angle;
- position of a shaft along the line of action: over its cosine;
- direction of a shaft: times half of the face width.

The rack has the tolerances of a gear whose pitch circle is as long as the rack, and no shaft.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import spearmanr

from swgpar.gear_trains.cascade.design import MESH_COUNTS, CascadeDesign
from swgpar.vibration.sampling import block_sizes, random_stream

BLOCK_SIZE = 10_000
STREAM = 0
"""First number of the keys of these samples' streams."""

GEARS = {
    "rack_pinion": ("rack", "pinion"),
    "g1_g1": ("g1", "g1"),
    "g1_g2": ("g1", "g2"),
    "g3_g4": ("g3", "g4"),
}


def pitch_deviation(module: float, diameter: float, grade: float) -> float:
    """Equation (4), m; module and diameter in mm."""
    return 1e-6 * (0.3 * module + 1.25 * np.sqrt(diameter) + 7.0) * 2.0 ** (0.5 * (grade - 5.0))


def runout(module: float, diameter: float, grade: float) -> float:
    """Equation (5), m; module and diameter in mm."""
    return 1e-6 * (0.24 * module + np.sqrt(diameter) + 5.6) * 2.0 ** (0.5 * (grade - 5.0))


def contributions(design: CascadeDesign, kind: str) -> dict[str, float]:
    """Limits of the tolerances of a kind of mesh as displacements along the pitch line, m."""
    module, limits = getattr(design, kind).module, {}
    first, second = GEARS[kind]
    angle = np.radians(design.tolerances.pressure_angle)
    for index, gear in enumerate((first, second)):
        section = getattr(design, gear)
        name = f"{gear} {index + 1}" if first == second else gear
        diameter = 1e3 * section.length / np.pi if gear == "rack" else section.teeth * module
        limits[f"pitch deviation {name}"] = pitch_deviation(module, diameter, section.pitch_grade)
        limits[f"runout {name}"] = runout(module, diameter, section.runout_grade) * np.tan(angle)
        if gear != "rack":
            limits[f"position {name}"] = 1e-3 * section.position / np.cos(angle)
            limits[f"axle angle {name}"] = 1e-3 * section.axle_angle * 0.5e-3 * section.face_width
    return limits


def standard_deviation(design: CascadeDesign, kind: str) -> float:
    """Of the whole stack-up of a kind of mesh, m."""
    limits = list(contributions(design, kind).values())
    return float(np.linalg.norm(limits)) / design.tolerances.limit


def sample_stack_up(design: CascadeDesign, kind: str) -> tuple[np.ndarray, dict[str, float]]:
    """Samples of the stack-up (n,), m, and Spearman's rank of each tolerance with it (eq. 2)."""
    limits = contributions(design, kind)
    sizes = np.array(list(limits.values())) / design.tolerances.limit
    key = design.gear_train.seed, STREAM, list(MESH_COUNTS).index(kind)
    blocks = enumerate(block_sizes(design.tolerances.samples, BLOCK_SIZE))
    parts = np.concatenate(
        [random_stream(*key, block).standard_normal((size, len(sizes))) for block, size in blocks]
    )
    total = parts @ sizes
    ranks = [float(spearmanr(part, total).statistic) for part in parts.T]
    return total, dict(zip(limits, ranks))

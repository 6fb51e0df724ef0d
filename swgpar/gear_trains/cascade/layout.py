"""Which gear meshes with which, and which sit on one shaft: the 23 degrees of freedom of the
cascade gearbox.

The coordinate of every gear is its displacement along its pitch line (m), positive in direction B.
Order of the 23: rack, pinions 1 to 8, G1 1 to 8, G2 1 and 2, G3 1 and 2, G4, flywheel (at the pitch
radius of G4, as it has no teeth). 18 meshes: rack with every pinion, even with odd G1 of a pair,
odd G1 with the G2 of its side, G3 with G4. 11 shafts: a flexible unit between every pinion and its
G1, G2 with G3, G4 with the flywheel.
"""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.cascade.design import MESH_COUNTS, PAIRS, PINIONS, SIDES, CascadeDesign
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.kernel import MESH, SHAFT

RACK = 0
PINION = 1
G1 = 9
G2 = 17
G3 = 19
G4 = 21
FLYWHEEL = 22
DOFS, MESHES, SHAFTS = 23, 18, 11

TOOTHED = ["pinion"] * PINIONS + ["g1"] * PINIONS + ["g2"] * SIDES + ["g3"] * SIDES + ["g4"]
"""Sections of the gears but the rack, in the order of the degrees of freedom."""


def pitch_radii(design: CascadeDesign) -> np.ndarray:
    """Pitch radii of all gears, (23,) m; the rack has none."""
    return np.array([np.nan, *(design.radius(name) for name in [*TOOTHED, "g4"])])


def masses(design: CascadeDesign) -> np.ndarray:
    """Masses at the pitch lines, (23,) kg: inertia over the radius squared (eq. 15)."""
    inertia = np.array([getattr(design, name).inertia for name in [*TOOTHED, "flywheel"]])
    return np.concatenate([[design.rack.mass], inertia / pitch_radii(design)[1:] ** 2])


def rigid_displacements(design: CascadeDesign) -> np.ndarray:
    """Displacements of all gears per displacement of the rack if nothing deforms, (23,)."""
    displacements = np.ones(DOFS)
    displacements[G1:G3] = design.radius("g1") / design.radius("pinion")
    displacements[G3:] = displacements[G2] * design.radius("g3") / design.radius("g2")
    return displacements


def meshes(design: CascadeDesign) -> np.ndarray:
    """All meshes, (18,) of the kernel's MESH."""
    odd, side = G1 + 2 * np.arange(PAIRS), np.arange(SIDES)
    out = np.zeros(MESHES, dtype=MESH)
    out["driver"] = np.concatenate([np.full(PINIONS, RACK), odd + 1, odd, G3 + side])
    out["driven"] = np.concatenate(
        [PINION + np.arange(PINIONS), odd, G2 + np.arange(PAIRS) // 2, np.full(SIDES, G4)]
    )
    out["driven_radius"] = pitch_radii(design)[out["driven"]]
    kinds = [(getattr(design, kind), count) for kind, count in MESH_COUNTS.items()]
    counts = list(MESH_COUNTS.values())
    for key, scale in {"stiffness": 1.0, "variation": 1.0, "module": 1e-3}.items():
        out[key] = np.repeat([scale * getattr(section, key) for section, _ in kinds], counts)
    out["gap_A"] = np.concatenate([section.gaps("A", count) for section, count in kinds])
    out["gap_B"] = np.concatenate([section.gaps("B", count) for section, count in kinds])
    out["damping"] = design.damping.metal * out["stiffness"]
    return out


def shafts(design: CascadeDesign) -> np.ndarray:
    """Flexible units and shafts, (11,) of the kernel's SHAFT."""
    side, units = np.arange(SIDES), FlexUnits.of(design)
    out = np.zeros(SHAFTS, dtype=SHAFT)
    out["first"] = np.concatenate([PINION + np.arange(PINIONS), G2 + side, [G4]])
    out["second"] = np.concatenate([G1 + np.arange(PINIONS), G3 + side, [FLYWHEEL]])
    for end in ("first", "second"):
        out[f"{end}_radius"] = pitch_radii(design)[out[end]]
    out["stiffness"][PINIONS:] = [design.shafts.g2_g3] * SIDES + [design.shafts.g4_flywheel]
    out["stiffness"][:PINIONS] = units.ratios * units.stiffness
    out["initial_stiffness"], out["linear_above"] = out["stiffness"], units.end
    out["initial_stiffness"][:PINIONS] = units.ratios * units.initial
    out["damping"] = design.damping.metal * out["stiffness"]
    out["damping"][:PINIONS] = design.damping.flex * out["stiffness"][:PINIONS]
    return out

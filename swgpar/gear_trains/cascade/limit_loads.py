"""Limit loads: what the pinions carry when the flexible units reach their largest deformation."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.cascade.design import CascadeDesign, Direction
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.static_sharing import static_sharing


def equal_limit_loads(design: CascadeDesign, deformation: float) -> np.ndarray:
    """Forces (8,) in N of pinions without gaps, whose units all have a deformation (mm) and a
    constant stiffness (Table 6, first row)."""
    units = FlexUnits.of(design)
    twist = deformation / design.flex_unit.radius
    return units.ratios * units.stiffness * twist / design.radius("pinion")


def limit_loads(design: CascadeDesign, direction: Direction, deformation: float) -> np.ndarray:
    """Forces (8,) in N of the pinions at rest when the first unit reaches a deformation (mm)."""
    sharing = static_sharing(design, direction)
    twist = deformation / design.flex_unit.radius
    return sharing.forces(sharing.radius * (sharing.gaps.min() + np.array(twist)))

"""A planetary stage under a steady torque: load sharing with errors, clearance and gravity, its
distribution over tolerances, natural modes."""

from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign as Design
from swgpar.gear_trains.planetary_stage.design import check_fit
from swgpar.gear_trains.planetary_stage.figures import drawings
from swgpar.gear_trains.planetary_stage.quantities import derived, quantities
from swgpar.gear_trains.planetary_stage.run import compute

__all__ = ["Design", "check_fit", "compute", "derived", "drawings", "quantities"]

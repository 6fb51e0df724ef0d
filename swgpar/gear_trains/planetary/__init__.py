"""A planetary gear train of a wind turbine: lumped sun, planets and carrier in an elastic ring, under turbulent wind.

Source: seeds/001_74e7aa307ceef8c0.txt, chapter 3, cited by its equation and table numbers.
"""

from swgpar.gear_trains.planetary.design import PlanetaryDesign, check_fit
from swgpar.gear_trains.planetary.figures import draw
from swgpar.gear_trains.planetary.run import compute, derived, quantities

__all__ = ["PlanetaryDesign", "check_fit", "compute", "derived", "draw", "quantities"]

"""A planetary gear train of a wind turbine: lumped sun, planets and carrier in an elastic ring,
under turbulent wind.

Source: J. Taheri Kahnamouei, Nonlinear Random Vibration of Planetary Gear Trains with Elastic Ring
Gear, PhD thesis, Memorial University of Newfoundland, St. John's, 2021, chapter 3, cited by its
equation and table numbers.
"""

from swgpar.gear_trains.planetary.design import PlanetaryDesign as Design
from swgpar.gear_trains.planetary.design import check_fit
from swgpar.gear_trains.planetary.figures import drawings
from swgpar.gear_trains.planetary.quantities import derived, quantities
from swgpar.gear_trains.planetary.run import compute

__all__ = ["Design", "check_fit", "compute", "derived", "drawings", "quantities"]

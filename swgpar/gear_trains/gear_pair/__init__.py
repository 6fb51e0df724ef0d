"""A pair of spur gears under torque and white noise: statistical linearisation against Monte Carlo
simulation.

Source: J. Taheri Kahnamouei, Nonlinear Random Vibration of Planetary Gear Trains with Elastic Ring
Gear, PhD thesis, Memorial University of Newfoundland, St. John's, 2021, chapter 4, cited by its
equation and table numbers.
"""

from swgpar.gear_trains.gear_pair.design import GearPairDesign as Design
from swgpar.gear_trains.gear_pair.design import check_fit
from swgpar.gear_trains.gear_pair.figures import drawings
from swgpar.gear_trains.gear_pair.quantities import derived, quantities
from swgpar.gear_trains.gear_pair.run import compute

__all__ = ["Design", "check_fit", "compute", "derived", "drawings", "quantities"]

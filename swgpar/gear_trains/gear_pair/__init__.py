"""A pair of spur gears under torque and white noise: statistical linearisation against Monte Carlo simulation.

Source: seeds/001_74e7aa307ceef8c0.txt, chapter 4, cited by its equation and table numbers.
"""

from swgpar.gear_trains.gear_pair.design import GearPairDesign, check_fit
from swgpar.gear_trains.gear_pair.figures import draw
from swgpar.gear_trains.gear_pair.run import compute, derived, quantities

__all__ = ["GearPairDesign", "check_fit", "compute", "derived", "draw", "quantities"]

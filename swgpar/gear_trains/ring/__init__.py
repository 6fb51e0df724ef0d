"""An elastic ring of curved beams: its modes, and its motion under several moving loads with white noise.

Source: seeds/001_74e7aa307ceef8c0.txt, chapters 5 and 6, cited by equation and table numbers.
"""

from swgpar.gear_trains.ring.design import RingDesign, check_fit
from swgpar.gear_trains.ring.figures import draw
from swgpar.gear_trains.ring.run import compute, derived, quantities

__all__ = ["RingDesign", "check_fit", "compute", "derived", "draw", "quantities"]

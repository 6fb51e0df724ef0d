"""An elastic ring of curved beams: its modes, and its motion under several moving loads with white
noise.

Source: J. Taheri Kahnamouei, Nonlinear Random Vibration of Planetary Gear Trains with Elastic Ring
Gear, PhD thesis, Memorial University of Newfoundland, St. John's, 2021, chapters 5 and 6, cited by
its equation and table numbers.
"""

from swgpar.gear_trains.ring.design import RingDesign as Design
from swgpar.gear_trains.ring.design import check_fit
from swgpar.gear_trains.ring.figures import drawings
from swgpar.gear_trains.ring.quantities import derived, quantities
from swgpar.gear_trains.ring.run import compute

__all__ = ["Design", "check_fit", "compute", "derived", "drawings", "quantities"]

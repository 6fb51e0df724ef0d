"""The cascade gearbox: a rack drives eight pinions, each through a flexible unit, and they drive one flywheel.

Source: seeds/000_dbe5e5422414e22c.txt, cited by its equation and table numbers.
"""

from swgpar.gear_trains.cascade.design import CascadeDesign, check_fit
from swgpar.gear_trains.cascade.figures import draw
from swgpar.gear_trains.cascade.run import compute, derived, quantities

__all__ = ["CascadeDesign", "check_fit", "compute", "derived", "draw", "quantities"]

"""The cascade gearbox: a rack drives eight pinions, each through a flexible unit, and they drive
one flywheel.

Source: a master's thesis on the cascade gearbox, KTH Royal Institute of Technology, Stockholm, with
CorPower Ocean (author, title and year are not in the text at hand), cited by its equation and table
numbers.
"""

from swgpar.gear_trains.cascade.design import CascadeDesign as Design
from swgpar.gear_trains.cascade.design import check_fit
from swgpar.gear_trains.cascade.figures import drawings
from swgpar.gear_trains.cascade.quantities import derived, quantities
from swgpar.gear_trains.cascade.run import compute

__all__ = ["Design", "check_fit", "compute", "derived", "drawings", "quantities"]

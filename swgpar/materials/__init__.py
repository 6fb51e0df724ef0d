"""Laws of materials: what a body is made of.

To add a law, see docs/howto/own_material.md.
"""

from swgpar.materials.growth import NO_GROWTH, Growth
from swgpar.materials.isotropic import Isotropic
from swgpar.materials.laws import ChosenMaterial, OptionalMaterial
from swgpar.materials.library import LIBRARY
from swgpar.materials.material import Material, contact_modulus
from swgpar.materials.transversely_isotropic import TransverselyIsotropic

__all__ = [
    "LIBRARY",
    "NO_GROWTH",
    "ChosenMaterial",
    "Growth",
    "Isotropic",
    "Material",
    "OptionalMaterial",
    "TransverselyIsotropic",
    "contact_modulus",
]

"""Laws of materials: what a body is made of.

To add a law, see docs/howto/own_material.md.
"""

from swgpar.materials.isotropic import Isotropic
from swgpar.materials.laws import ChosenMaterial, OptionalMaterial
from swgpar.materials.material import Material, contact_modulus

__all__ = ["ChosenMaterial", "Isotropic", "Material", "OptionalMaterial", "contact_modulus"]

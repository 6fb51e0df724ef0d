"""C++ kernels of elements, contact and friction, behind Cython."""

from swgpar.kernel._contact import add_face_blocks, contact_flanks
from swgpar.kernel._elements import (
    ReferenceElements,
    assemble_elements,
    recover_stress,
    reference_elements,
)

__all__ = [
    "ReferenceElements",
    "add_face_blocks",
    "assemble_elements",
    "contact_flanks",
    "recover_stress",
    "reference_elements",
]

"""C++ kernels behind Cython: elements and contact."""

from swgpar.kernel._contact import add_face_blocks, contact_flanks
from swgpar.kernel._kernel import ReferenceElements, assemble_elements, recover_stress, reference_elements

__all__ = [
    "ReferenceElements",
    "add_face_blocks",
    "assemble_elements",
    "contact_flanks",
    "recover_stress",
    "reference_elements",
]

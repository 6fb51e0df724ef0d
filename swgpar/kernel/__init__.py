"""C++ kernels of elements, contact and friction, behind Cython."""

from swgpar.kernel._contact import (
    OVERHANG,
    add_contact_lines,
    add_face_blocks,
    add_line_compliances,
    contact_flanks,
)
from swgpar.kernel._elements import (
    ReferenceElements,
    assemble_elements,
    recover_stress,
    reference_elements,
)

__all__ = [
    "OVERHANG",
    "ReferenceElements",
    "add_contact_lines",
    "add_face_blocks",
    "add_line_compliances",
    "assemble_elements",
    "contact_flanks",
    "recover_stress",
    "reference_elements",
]

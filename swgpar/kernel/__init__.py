"""C++ kernels behind Cython: elements, contact, gear trains."""

from swgpar.kernel._contact import add_face_blocks, contact_flanks
from swgpar.kernel._gear_trains import MESH, MESH_ERROR, SHAFT, GearboxKernel, TrainKernel
from swgpar.kernel._kernel import ReferenceElements, assemble_elements, recover_stress, reference_elements

__all__ = [
    "MESH",
    "MESH_ERROR",
    "SHAFT",
    "GearboxKernel",
    "ReferenceElements",
    "TrainKernel",
    "add_face_blocks",
    "assemble_elements",
    "contact_flanks",
    "recover_stress",
    "reference_elements",
]

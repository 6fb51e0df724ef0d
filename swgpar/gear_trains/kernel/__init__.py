"""C++ kernels of the gear trains behind Cython: motion of the cascade gearbox, time steps of the
planetary train."""

from swgpar.gear_trains.kernel._gear_trains import (
    MESH,
    MESH_ERROR,
    SHAFT,
    GearboxKernel,
    PlanetaryStepKernel,
)

__all__ = ["MESH", "MESH_ERROR", "SHAFT", "GearboxKernel", "PlanetaryStepKernel"]

"""swgpar: contact finite-element analysis of strain wave gears.

    design = swgpar.load_design("drive.toml", {"load.torque": 10.0})
    result = swgpar.run(design, mesh="coarse")
    result.history["fs_s1"], result.summary["mean.fs_s1"].value, result.field("vm"),
    result.plot.stress()

Names are imported when they are used: PETSc starts with the first one that needs it.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from swgpar.solve.blas_kernels import choose_blas_kernels
from swgpar.version import __version__

choose_blas_kernels(os.environ)  # before PETSc loads OpenBLAS

if TYPE_CHECKING:
    from swgpar.api import (
        Session,
        check,
        export,
        load_design,
        load_mesh,
        mesh,
        new,
        new_train,
        open_result,
        rate,
        run,
    )
    from swgpar.design.drive_design import DriveDesign
    from swgpar.errors import (
        ConvergenceError,
        InputError,
        OutOfMemoryError,
        OutputError,
        SwgparError,
        TimeLimitError,
    )
    from swgpar.meshing.drive_mesh import DriveMesh
    from swgpar.meshing.recipe import MeshRecipe
    from swgpar.optimisation.result import OptimisationResult
    from swgpar.optimisation.run_optimisation import optimise
    from swgpar.presentation.drive_result import DriveResult
    from swgpar.rating.sheet import RatingSheet
    from swgpar.studies.study import StudyResult, study
    from swgpar.systems.gear_train import TrainResult

_MODULES = {
    "study": "studies.study",
    "optimise": "optimisation.run_optimisation",
    "DriveDesign": "design.drive_design",
    "MeshRecipe": "meshing.recipe",
    "DriveMesh": "meshing.drive_mesh",
    "DriveResult": "presentation.drive_result",
    "RatingSheet": "rating.sheet",
    "TrainResult": "systems.gear_train",
    "StudyResult": "studies.study",
    "OptimisationResult": "optimisation.result",
    "SwgparError": "errors",
    "InputError": "errors",
    "OutputError": "errors",
    "ConvergenceError": "errors",
    "TimeLimitError": "errors",
    "OutOfMemoryError": "errors",
}
"""Public name -> module that it is imported from, where that is not `api`."""

__all__ = [
    "ConvergenceError",
    "DriveDesign",
    "DriveMesh",
    "DriveResult",
    "InputError",
    "MeshRecipe",
    "OptimisationResult",
    "OutOfMemoryError",
    "OutputError",
    "RatingSheet",
    "Session",
    "SwgparError",
    "StudyResult",
    "TimeLimitError",
    "TrainResult",
    "__version__",
    "check",
    "export",
    "load_design",
    "load_mesh",
    "mesh",
    "new",
    "new_train",
    "open_result",
    "optimise",
    "rate",
    "run",
    "study",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'swgpar' has no attribute {name!r}")
    value = getattr(import_module(f"swgpar.{_MODULES.get(name, 'api')}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

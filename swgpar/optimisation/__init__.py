"""Search for the best design: variables within bounds, objectives and constraints from the results
of runs."""

from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.run_optimisation import run_optimisation

__all__ = ["OptimisationResult", "run_optimisation"]

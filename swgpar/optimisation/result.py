"""The result of an optimisation that users have: its data with figures."""

from __future__ import annotations

from mpi4py import MPI

from swgpar.optimisation.figures import drawings
from swgpar.optimisation.optimisation_data import OptimisationData
from swgpar.results.figure_set import FigureSet, NamedFigures


class OptimisationResult(OptimisationData):
    """What an optimisation gives, with figures; the same on every rank.

    Attributes are those of `OptimisationData`: ``evaluations``, ``best``, ``start``, ``at_bounds``
    and further ones.

    Examples
    --------
    >>> found = swgpar.optimise("drivers/optimise/parabolic_cam.toml", "results/cam")
    >>> found.evaluations[found.best[0]].quantities, found.evaluations[found.start].quantities
    >>> [one.text for one in found.at_bounds[found.best[0]]]
    >>> found.plot.parallel_coordinates().savefig("designs.png")
    """

    @property
    def plot(self) -> FigureSet:
        """The figures: ``plot.progress()``, ``plot.parallel_coordinates()`` and so on return
        matplotlib figures, ``plot.names`` lists them."""
        return NamedFigures(drawings(self), MPI.COMM_SELF)

"""The result of a drive that users have: its data with figures and a view."""

from __future__ import annotations

from swgpar.drive_results.drive_data import DriveData
from swgpar.presentation.figures import DriveFigures


class DriveResult(DriveData):
    """What a run of a drive gives, with figures; the same on every rank.

    Attributes are those of `DriveData`: ``history``, ``summary``, ``pairs`` and further tables,
    ``folder``.

    Examples
    --------
    >>> result = swgpar.run(design, mesh="plane_coarse")
    >>> result.history["wg_torque_Nmm"].mean(), result.summary["mean.fs_s1"].value
    >>> stress = result.field("vm", body="flexible_spline")
    >>> result.plot.stress().savefig("stress.png")
    """

    @classmethod
    def of(cls, data: DriveData) -> DriveResult:
        """The data of a run, with figures."""
        return cls(data.rows, data.summary, data, data.fields, data.comm, data.folder)

    @property
    def plot(self) -> DriveFigures:
        """The figures: ``plot.stress()`` and so on return matplotlib figures, ``plot.names`` lists
        them."""
        return DriveFigures(
            self, self.comm, gathered=self.fields is not None and self.fields.gathered
        )

    def view(self) -> None:
        """Open a window that shows the deformed drive; call it on one rank, of a result from a
        folder.

        Raises
        ------
        InputError
            There is no display, or the run kept no fields.
        """
        from swgpar.presentation.view import require_display, view_plotter

        require_display()
        view_plotter(self).show()

"""Figures of a result: drawn when they are asked for, returned or written as PNG files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

from swgpar.log import logger

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = "figures"
"""Below the results folder."""

DOTS_PER_INCH = 150

Drawings = Mapping[str, "Callable[[], Figure]"]
"""Name of a figure, without suffix that of its file -> function that draws it."""


class FigureSet(ABC):
    """The figures of one result."""

    @property
    @abstractmethod
    def drawings(self) -> Drawings:
        """The figures that the result allows."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the figures that the result allows."""
        return tuple(self.drawings)

    def save(self, folder: str | Path) -> list[Path]:
        """Write every figure as ``folder``/figures/NAME.png and return the files; call it on one rank."""
        figures = Path(folder) / FOLDER
        figures.mkdir(parents=True, exist_ok=True)
        written = []
        for name, draw in self.drawings.items():
            path = figures / f"{name}.png"
            figure = draw()
            figure.savefig(path, dpi=figure.dpi if name in self.exact_size else DOTS_PER_INCH)
            written.append(path)
        return written

    exact_size: tuple[str, ...] = ()
    """Figures that show a picture and are written pixel by pixel."""


class NamedFigures(FigureSet):
    """Figures whose names follow from the result: ``plot.NAME()`` draws one, ``plot.names`` lists them."""

    def __init__(self, drawings: Drawings) -> None:
        self._drawings = drawings

    @property
    def drawings(self) -> Drawings:
        return self._drawings

    def __getattr__(self, name: str) -> Callable[[], Figure]:
        if not name.startswith("_") and name in self._drawings:
            return self._drawings[name]
        raise AttributeError(f"there is no figure {name!r}: the result has {', '.join(self.__dict__['_drawings'])}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._drawings]


def save_figures(figures: FigureSet, folder: Path, comm: MPI.Comm) -> None:
    """Write the figures of a finished run, on rank 0; a figure that fails must not cost the run. Collective."""
    if comm.rank == 0:
        try:
            for path in figures.save(folder):
                logger.info("figure %s", path)
        except Exception as error:
            logger.warning("figures could not be drawn: %s", error)
    comm.Barrier()

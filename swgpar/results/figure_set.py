"""Figures of a result: drawn when they are asked for, returned or written as PNG files."""

from __future__ import annotations

import io
import os
import sys
import weakref
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import OutputError, SwgparError
from swgpar.log import logger
from swgpar.results import made_files
from swgpar.results.atomic import agreed, raise_first, reason_of, write_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike

FOLDER = "figures"
"""Below the results folder."""

DOTS_PER_INCH = 150

COMPRESSION = 3
"""Level of PNG files: the usual one, 6, takes half as long again for files smaller by a tenth."""

Drawings = Mapping[str, "Callable[[], Figure]"]
"""Name of a figure, without suffix that of its file -> function that draws it."""


def import_matplotlib() -> None:
    """Import matplotlib without the settings of a matplotlibrc in the working directory."""
    if "matplotlib" in sys.modules:
        return
    here = os.open(".", os.O_RDONLY)
    try:
        os.chdir("/")
        import matplotlib  # noqa: F401, makes it known to later imports
    finally:
        os.fchdir(here)
        os.close(here)


_for_files: ContextVar[bool] = ContextVar("for_files", default=False)


@contextmanager
def drawn_for_files() -> Iterator[None]:
    """Figures made here are for files, and no window shows them."""
    token = _for_files.set(True)
    try:
        yield
    finally:
        _for_files.reset(token)


def new_figure(**options: Any) -> Figure:
    """An empty figure, which `plt.show()` shows unless `FigureSet.save` draws it.

    pyplot keeps as many figures as its setting ``figure.max_open_warning`` allows (20). Before it
    gets more, the oldest one made here is closed: whoever holds it can still write it to a file.

    options : of `matplotlib.figure.Figure`
    """
    if _for_files.get():
        from matplotlib.figure import Figure

        return Figure(**options)
    from matplotlib import pyplot

    most = pyplot.rcParams["figure.max_open_warning"]
    while _opened and 0 < most <= len(pyplot.get_fignums()):
        pyplot.close(_opened.pop(0)())
    figure = pyplot.figure(**options)
    _opened.append(weakref.ref(figure, _opened.remove))
    return figure


_opened: list[weakref.ref[Figure]] = []
"""Figures made by pyplot, the oldest first."""


def panels(
    count: int,
    width: float,
    height: float,
    *,
    shared: bool = False,
    height_ratios: Sequence[float] | None = None,
) -> tuple[Figure, list[Axes]]:
    """A figure of a width and a height (inches) with panels with grids above one another.

    shared : whether the panels share the horizontal axis;  height_ratios : of the panels
    """
    figure = new_figure(figsize=(width, height), layout="constrained")
    found = figure.subplots(count, sharex=shared, squeeze=False, height_ratios=height_ratios)[:, 0]
    for axes in found:
        axes.grid(alpha=0.3)
    return figure, list(found)


FEWEST = 3
"""Points through which a figure draws a line: two say nothing about what lies between them."""


def line_through(points: int, style: str = "-") -> str:
    """Style of the line through so many points: none through one or two."""
    return style if points >= FEWEST else "none"


FEW = 40
"""Points below which each has a mark."""


def plot_line(axes: Axes, x: ArrayLike, y: ArrayLike, style: str = "-", **options: Any) -> Line2D:
    """A line through points (n,), with marks where they are few and none through one or two.

    style : of matplotlib;  options : of the line
    """
    (line,) = axes.plot(x, y, style, **options)
    count = np.size(line.get_xdata())
    if count < FEWEST:
        line.set_linestyle("none")
    if count < FEW and line.get_marker() == "None":
        line.set(marker="o", markersize=3)
    return line


HEADROOM = 0.05
"""Share of a panel above its largest value."""


def from_zero(axes: Axes) -> None:
    """Let the vertical axis begin at 0, with room above the largest value, also of a constant."""
    top = axes.dataLim.ymax  # not finite where nothing was drawn
    axes.set_ylim(0.0, top * (1.0 + HEADROOM) if 0.0 < top < np.inf else 1.0)


PICTURE = 6
"""Figures over axes that take as long as a picture of the whole drive."""


class FigureSet(ABC):
    """The figures of one result.

    comm : of the result;  gathered : whether figures show gathered fields, so that all ranks draw
    """

    def __init__(self, comm: MPI.Comm, *, gathered: bool = False) -> None:
        self._comm, self._gathered = comm, gathered

    @property
    @abstractmethod
    def drawings(self) -> Drawings:
        """The figures that the result allows."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the figures that the result allows."""
        return tuple(self.drawings)

    def save(self, folder: str | Path) -> list[Path]:
        """Write every figure as ``folder``/figures/NAME.png and return the files; collective.

        The ranks share the figures, unless these show gathered fields: then rank 0 writes all.
        Raises OutputError on all ranks where one cannot be drawn or written.
        """
        import_matplotlib()
        figures, comm = Path(folder) / FOLDER, self._comm
        with agreed(comm, figures):
            if comm.rank == 0:
                figures.mkdir(parents=True, exist_ok=True)
                for name in self.drawings:  # here, and not by the ranks that draw them
                    made_files.note(figures / f"{name}.png")
        paths = {name: figures / f"{name}.png" for name in self.drawings}
        failure: SwgparError | None = None
        writer = self._writers()
        for name, path in paths.items():
            writes = comm.rank == (0 if self._gathered else writer[name])
            if not writes and not self._gathered:
                continue
            try:
                with drawn_for_files():
                    figure = self.drawings[name]()
                if writes:
                    exact = name in self.exact_size
                    _write(figure, path, figure.dpi if exact else DOTS_PER_INCH)
            except Exception as error:  # whatever a drawing library raises
                failure = failure or OutputError(f"cannot draw {path}: {reason_of(error)}")
        raise_first(comm, failure)
        return list(paths.values())

    def _writers(self) -> dict[str, int]:
        """The rank that draws each figure, so that all take about as long."""
        load, writer = [0] * self._comm.size, {}
        for name in sorted(self.drawings, key=lambda name: name not in self.pictures):
            writer[name] = load.index(min(load))
            load[writer[name]] += PICTURE if name in self.pictures else 1
        return writer

    exact_size: tuple[str, ...] = ()
    """Figures that show a picture and are written pixel by pixel."""
    pictures: tuple[str, ...] = ()
    """Figures that take as long as `PICTURE` others."""


def _write(figure: Figure, path: Path, dots_per_inch: float) -> None:
    """Write a figure as a PNG file. `savefig` draws a figure with a layout engine twice, the first
    time for the layout alone."""
    figure.set_dpi(dots_per_inch)
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
        figure.set_layout_engine(None)
    png = io.BytesIO()
    options = {"compress_level": COMPRESSION}
    figure.savefig(png, format="png", dpi=dots_per_inch, pil_kwargs=options)
    write_file(path, png.getvalue())


class NamedFigures(FigureSet):
    """Figures whose names follow from the result: ``plot.NAME()`` draws one of ``plot.names``."""

    def __init__(self, drawings: Drawings, comm: MPI.Comm) -> None:
        super().__init__(comm)
        self._drawings = drawings

    @property
    def drawings(self) -> Drawings:
        return self._drawings

    def __getattr__(self, name: str) -> Callable[[], Figure]:
        if not name.startswith("_") and name in self._drawings:
            return self._drawings[name]
        raise AttributeError(
            f"there is no figure {name!r}: the result has {', '.join(self.__dict__['_drawings'])}"
        )

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._drawings]


def save_figures(figures: FigureSet, folder: Path) -> None:
    """Write the figures of a finished run; one that fails must not cost the run. Collective."""
    try:
        for path in figures.save(folder):
            logger.info("figure %s", path)
    except SwgparError as error:
        logger.warning("figures are missing: %s", error)

"""Pictures of PyVista without a window, and whether a window can be opened."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pyvista


@contextmanager
def errors_only() -> Iterator[None]:
    """VTK says only errors: it warns of a display that it does not find before it draws without
    one."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


def off_screen_plotter(width: int, height: int) -> pyvista.Plotter:
    """A plotter that needs no display; sizes in pixels."""
    import pyvista

    pyvista.OFF_SCREEN = True
    with errors_only():
        return pyvista.Plotter(off_screen=True, window_size=(width, height))


def has_display() -> bool:
    """Whether VTK reaches a display. Its windows without one are those of EGL and OSMesa."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, makes the kinds of windows known
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    with errors_only():
        return vtkRenderWindow().GetClassName() not in (
            "vtkEGLRenderWindow",
            "vtkOSOpenGLRenderWindow",
        )


def without_margin(picture: np.ndarray) -> np.ndarray:
    """A picture (height, width, 3) without the white rows and columns around what is drawn."""
    drawn = (picture < 255).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not len(rows):
        return picture
    return picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]

"""What sphinx-gallery does around each script of the gallery."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

GALLERY = Path(__file__).parents[1] / "gallery"

ORDER = (
    "first_drive",
    "new_drive",
    "profiles",
    "conjugate",
    "cams",
    "mesh",
    "stress_wave",
    "contact_pattern",
    "transmission_error",
    "torque_sweep",
    "layouts",
    "friction",
    "fatigue",
    "ring_on_cam",
)
"""Scripts in the order of the page; the others follow by name."""


class PageOrder:
    """Sort key of the scripts."""

    def __init__(self, folder: str) -> None:
        """folder : that of the scripts"""

    def __call__(self, name: str) -> tuple[int, str]:
        stem = Path(name).stem.removeprefix("plot_")
        return (ORDER.index(stem) if stem in ORDER else len(ORDER)), stem


def name_the_file(configuration: dict[str, Any], name: str | None) -> None:
    """Give a script its `__file__`, which sphinx-gallery leaves out; scripts find the drivers by
    it."""
    if name is not None:
        builtins.__file__ = str(GALLERY / Path(name).name)


def returned_figure(block: tuple, variables: dict[str, Any], configuration: dict[str, Any]) -> str:
    """Show the figure that is the value of a block's last expression, as in a notebook."""
    figure = variables["example_globals"].get("___")
    if not isinstance(figure, Figure) or getattr(figure, "shown_in_gallery", False):
        return ""
    figure.shown_in_gallery = True  # the name keeps its value in the blocks that follow
    path = next(variables["image_path_iterator"])
    figure.savefig(path, dpi=100)
    return figure_rst([path], configuration["src_dir"])

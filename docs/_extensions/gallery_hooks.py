"""What sphinx-gallery does around each script of the gallery."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

GALLERY = Path(__file__).parents[1] / "gallery"


def name_the_file(configuration: dict[str, Any], name: str | None) -> None:
    """Give a script its `__file__`, which sphinx-gallery leaves out; scripts find the drivers by it."""
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

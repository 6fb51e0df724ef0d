"""What sphinx-gallery does around each script of the gallery."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

GALLERY = Path(__file__).parents[1] / "gallery"

IMAGE = ".. image-sg::"
"""Directive of a figure in a page that sphinx-gallery has written."""

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


def pages_without_figure(folder: Path) -> list[str]:
    """Names of the pages of the gallery that show no figure.

    folder : of the pages that sphinx-gallery has written
    """
    pages = sorted(folder.glob("plot_*.rst"))
    return [page.stem for page in pages if IMAGE not in page.read_text(encoding="utf-8")]


def _require_figures(app: Sphinx) -> None:
    if not app.config.sphinx_gallery_conf["plot_gallery"]:
        return
    if missing := pages_without_figure(Path(app.srcdir) / "auto_gallery"):
        raise ExtensionError(f"pages of the gallery have no figure: {', '.join(missing)}")


def setup(app: Sphinx) -> dict[str, bool]:
    """Stop the build where a page of the gallery has no figure, after the pages are written."""
    app.connect("builder-inited", _require_figures, priority=900)
    return {"parallel_read_safe": True}

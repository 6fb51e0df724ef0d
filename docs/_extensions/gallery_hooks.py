"""What sphinx-gallery does around each script of the gallery."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

GALLERY = Path(__file__).parents[1] / "gallery"


def name_the_file(configuration: dict[str, Any], name: str | None) -> None:
    """Give a script its `__file__`, which sphinx-gallery leaves out; scripts find the drivers by it."""
    if name is not None:
        builtins.__file__ = str(GALLERY / Path(name).name)

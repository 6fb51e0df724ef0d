"""Texts of properties as they are written: napoleon takes what stands before a colon for a type."""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx

_texts: dict[str, list[str]] = {}


def _keep(app: Sphinx, what: str, name: str, thing: object, options: Any, lines: list[str]) -> None:
    if what == "property":
        _texts[name] = list(lines)


def _restore(
    app: Sphinx, what: str, name: str, thing: object, options: Any, lines: list[str]
) -> None:
    if what == "property":
        lines[:] = _texts.pop(name)


def setup(app: Sphinx) -> dict[str, bool]:
    """Call `_keep` before napoleon and `_restore` after it."""
    app.connect("autodoc-process-docstring", _keep, priority=100)
    app.connect("autodoc-process-docstring", _restore, priority=900)
    return {"parallel_read_safe": True}

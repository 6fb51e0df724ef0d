"""Blocks of code of a page."""

from __future__ import annotations

import re
from pathlib import Path


def examples(page: Path, language: str) -> list[str]:
    """Blocks of code of a page, in its order."""
    return re.findall(
        rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL
    )

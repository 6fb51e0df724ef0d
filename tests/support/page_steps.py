"""The steps of a how-to page about an own part, taken in a copy of the package."""

from __future__ import annotations

import filecmp
import shutil
from pathlib import Path

from support.paths import ROOT

COUNTS = {2: "two", 3: "three"}


def copied_package(folder: Path) -> Path:
    """A copy of the package in a folder."""
    ignored = shutil.ignore_patterns("__pycache__")
    return Path(shutil.copytree(ROOT / "swgpar", folder / "swgpar", ignore=ignored))


def patch(path: Path, difference: str) -> None:
    """Add the lines with a plus to the place that the other lines show, which the file has once."""
    lines = difference.splitlines(keepends=True)
    before = "".join(line[1:] for line in lines if line[0] == " ")
    content = path.read_text(encoding="utf-8")
    assert content.count(before) == 1, f"{path.name}: {before}"
    path.write_text(content.replace(before, "".join(line[1:] for line in lines)), encoding="utf-8")


def require_count(page: Path, package: Path) -> None:
    """Files that differ from those of the checkout, or are new, are as many as the page says."""
    changed = [
        path.relative_to(package)
        for path in package.rglob("*")
        if path.is_file() and not is_as_before(path, ROOT / "swgpar" / path.relative_to(package))
    ]
    text = " ".join(page.read_text(encoding="utf-8").split())
    assert f"It takes changes in {COUNTS[len(changed)]} files." in text, changed


def is_as_before(path: Path, before: Path) -> bool:
    """Whether a file is that of the checkout."""
    return before.exists() and filecmp.cmp(path, before, shallow=False)

"""Files that get their names when all of them are complete, or none does."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from swgpar.errors import OutputError

PREFIX = ".swgpar-"
"""First letters of the folder in which files are made; one that was killed leaves it."""


@contextmanager
def whole_files(folder: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """A folder whose files are moved into `folder`, which is made, when the block has ended; call
    it on one rank.

    overwrite : whether files that are there are replaced

    Raises OutputError where there is a file of the same name, OSError where one cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=PREFIX, dir=folder) as name:
        yield Path(name)
        files = sorted(Path(name).iterdir())
        for file in files:
            if os.path.lexists(folder / file.name) and not overwrite:
                raise OutputError(
                    f"{folder / file.name} exists: replace it with overwrite = true (--overwrite), "
                    "or choose another folder"
                )
            sync(file)
        for file in files:
            os.replace(file, folder / file.name)
    sync(folder)


def sync(path: Path) -> None:
    """Flush a file or a folder to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

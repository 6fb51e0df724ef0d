"""A small file system in memory, which a test fills."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


class Disk:
    """A file system of a given size in memory."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def mount(self, kilobytes: int, *options: str) -> subprocess.CompletedProcess[str]:
        words = ",".join([*options, f"size={kilobytes}k"])
        command = ["mount", "-t", "tmpfs", "-o", words, "swgpar-test", str(self.place)]
        return subprocess.run(command, capture_output=True, text=True, timeout=60)

    def grow(self, kilobytes: int) -> None:
        assert self.mount(kilobytes, "remount").returncode == 0


@contextmanager
def mounted_disk(place: Path, kilobytes: int) -> Iterator[Disk]:
    """A disk at a place that is not there yet. Skips the test where none can be mounted."""
    if os.geteuid() != 0 or shutil.which("mount") is None:
        pytest.skip("a small file system is mounted: only root can")
    made = Disk(place)
    place.mkdir()
    trial = made.mount(kilobytes)
    if trial.returncode != 0:
        pytest.skip(f"a small file system cannot be mounted here: {trial.stderr.strip()}")
    try:
        yield made
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True, timeout=60)

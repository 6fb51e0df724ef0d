"""Version of the package."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("swgpar")
except PackageNotFoundError:  # a source tree that was not installed
    __version__ = "0+source"

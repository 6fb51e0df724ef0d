"""swgpar: contact finite-element analysis of strain wave gears."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("swgpar")
except PackageNotFoundError:  # a source tree that was not installed
    __version__ = "0+source"

__all__ = ["__version__"]

"""swgpar: contact finite-element analysis of strain wave gears."""

from swgpar.version import __version__

__all__ = ["__version__"]

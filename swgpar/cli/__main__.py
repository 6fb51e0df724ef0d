"""`python -m swgpar.cli`."""

from __future__ import annotations

import sys

from swgpar.cli import main

if __name__ == "__main__":
    sys.exit(main())

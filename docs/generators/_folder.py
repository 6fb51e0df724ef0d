"""The command line of the generators: the folder that they write to."""

from __future__ import annotations

import argparse
from pathlib import Path

GENERATED = Path(__file__).resolve().parents[1] / "_generated"


def output_folder(description: str | None) -> Path:
    """The folder of the command line, which is made; docs/_generated without one."""
    options = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("folder", type=Path, nargs="?", default=GENERATED)
    folder: Path = options.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    return folder

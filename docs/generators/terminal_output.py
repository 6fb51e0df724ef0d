"""What the terminal shows for the examples of the pages.

    python docs/generators/terminal_output.py FOLDER

writes `<example>.txt` into the folder, for pages to include.
"""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

from _folder import output_folder

from swgpar.cli import main as swgpar

DOCS = Path(__file__).parents[1]
EXAMPLES = {
    "own_drive_check": ["check", str(DOCS / "howto" / "own_drive.toml")],
    "cup_check": ["check", str(DOCS.parent / "drivers" / "cup_45deg.toml")],
}


def main(folder: Path) -> None:
    """Write the output of all examples; ends with the code of the first that fails."""
    for name, arguments in EXAMPLES.items():
        shown = io.StringIO()
        with contextlib.redirect_stdout(shown):
            code = swgpar(arguments)
        if code:
            raise SystemExit(code)
        (folder / f"{name}.txt").write_text(shown.getvalue(), encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))

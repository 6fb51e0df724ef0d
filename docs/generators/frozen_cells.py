"""What the script of the page about frozen cells prints under load.

python docs/generators/frozen_cells.py FOLDER
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from _folder import output_folder

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "developer" / "frozen_point.md"


def main(folder: Path) -> None:
    """Write the rows of the stage LOAD."""
    (script,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    # -P: the package of the environment, not the folder beside it, which may have no kernels
    command = [sys.executable, "-P", "-c", script]
    shown = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    rows = [line for line in shown.splitlines() if line.startswith("LOAD ")]
    (folder / "frozen_cells.txt").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))

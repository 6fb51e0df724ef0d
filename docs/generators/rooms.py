"""Import graph of the package, its counts and the table of its rooms, for the developer guide."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from _folder import output_folder

from swgpar.rooms import PURPOSE

ROOT = Path(__file__).resolve().parents[2]


def main(folder: Path) -> None:
    """Write everything."""
    command = [sys.executable, str(ROOT / "scripts" / "import_graph.py"), str(ROOT / "swgpar")]
    command.append(str(folder / "import_graph.png"))
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    (folder / "room_counts.md").write_text(f"```text\n{printed}```\n", encoding="utf-8")
    rows = [
        "| room | purpose |",
        "|---|---|",
        *(f"| `{room}` | {purpose} |" for room, purpose in PURPOSE.items()),
    ]
    (folder / "rooms.md").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))

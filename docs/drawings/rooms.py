"""Import graph of the package, for the developer guide."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main() -> None:
    """Run scripts/import_graph.py for the folder of the command line, or else for docs/_generated."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "_generated"
    folder.mkdir(parents=True, exist_ok=True)
    script, image = ROOT / "scripts" / "import_graph.py", folder / "import_graph.png"
    subprocess.run([sys.executable, str(script), str(ROOT / "swgpar"), str(image)], check=True)


if __name__ == "__main__":
    main()

"""Make the drawings of swgpar/app/drawings, those of the documents with few colours.

python scripts/app_drawings.py
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from swgpar.app.drawings import DRAWINGS, FOLDER

SCRIPTS = Path(__file__).parents[1] / "docs" / "drawings"
COLOURS = 48


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    wanted = {name for names in DRAWINGS.values() for name in names}
    with tempfile.TemporaryDirectory() as folder:
        for script in sorted(SCRIPTS.glob("[!_]*.py")):
            subprocess.run([sys.executable, str(script), folder], check=True)
        for path in sorted(Path(folder).glob("*.png")):
            if path.stem in wanted or path.stem.startswith("profile_"):
                drawing = Image.open(path).convert("RGB")
                few = drawing.quantize(COLOURS, dither=Image.Dither.NONE)
                few.save(FOLDER / path.name, optimize=True)


if __name__ == "__main__":
    main()

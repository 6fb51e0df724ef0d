"""Make the drawings of swgpar/app/drawings, those of the documents with few colours, and the record
of what they were made from, which a test compares.

python scripts/app_drawings.py
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from swgpar.app.drawings import DRAWINGS, FOLDER

SCRIPTS = Path(__file__).parents[1] / "docs" / "drawings"
RECORD = FOLDER / "made_from.txt"
COLOURS = 48


def record() -> str:
    """The scripts of the drawings and the drawings of the app with their SHA-256, a file a line."""
    files = [*SCRIPTS.glob("*.py"), *FOLDER.glob("*.png")]
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n"
        for path in sorted(files, key=lambda path: path.name)
    )


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
    RECORD.write_text(record(), encoding="utf-8")


if __name__ == "__main__":
    main()

"""Tables of the columns of the history, made from their declarations.

    python docs/generators/column_tables.py FOLDER

writes `columns_<drives>.md` into the folder, one for each kind of drives, for a page to include.
"""

from __future__ import annotations

from pathlib import Path

from _folder import output_folder

from swgpar.results.history import DECLARED, columns_of


def table(drives: str) -> str:
    """The columns that these drives have."""
    rows = ["| column | unit | meaning |", "|---|---|---|"]
    rows += [
        f"| `{column.name}` | {column.unit} | {column.meaning} |" for column in columns_of(drives)
    ]
    return "\n".join(rows) + "\n"


def main(folder: Path) -> None:
    """Write all tables."""
    for drives in dict.fromkeys(column.drives for column in DECLARED):
        (folder / f"columns_{drives.replace(' ', '_')}.md").write_text(
            table(drives), encoding="utf-8"
        )


if __name__ == "__main__":
    main(output_folder(__doc__))

"""Torsional stiffness of the designs in drivers/catalogue beside the published one of their sizes.

Wall thicknesses and teeth of the sizes are not published: the designs are assumed. Nothing is fitted.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from page import markdown, write_results
from program import run

DRIVES = Path("drivers/catalogue")

RATED, READ = "Schaeffler TPI 275 (RT1-H), quoted by others", "Harmonic Drive product pages (CSF)"

PUBLISHED: dict[str, tuple[str, dict[str, float]]] = {
    "size_14_ratio_100": (RATED, {"K1": 4.7e3, "K3": 7.1e3}),
    "size_17_ratio_100": (RATED, {"K1": 10e3, "K3": 16e3}),
    "size_20_ratio_100": (RATED, {"K1": 16e3, "K3": 29e3}),
    "size_25_ratio_100": (RATED, {"K1": 31e3, "K3": 57e3}),
    "size_17_ratio_50": (READ, {"K1": 0.81e4, "K2": 1.1e4, "K3": 1.3e4}),
    "size_25_ratio_50": (READ, {"K3": 4.4e4}),
}
"""Source and stiffness (N·m/rad) by design."""

NAMES = ("K1", "K2", "K3")

COLUMNS = ("drive", "elements", "wall_s", *NAMES, "K1_error", "K3_error", "K1_spread", "K3_spread", "lost_motion")


def measure(name: str, ranks: int) -> dict[str, Any]:
    """One run of the stiffness program at the rated torque."""
    summary = run(Path("results/bench/catalogue") / name, DRIVES / f"{name}.toml", ["stiffness.positions=2"], ranks)
    found = summary["stiffness"]
    row = {"drive": name, "elements": summary["elements"], "wall_s": round(summary["wall_s"], 1)}
    row |= {key: found[key] for key in (*NAMES, "lost_motion")}
    for key in ("K1", "K3"):
        row |= {f"{key}_error": (found["mesh_error"] or {}).get(key), f"{key}_spread": found["spread"][key]}
    return row


def table(rows: list[dict[str, Any]]) -> str:
    """The page's table."""
    head = ["drive", "", *NAMES, "K3 / K1", "computed over published: K1", "K3", "lost motion, arc min", "s"]
    found = [head]
    for row in rows:
        source, published = PUBLISHED[row["drive"]]
        over = [f"{row[key] / published[key]:.2f}" if key in published else "" for key in ("K1", "K3")]
        sizes = [
            f"{row[key]:.4g}" + (f" ± {row[error]:.2g}" if row.get(error := f"{key}_error") else "") for key in NAMES
        ]
        ratio, name = f"{row['K3'] / row['K1']:.2f}", row["drive"].replace("_", " ")
        found.append([name, "computed", *sizes, ratio, *over, f"{row['lost_motion']:.2g}", f"{row['wall_s']:.0f}"])
        quoted = [f"{published[key]:.4g}" if key in published else "" for key in NAMES]
        both = "K1" in published and "K3" in published
        ratio = f"{published['K3'] / published['K1']:.2f}" if both else ""
        found.append(["", source, *quoted, ratio, "", "", "", ""])
    return markdown(found)


def main() -> None:
    """Run the designs, and write the page."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--only", nargs="+", choices=list(PUBLISHED), default=list(PUBLISHED), metavar="DRIVE")
    options.add_argument("--ranks", type=int, default=2)
    arguments = options.parse_args()
    rows = []
    for name in arguments.only:
        rows.append(measure(name, arguments.ranks))
        print(rows[-1], flush=True)
        write_results("catalogue", COLUMNS, rows, table(rows))


if __name__ == "__main__":
    main()

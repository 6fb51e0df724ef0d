"""Designs of `swgpar new`: what check says of ratios and sizes, and the verdicts of rating sheets.

Rows of drives that are not computed are kept.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from page import markdown, read_results, write_results

import swgpar
from swgpar.answers.verdict import Judgement, Verdict
from swgpar.checks.remarks import remarks

STARTS = (
    *((30.0, size) for size in (8.0, 50.0)),
    *((50.0, size) for size in (17.0, 50.0, 65.0)),
    *((80.0, size) for size in (8.0, 50.0, 65.0)),
    *((100.0, size) for size in (14.0, 50.8)),
    *((120.0, size) for size in (25.0, 65.0)),
    *((160.0, size) for size in (8.0, 32.0)),
    *((320.0, size) for size in (20.0, 65.0)),
)
"""Ratios and pitch diameters (mm) that are checked."""

CHECKED = {
    "clearance": "smallest flank clearance, kinematic (mm)",
    "error": "transmission error of rigid teeth (arcsec)",
    "share": "share of rigid teeth within 1 µm of contact",
}

ROWS = (
    "yield of teeth and rim",
    "fatigue of teeth and rim",
    "yield of wall",
    "fatigue of wall",
    "yield of the ring gear",
    "yield below the flanks",
    "static safety of the bearing",
)
"""Rows about strength, in the order of the columns."""


def checked(ratio: float, diameter: float) -> dict[str, Any]:
    """What `swgpar check` says of a start."""
    design = swgpar.new(ratio=ratio, diameter=diameter, torque=1e-3)
    derived = swgpar.check(design)
    found = {name: derived[label] for name, label in CHECKED.items()}
    return {
        "ratio": ratio,
        "diameter": diameter,
        "module": design.drive.module,
        "rim": design.flexible_spline.rim,
        **found,
        "remarks": len(remarks(design)),
    }


def rated(ratio: float, diameter: float, torque: float, mesh: str, out: Path) -> dict[str, Any]:
    """Rows about strength of the rating sheet of a start."""
    design = swgpar.new(ratio=ratio, diameter=diameter, torque=torque)
    sheet = swgpar.rate(design, out, mesh=mesh, overwrite=True)
    verdicts = {verdict.name: verdict for verdict in sheet.verdicts}
    row: dict[str, Any] = {"ratio": ratio, "diameter": diameter, "torque": torque, "mesh": mesh}
    for name in ROWS:
        answer = verdicts[name].answer
        row |= {name: answer and answer.value}
    against = [
        verdict
        for verdict in sheet.verdicts
        if verdict.limit is not None or verdict.of_strength
        if verdict.judgement != Judgement.PASSES
    ]
    flanks = verdicts["yield below the flanks"].answer
    return row | {
        "error of the pressure": flanks and flanks.error,
        "strength": _names(one for one in against if one.of_strength),
        "others": _names(one for one in against if not one.of_strength),
        "headline": str(sheet.headline),
    }


def _names(verdicts: Iterable[Verdict]) -> str:
    return "; ".join(f"{verdict.name} {verdict.judgement}" for verdict in verdicts)


def table_of_checks(rows: list[dict[str, Any]]) -> str:
    """Table of what check says."""
    head = ["ratio", "D, mm", "module, mm", "rim, mm", "clearance, µm", "error of rigid teeth, ″"]
    found = [[*head, "share within 1 µm", "remarks"]]
    for row in rows:
        cells = [f"{row[key]:g}" for key in ("ratio", "diameter")]
        cells += [f"{row['module']:.4g}", f"{row['rim']:.3g}", f"{1000.0 * row['clearance']:.2f}"]
        found.append([*cells, f"{row['error']:.1g}", f"{row['share']:.2f}", f"{row['remarks']:g}"])
    return markdown(found)


def table_of_ratings(rows: list[dict[str, Any]]) -> str:
    """Table of the strength rows of the sheets."""
    head = ["ratio", "D, mm", "T, N·m", "T / D³, N/mm²", "mesh", "von Mises at the teeth, MPa"]
    head += ["safety", "of the wall, MPa", "safety", "of the ring gear, MPa", "pressure, MPa"]
    found = [[*head, "bearing", "strength", "other limits"]]
    for row in rows:
        cells = [f"{row[key]:g}" for key in ("ratio", "diameter", "torque")]
        cells += [f"{1000.0 * row['torque'] / row['diameter'] ** 3:.3f}", row["mesh"]]
        values = [f"{row[name]:.3g}" if row[name] is not None else "" for name in ROWS]
        pressed, error = row["yield below the flanks"], row["error of the pressure"]
        if pressed is not None:
            text = f"{pressed:.0f}" if error is None else f"{pressed:.0f} ± {error:.0f}"
            values[ROWS.index("yield below the flanks")] = text
        found.append([*cells, *values, row["strength"] or "all pass", row["others"] or "all pass"])
    return markdown(found)


def main() -> None:
    """Check the starts, rate those that are asked for, and write the page."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument(
        "--rate",
        nargs=3,
        type=float,
        action="append",
        default=[],
        metavar=("RATIO", "D", "T"),
        help="rate this start too",
    )
    options.add_argument("--mesh", default="coarse")
    options.add_argument("--out", type=Path, default=Path("results/bench/starter"))
    arguments = options.parse_args()
    if not arguments.rate:
        rows = [checked(*start) for start in STARTS]
        write_results("starter", list(rows[0]), rows, table_of_checks(rows))
    for ratio, diameter, torque in arguments.rate:
        folder = arguments.out / f"{ratio:g}_{diameter:g}_{torque:g}"
        new = rated(ratio, diameter, torque, arguments.mesh, folder)
        print(new, flush=True)
        key = ("ratio", "diameter", "torque", "mesh")
        others = read_results("starter_ratings")
        kept = [row for row in others if any(row[name] != new[name] for name in key)]
        rows = sorted([*kept, new], key=lambda row: tuple(row[name] for name in key))
        write_results("starter_ratings", list(new), rows, table_of_ratings(rows), page="starter")


if __name__ == "__main__":
    main()

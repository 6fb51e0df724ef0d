"""Drives of drivers/catalogue beside what is published for their sizes: torsional stiffness,
bearing, losses.

Wall thicknesses, teeth and bearings of the sizes are not published: the designs are assumed.
Nothing is fitted. Rows of drives that are not run are kept.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from page import markdown, read_results, write_results
from program import run

from swgpar import load_design

DRIVES = Path("drivers/catalogue")

RATED = "Schaeffler TPI 275 (RT1-H), quoted by others"
READ = "Harmonic Drive LLC, catalogue CSF and CSG, table 42; K3: product pages"

PUBLISHED: dict[str, tuple[str, dict[str, float]]] = {
    "size_14_ratio_100": (RATED, {"K1": 4.7e3, "K3": 7.1e3, "no_load": 35.0, "efficiency": 0.67}),
    "size_17_ratio_100": (RATED, {"K1": 10e3, "K3": 16e3, "no_load": 51.0, "efficiency": 0.77}),
    "size_20_ratio_100": (RATED, {"K1": 16e3, "K3": 29e3, "no_load": 105.0, "efficiency": 0.77}),
    "size_25_ratio_100": (RATED, {"K1": 31e3, "K3": 57e3, "no_load": 195.0, "efficiency": 0.77}),
    "size_17_ratio_50": (READ, {"K1": 0.81e4, "K2": 1.1e4, "K3": 1.3e4}),
    "size_25_ratio_50": (READ, {"K1": 2.5e4, "K2": 3.4e4, "K3": 4.4e4}),
}
"""Source, stiffness (N·m/rad), no-load running torque (N·mm) and efficiency by design."""

NAMES = ("K1", "K2", "K3")

BALLS, BALL_DIAMETER, RACE_THICKNESS = 22, 0.09, 0.018
"""Assumed bearing: number of balls, and sizes over the diameter of the spline's bore."""

KINDS = {False: "rigid cam", True: "bearing"}

STIFFNESS = (
    "drive", "wave_generator", "mesh", "elements", "wall_s", *NAMES,
    "K1_error", "K3_error", "K1_spread", "K3_spread", "lost_motion", "share",
)  # fmt: skip
LOSSES = ("drive", "mesh", "wall_s", "no_load", "no_load_bearing", "loaded", "efficiency")


def bearing(name: str) -> list[str]:
    """Overrides that put the assumed bearing into a design; a bearing has no slope."""
    bore = 2.0 * load_design(DRIVES / f"{name}.toml").inner_radius
    sizes = {
        "balls": BALLS,
        "ball_diameter": BALL_DIAMETER * bore,
        "race_thickness": RACE_THICKNESS * bore,
    }
    return [
        "micro_geometry.wg_slope=0",
        *(f"wave_generator.bearing.{key}={value:.4g}" for key, value in sizes.items()),
    ]


def bearing_bore(name: str) -> float:
    """Bore (mm) of the assumed bearing, both races alike: what coefficients of friction refer
    to."""
    shares = 1.0 - 2.0 * (BALL_DIAMETER + 2.0 * RACE_THICKNESS)
    return shares * 2.0 * load_design(DRIVES / f"{name}.toml").inner_radius


def measure(name: str, on_balls: bool, options: argparse.Namespace) -> dict[str, Any]:
    """One run of the stiffness program at the rated torque."""
    finer = options.mesh == "forces"  # a coarser mesh of it still finds the contacts
    overrides = [
        "stiffness.positions=2",
        "stiffness.points=1",
        f"stiffness.mesh_error={str(finer).lower()}",
    ]
    overrides += bearing(name) if on_balls else []
    folder = Path("results/bench/catalogue") / f"{name}{'_bearing' if on_balls else ''}"
    summary = run(
        folder, DRIVES / f"{name}.toml", overrides, options.ranks, options.mesh, plain=False
    )
    found, share = summary.stiffness, summary.bearing and summary.bearing.torsional_share
    row = {
        "drive": name,
        "wave_generator": KINDS[on_balls],
        "mesh": options.mesh,
        "elements": summary.elements,
    }
    row |= {
        "wall_s": round(summary.wall_s, 1),
        "share": share and share.bearing,
    }
    row |= {key: getattr(found, key) for key in (*NAMES, "lost_motion")}
    for key in ("K1", "K3"):
        row |= {
            f"{key}_error": (found.mesh_error or {}).get(key),
            f"{key}_spread": getattr(found.spread, key),
        }
    return row


def lose(name: str, options: argparse.Namespace) -> dict[str, Any]:
    """Losses over a turn with the coefficients of [losses], without a torque and under the rated
    one."""
    seconds, found = 0.0, []
    for torque in (["load.torque=0"], []):
        folder = Path("results/bench/catalogue") / f"{name}_losses"
        overrides = [f"losses.bearing_diameter={bearing_bore(name):.4g}", *torque]
        summary = run(
            folder, DRIVES / f"{name}.toml", overrides, options.ranks, options.mesh, plain=False
        )
        found.append(summary.losses)
        seconds += summary.wall_s
    free, loaded = found
    return {
        "drive": name,
        "mesh": options.mesh,
        "wall_s": round(seconds, 1),
        "no_load": free.no_load_torque_Nmm,
        "no_load_bearing": free.parts_Nmm.bearing,
        "loaded": loaded.loss_torque_Nmm,
        "efficiency": loaded.efficiency,
    }


def table(rows: list[dict[str, Any]]) -> str:
    """The table of the stiffness."""
    head = [
        "drive",
        "",
        "mesh",
        *NAMES,
        "K3 / K1",
        "over published: K1",
        "K3",
        "lost motion",
        "share",
        "s",
    ]
    found, before = [head], ""
    for row in rows:
        source, published = PUBLISHED[row["drive"]]
        name = row["drive"].replace("_", " ")
        if row["drive"] != before:
            quoted = [f"{published[key]:.4g}" if key in published else "" for key in NAMES]
            both = "K1" in published and "K3" in published
            ratio = f"{published['K3'] / published['K1']:.2f}" if both else ""
            found.append([name, source, "", *quoted, ratio, *[""] * 5])
        before = row["drive"]
        over = [
            f"{row[key] / published[key]:.2f}" if key in published else "" for key in ("K1", "K3")
        ]
        sizes = [
            f"{row[key]:.4g}" + (f" ± {row[error]:.2g}" if row.get(error := f"{key}_error") else "")
            for key in NAMES
        ]
        ratio, share = (
            f"{row['K3'] / row['K1']:.2f}",
            f"{100.0 * row['share']:.0f} %" if row["share"] else "",
        )
        cells = [row["wave_generator"], row["mesh"], *sizes, ratio, *over]
        found.append(["", *cells, f"{row['lost_motion']:.2g}", share, f"{row['wall_s']:.0f}"])
    return markdown(found)


def table_of_losses(rows: list[dict[str, Any]]) -> str:
    """The table of the losses."""
    head = [
        "drive",
        "no load: computed",
        "of it bearing",
        "published",
        "ratio",
        "under rated torque",
    ]
    found = [[*head, "efficiency: computed", "published", "s"]]
    for row in rows:
        _, published = PUBLISHED[row["drive"]]
        torque, efficiency = published.get("no_load"), published.get("efficiency")
        cells = [
            row["drive"].replace("_", " "),
            f"{row['no_load']:.3g}",
            f"{row['no_load_bearing']:.3g}",
        ]
        cells += [f"{torque:g}", f"{row['no_load'] / torque:.2f}"] if torque else ["", ""]
        cells += [f"{row['loaded']:.3g}", f"{100.0 * row['efficiency']:.0f} %"]
        found.append(
            [*cells, f"{100.0 * efficiency:.0f} %" if efficiency else "", f"{row['wall_s']:.0f}"]
        )
    return markdown(found)


def replaced(
    rows: list[dict[str, Any]], new: dict[str, Any], keys: tuple[str, ...]
) -> list[dict[str, Any]]:
    """Rows with a new one in place of that with the same keys, in the order of `PUBLISHED`."""
    others = [row for row in rows if any(row[key] != new[key] for key in keys)]
    order = list(PUBLISHED)
    return sorted(
        [*others, new],
        key=lambda row: (order.index(row["drive"]), row.get("wave_generator") == KINDS[True]),
    )


def main() -> None:
    """Run the designs, and write the page."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument(
        "--only", nargs="+", choices=list(PUBLISHED), default=list(PUBLISHED), metavar="DRIVE"
    )
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument(
        "--mesh", default="coarse", help='"forces" is three times slower and gives errors'
    )
    kinds = ("rigid", "bearing", "losses")
    options.add_argument(
        "--what", nargs="+", choices=kinds, default=["rigid"], help="default: rigid"
    )
    arguments = options.parse_args()
    for name in arguments.only:
        for on_balls, kind in ((False, "rigid"), (True, "bearing")):
            if kind in arguments.what:
                row = measure(name, on_balls, arguments)
                print(row, flush=True)
                rows = replaced(read_results("catalogue"), row, ("drive", "wave_generator"))
                write_results("catalogue", STIFFNESS, rows, table(rows))
        if "losses" in arguments.what:
            row = lose(name, arguments)
            print(row, flush=True)
            rows = replaced(read_results("catalogue_losses"), row, ("drive",))
            write_results("catalogue_losses", LOSSES, rows, table_of_losses(rows), page="catalogue")


if __name__ == "__main__":
    main()

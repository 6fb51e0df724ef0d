"""Error over wall time and peak memory, for mesh levels and choices: problems with known solutions,
and drives.

Families: `elements` (linear problems), `contact` (Hertz, ring on a cam), `drives` (over meshes),
`choices` (of a drive on one mesh). Each family writes accuracy_<family>.csv, .json and log-log
plots to --tables, and its table to --page. Finished cases stay in --out and are not computed again.
Convergence rates that theory gives are asserted.
"""

from __future__ import annotations

import argparse
import csv
import importlib
import json
from pathlib import Path

from accuracy_plots import plot
from cases import Cases, Row
from page import markdown, put

FAMILIES = {
    "elements": "element_cases",
    "contact": "contact_cases",
    "drives": "drive_cases",
    "choices": "choice_cases",
}


def show(row: Row) -> None:
    rate = "" if row["rate"] is None else f"rate {row['rate']:5.2f}"
    print(
        f"{row['problem']:28s} {row['choice']:24s} {row['level']!s:>8s} {row['unknowns']:8d} "
        f"{row['quantity']:16s} "
        f"{row['value']:12.6g} error {row['error']:8.1e} {rate:10s} {row['seconds']:8.3g} s "
        f"{row['memory_MB']:6.0f} MB",
        flush=True,
    )


def write(rows: list[Row], tables: Path, family: str) -> None:
    """Write the tables and plots of a family."""
    with (tables / f"accuracy_{family}.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows
        )
    (tables / f"accuracy_{family}.json").write_text(
        json.dumps(rows, indent=1) + "\n", encoding="utf-8"
    )
    for path in plot(rows, tables, family):
        print(f"written {path}")


HEAD = (
    "problem",
    "choice",
    "quantity",
    "first within 1 %: unknowns",
    "s",
    "MB",
    "finest: unknowns",
    "error %",
    "order",
    "s",
)


def summary(rows: list[Row]) -> str:
    """A row for every problem, choice and quantity: what one per cent costs, and the finest
    mesh."""
    series: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        series.setdefault(tuple(row[k] for k in ("problem", "choice", "quantity")), []).append(row)
    lines = []
    for names, found in series.items():
        within = next((row for row in found if row["error"] <= 0.01), None)
        cost = ["", "", ""]
        if within is not None:
            cost = [
                f"{within['unknowns']:,}",
                f"{within['seconds']:.2g}",
                f"{within['memory_MB']:.0f}",
            ]
        last = found[-1]
        order = "" if last["rate"] is None else f"{last['rate']:.2f}"
        finest = [
            f"{last['unknowns']:,}",
            f"{100 * last['error']:.2g}",
            order,
            f"{last['seconds']:.3g}",
        ]
        lines.append([*names, *cost, *finest])
    return markdown([HEAD, *lines])


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--out", default="results/bench/accuracy", help="finished cases")
    options.add_argument("--tables", default="docs/verification/data")
    options.add_argument("--page", default="docs/verification/accuracy.md")
    options.add_argument("--ranks", type=int, default=2, help="of the drives")
    options.add_argument(
        "--only", nargs="+", default=list(FAMILIES), choices=list(FAMILIES), help="families"
    )
    options.add_argument(
        "--finest", type=int, default=None, help="number of levels at most, for a quick look"
    )
    arguments = options.parse_args()
    tables = Path(arguments.tables)
    tables.mkdir(parents=True, exist_ok=True)
    for family in arguments.only:
        cases = Cases(Path(arguments.out) / family, arguments.ranks, arguments.finest, show)
        importlib.import_module(FAMILIES[family]).compute(cases)
        write(cases.rows, tables, family)
        put(Path(arguments.page), family, summary(cases.rows))
        cases.check()


if __name__ == "__main__":
    main()

"""Gear trains with as many samples as the sources have: wall seconds on some ranks beside the published times.

Takes about 15 minutes on 2 ranks, nearly all of it for 100,000 planetary simulations; the others take about 2 minutes
in all. The tables show what the runs are asked for: errors of the linearisation, overloaded gearboxes.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = {
    # name: driver, overrides, what took the source how long
    "cascade": ("cascade", [], "36 h for 1000 gearboxes"),
    "gear_pair": ("gear_pair", [], "8 h for 20,000 simulations of one of three cases, 35 s linearised"),
    "ring": ("ring_moving_load", [], "not said"),
    "planetary_linearised": ("planetary", ["monte_carlo.samples=2", "ring.rims=[87.0]"], "48 s linearised"),
    "planetary": ("planetary", ["monte_carlo.samples=100000", "ring.rims=[87.0]"], "223 h for 100,000 simulations"),
}


def run(name: str, out: Path, ranks: int) -> dict:
    """Run a case and return its summary."""
    driver, overrides, _ = CASES[name]
    design, folder = ROOT / "drivers" / f"{driver}.toml", out / name
    command = ["mpirun", "-n", str(ranks), sys.executable, "-m", "swgpar.cli", "run", str(design), "--out", str(folder)]
    command += ["--overwrite", "--set", "output.figures=false", *overrides]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode:
        raise SystemExit(f"{name}: {done.stderr or done.stdout}")
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("results/bench_gear_trains"))
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--only", nargs="+", choices=[*CASES], default=[*CASES])
    arguments = parser.parse_args()
    for name in arguments.only:
        summary = run(name, arguments.out.resolve(), arguments.ranks)
        print(f"{name}: {summary['wall_s']:.1f} s on {summary['ranks']} ranks; published {CASES[name][2]}")
        for key in ("cpu_s", "errors_percent", "least_eigenvalue_over_largest", "largest_dynamic_share"):
            if key in summary:
                print(f"  {key}: {json.dumps(summary[key])}")
        counts = {k: v for k, v in summary["quantities"].items() if k.startswith(("overloaded", "out_of", "far"))}
        if counts:
            print(f"  {json.dumps(counts)}")
        sys.stdout.flush()


if __name__ == "__main__":
    main()

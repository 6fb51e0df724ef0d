"""Folders and files of the checkout that tests and benchmarks read."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DATA, DRIVERS = ROOT / "tests" / "data", ROOT / "drivers"

REFERENCE = DRIVERS / "cup_45deg.toml"
"""The cup reference drive."""

DESIGN, RECIPE = DATA / "small.toml", DATA / "tiny.toml"
"""The small drive and its mesh recipe."""

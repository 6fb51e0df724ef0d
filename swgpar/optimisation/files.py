"""Names in the folder of a search."""

from __future__ import annotations

TABLE, REPORT, BEST, DESIGNS = "optimise.csv", "optimise.html", "best", "evaluation_*.toml"
"""All evaluations, the report, the folder of the winning design files, and these."""

"""Studies: many designs, described by one file, compared in one report."""

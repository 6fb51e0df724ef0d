"""Studies: many drives, described by one file, compared in one report."""

from swgpar.studies.study import run_study

__all__ = ["run_study"]

"""Studies: many designs, described by one file, compared in one report."""

from swgpar.studies.study import StudyResult, run_study

__all__ = ["StudyResult", "run_study"]

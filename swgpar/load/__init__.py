"""Load states, stages and programs: what is applied, in which order."""

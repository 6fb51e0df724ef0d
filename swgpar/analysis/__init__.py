"""A run: starts, load stepping, mesh refinement, recording, restart."""

"""The design file of the drive, its derived geometry and its load states."""

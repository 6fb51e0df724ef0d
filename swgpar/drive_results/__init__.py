"""The table of answers and the result of a drive, in memory or from files."""

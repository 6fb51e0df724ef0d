"""The rating sheet of a drive: the runs that it needs, and its answers beside limits."""

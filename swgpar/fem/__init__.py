"""Finite elements: partition, assembly, condensed and inactive sectors, stress."""

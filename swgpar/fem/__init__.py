"""Finite elements: partition, assembly, condensed parts, inactive sectors, stress."""

"""Finite elements: partition, assembly, condensed parts, sectors in reach, stress."""

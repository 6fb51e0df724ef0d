"""Lumped models of gear trains around the drive: their design files, samples, results and figures.

SI units inside (m, N, kg, s, rad); design files say their unit with every key.
"""

"""Numerics of lumped models: meshes with backlash, elastic rings, statistical linearisation, random
samples."""

"""Stiffness, contact ratio and phase of meshes from the teeth."""

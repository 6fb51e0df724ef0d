"""Contact of pairs of flanks: loads, half-space pressure, nodal pressure."""

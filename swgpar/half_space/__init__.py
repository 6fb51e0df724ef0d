"""Contact of pairs of flanks on half planes and half spaces, from the forces of the mesh."""

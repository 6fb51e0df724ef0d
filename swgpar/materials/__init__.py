"""Laws of materials, and the materials of a design."""

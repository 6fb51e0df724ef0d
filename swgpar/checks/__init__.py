"""What judges a design: fit of keys, clearance, remarks; starter designs."""

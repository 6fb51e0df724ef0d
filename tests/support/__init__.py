"""What tests and benchmarks share: small problems with known answers, the small drive, groups of
designs, commands."""

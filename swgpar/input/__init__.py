"""What any design file needs: quantities with units and ranges, TOML and its one-sentence
errors."""

"""Numbers that a run gives, as values with units, errors and places."""

"""Contact: rigid cam and pins on the inner surface, tooth flanks on tooth flanks."""

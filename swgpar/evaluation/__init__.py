"""What follows from computed states: one typed result for each question."""

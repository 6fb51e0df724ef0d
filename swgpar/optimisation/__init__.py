"""Search for the best design: variables within bounds, objectives and constraints from the results
of runs."""

"""From a design to results: drive model, load stepping, mesh refinement, figures."""

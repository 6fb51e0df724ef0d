"""The discrete problem and its Newton solver."""

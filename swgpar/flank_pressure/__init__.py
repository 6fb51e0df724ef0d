"""Pressure where flanks touch: lines and patches of pairs of teeth."""

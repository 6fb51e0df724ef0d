"""The drive as bodies, contacts, supports and solver."""

"""Distributing coupling and supports."""

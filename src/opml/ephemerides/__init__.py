"""Corrected ephemerides, and the same replayed for past mornings."""

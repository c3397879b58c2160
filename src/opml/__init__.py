"""Orbit prediction improved by machine learning: a simulated catalogue, and its predictions corrected."""

__version__ = "0.1.0"

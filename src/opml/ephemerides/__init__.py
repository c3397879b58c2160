"""Ephemerides of several models from one estimate, and how a correction along the track moves an orbit."""

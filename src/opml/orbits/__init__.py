"""Orbital elements and RSW; stations and RSOs, and the sheets that they stand in."""

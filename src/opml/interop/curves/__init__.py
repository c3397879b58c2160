"""Curves through the nodes of real orbits, open where these break."""

"""Orbital elements, the RSW frame and its covariances, and the sheets of stations and RSOs."""

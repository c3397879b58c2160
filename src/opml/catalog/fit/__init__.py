"""From tracks to estimates: first orbits and batch least squares."""

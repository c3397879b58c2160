"""First orbits, from tracks alone."""

"""The true orbits, and what radars measure of them."""

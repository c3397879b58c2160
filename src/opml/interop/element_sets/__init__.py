"""Sets of mean elements: read in all their notations, their histories, and SGP4 from and to them."""
